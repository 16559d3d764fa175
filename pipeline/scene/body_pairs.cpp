#include "pipeline/scene/body_pairs.h"

#include "core/sort/radix_sort.h"
#include "core/sort/stretches.h"
#include "pipeline/narrow/steady_column.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerStretch = 8192;

/// Code, body a and body b of a pair as one number, which sorts as pairs are sorted.
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
  [[nodiscard]] BodyPair pair(std::uint64_t item) const noexcept {
    const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
    return {static_cast<std::uint32_t>(item >> bits & mask),
            static_cast<std::uint32_t>(item & mask)};
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

std::size_t BodyPairs::pack(std::span<const Source> sources, const ShapeId* shapes, unsigned bits,
                            const Execution& execution, const PairSelection* selection) {
  const Packing packing{bits};
  std::uint64_t* item = items_.data();
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
  return static_cast<std::size_t>(item - items_.data());
}

Status BodyPairs::assign(std::span<const Source> sources, const ShapeId* shapes, std::size_t bodies,
                         const Execution& execution, const PairSelection* selection) {
  std::size_t count = 0;
  for (const Source& source : sources) count += source.pairs.size();
  if (!resize_steadily(items_, count) || !resize_steadily(spare_, count) ||
      !resize_steadily(pairs_, count)) {
    clear();
    return Status::out_of_memory;
  }
  const Packing packing{static_cast<unsigned>(std::bit_width(bodies))};
  count = pack(sources, shapes, packing.bits, execution, selection);
  pairs_.set_size(count);
  const unsigned code_bits = std::bit_width(KindPairs::kCount);
  const std::uint64_t* const sorted =
      radix_sort(items_.data(), spare_.data(), count, 2 * packing.bits + code_bits, execution, 0);
  for_stretches(execution, count, kPairsPerStretch, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const BodyPair places = packing.pair(sorted[i]);
      pairs_[i] = selection == nullptr
                      ? places
                      : BodyPair{selection->body[places.a], selection->body[places.b]};
    }
  });
  for (std::uint32_t code = 0; code <= KindPairs::kCount; ++code) {
    first_[code] = static_cast<std::uint32_t>(
        std::lower_bound(sorted, sorted + count, packing.first(code)) - sorted);
  }
  ++serial_;
  return Status::ok;
}

void BodyPairs::clear() noexcept {
  pairs_.clear();
  std::fill_n(first_, KindPairs::kCount + 1, 0U);
  for (std::uint64_t& change : changes) change = ~0ULL;
  ++serial_;
}

Bytes BodyPairs::bytes() const noexcept {
  Bytes bytes = pairs_.bytes();
  bytes += items_.bytes();
  bytes += spare_.bytes();
  return bytes;
}

}  // namespace winnow
