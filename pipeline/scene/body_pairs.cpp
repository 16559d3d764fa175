#include "pipeline/scene/body_pairs.h"

#include "core/sort/radix_sort.h"
#include "core/sort/stretches.h"
#include "pipeline/narrow/steady_column.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerStretch = 8192;

/// A pair as one number, which sorts as pairs are sorted.
struct Packing {
  unsigned bits;

  [[nodiscard]] std::uint64_t pack(const ShapeId* shapes, BodyPair bodies,
                                   BodyPair places) const noexcept {
    const ShapeId one = shapes[bodies.a];
    const ShapeId other = shapes[bodies.b];
    const bool same_kind = one.kind_index() == other.kind_index();
    const bool mirrored = same_kind ? places.b < places.a : is_mirrored(one, other);
    const std::uint64_t a = mirrored ? places.b : places.a;
    const std::uint64_t b = mirrored ? places.a : places.b;
    const std::uint64_t code =
        mirrored ? KindPairs::index(other, one) : KindPairs::index(one, other);
    return (code << bits | a) << bits | b;
  }
  /// The least number of a code.
  [[nodiscard]] std::uint64_t first(std::uint32_t code) const noexcept {
    return std::uint64_t{code} << 2 * bits;
  }
};

/// Those that a selection wants, packed from `item` on; returns their end.
std::uint64_t* pack_selected(const BodyPairs::Source& source, const ShapeId* shapes,
                             const Packing& packing, const PairSelection& selection,
                             std::uint64_t* item) {
  for (const Pair& pair : source.pairs) {
    const BodyPair bodies{source.first_body[pair.first], source.second_body[pair.second]};
    if (!selection.wants(selection.context, bodies.a, bodies.b)) continue;
    *item++ = packing.pack(shapes, bodies, {selection.place[bodies.a], selection.place[bodies.b]});
  }
  return item;
}

}  // namespace

std::size_t BodyPairs::pack(std::span<const Source> sources, const ShapeId* shapes,
                            const Execution& execution, const PairSelection* selection) {
  const Packing packing{bits_};
  std::uint64_t* item = items_[0].data();
  for (const Source& source : sources) {
    if (selection != nullptr) {
      item = pack_selected(source, shapes, packing, *selection, item);
      continue;
    }
    for_stretches(
        execution, source.pairs.size(), kPairsPerStretch, [&](std::size_t first, std::size_t end) {
          for (std::size_t i = first; i < end; ++i) {
            const Pair& pair = source.pairs[i];
            const BodyPair bodies{source.first_body[pair.first], source.second_body[pair.second]};
            item[i] = packing.pack(shapes, bodies, bodies);
          }
        });
    item += source.pairs.size();
  }
  return static_cast<std::size_t>(item - items_[0].data());
}

Status BodyPairs::assign(std::span<const Source> sources, const ShapeId* shapes, std::size_t bodies,
                         const Execution& execution, const PairSelection* selection) {
  std::size_t count = 0;
  for (const Source& source : sources) count += source.pairs.size();
  if (!resize_steadily(items_[0], count) || !resize_steadily(items_[1], count)) {
    clear();
    return Status::out_of_memory;
  }
  bits_ = static_cast<unsigned>(std::bit_width(bodies));
  size_ = pack(sources, shapes, execution, selection);
  const unsigned code_bits = std::bit_width(KindPairs::kCount);
  const std::uint64_t* const sorted =
      radix_sort(items_[0].data(), items_[1].data(), size_, 2 * bits_ + code_bits, execution, 0);
  sorted_ = sorted == items_[0].data() ? 0 : 1;
  for (std::uint32_t code = 0; code <= KindPairs::kCount; ++code) {
    first_[code] = static_cast<std::uint32_t>(
        std::lower_bound(sorted, sorted + size_, Packing{bits_}.first(code)) - sorted);
  }
  if (selection != nullptr) name_bodies(*selection, execution);
  ++serial_;
  return Status::ok;
}

void BodyPairs::name_bodies(const PairSelection& selection, const Execution& execution) noexcept {
  std::uint64_t* const items = items_[sorted_].data();
  const std::uint64_t bodies = (std::uint64_t{1} << 2 * bits_) - 1;
  for_stretches(execution, size_, kPairsPerStretch, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const BodyPair places = (*this)[i];
      items[i] = (items[i] & ~bodies) | std::uint64_t{selection.body[places.a]} << bits_ |
                 selection.body[places.b];
    }
  });
}

void BodyPairs::clear() noexcept {
  size_ = 0;
  std::fill_n(first_, KindPairs::kCount + 1, 0U);
  for (std::uint64_t& change : changes) change = ~0ULL;
  ++serial_;
}

Bytes BodyPairs::bytes() const noexcept {
  Bytes bytes = items_[0].bytes();
  bytes += items_[1].bytes();
  return bytes;
}

}  // namespace winnow
