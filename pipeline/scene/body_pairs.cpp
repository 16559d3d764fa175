// Sorts the pairs that partitions find into the order of a scene's contacts: counts the pairs to be
// kept in each range, packs them as 64-bit keys and sorts these by radix. SceneState::find_pairs
// calls `assign`.

#include "pipeline/scene/body_pairs.h"

#include "core/sort/parallel_ranges.h"
#include "core/sort/radix_sort.h"
#include "pipeline/narrow/tight_growth.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kPairsPerRange = 8192;
constexpr std::size_t kBits = 64;
constexpr std::size_t kWordsPerRange = kPairsPerRange / kBits;

[[nodiscard]] std::size_t ranges_of(const BodyPairs::PairSource& source) noexcept {
  return (source.pairs.size() + kPairsPerRange - 1) / kPairsPerRange;
}

/// Packs a pair into a sort key.
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
};

/// Returns a bit for each of at most 64 pairs, set if is(body a, body b). The loop has no branch,
/// because the results are unpredictable.
template <typename Is>
[[nodiscard]] std::uint64_t bits_where(const BodyPairs::PairSource& source, std::size_t first,
                                       std::size_t count, Is&& is) noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const BodyPair bodies = source.bodies(first + i);
    bits |= std::uint64_t{is(bodies.a, bodies.b)} << i;
  }
  return bits;
}

/// Calls body(source, range number, first, end) for ranges of the pairs of all sources, one source
/// after the other.
template <typename Body>
void for_source_ranges(std::span<const BodyPairs::PairSource> sources, const Execution& execution,
                       Body&& body) {
  std::size_t before = 0;
  for (const BodyPairs::PairSource& source : sources) {
    for_each_range(execution, source.pairs.size(), kPairsPerRange,
                   [&](std::size_t first, std::size_t end) {
                     body(source, before + first / kPairsPerRange, first, end);
                   });
    before += ranges_of(source);
  }
}

}  // namespace

Status BodyPairs::assign(std::span<const PairSource> sources, const BodyData& known,
                         const Execution& execution) {
  std::size_t range_count = 0;
  for (const PairSource& source : sources) range_count += ranges_of(source);
  if (!resize_tightly(kept_, range_count * kWordsPerRange) ||
      !resize_tightly(counts_, range_count)) {
    clear();
    return Status::out_of_memory;
  }
  are_all_ = known.balls == nullptr;
  choose(sources, known, execution);
  if (!resize_tightly(items_[0], size_) || !resize_tightly(items_[1], size_)) {
    clear();
    return Status::out_of_memory;
  }
  bits_ = static_cast<unsigned>(std::bit_width(known.bodies));
  pack(sources, known, execution);
  const unsigned code_bits = std::bit_width(KindPairs::kCount);
  const std::uint64_t* const sorted =
      radix_sort(items_[0].data(), items_[1].data(), size_, 2 * bits_ + code_bits, execution, 0);
  sorted_ = sorted == items_[0].data() ? 0 : 1;
  if (known.selection != nullptr) name_bodies(*known.selection, execution);
  ++serial_;
  return Status::ok;
}

// Chooses the pairs to be kept, and computes where each range of pairs writes.
void BodyPairs::choose(std::span<const PairSource> sources, const BodyData& known,
                       const Execution& execution) noexcept {
  for_source_ranges(
      sources, execution,
      [&](const PairSource& source, std::size_t range, std::size_t first, std::size_t end) {
        std::uint64_t* word = kept_.data() + range * kWordsPerRange;
        RangeCount sum{};
        for (; first < end; first += kBits) {
          const std::size_t count = std::min(end - first, kBits);
          const std::uint64_t apart =
              known.balls == nullptr ? 0 : bits_where(source, first, count, [&](auto a, auto b) {
                return are_apart(known.balls[a], known.balls[b]);
              });
          std::uint64_t kept = ~std::uint64_t{0} >> (kBits - count) & ~apart;
          if (known.selection != nullptr) {
            const PairSelection& selection = *known.selection;
            kept &= bits_where(source, first, count, [&](auto a, auto b) {
              return selection.accept(selection.context, a, b);
            });
          }
          sum.apart += static_cast<std::uint32_t>(std::popcount(apart));
          sum.taken += static_cast<std::uint32_t>(std::popcount(kept));
          *word++ = kept;
        }
        counts_[range] = sum;
      });
  size_ = apart_ = 0;
  for (RangeCount& count : counts_) {
    apart_ += count.apart;
    const std::uint32_t taken = std::exchange(count.taken, static_cast<std::uint32_t>(size_));
    size_ += taken;
  }
}

void BodyPairs::pack(std::span<const PairSource> sources, const BodyData& known,
                     const Execution& execution) noexcept {
  const Packing packing{bits_};
  const PairSelection* const selection = known.selection;
  for_source_ranges(
      sources, execution,
      [&](const PairSource& source, std::size_t range, std::size_t first, std::size_t end) {
        const std::uint64_t* word = kept_.data() + range * kWordsPerRange;
        std::uint64_t* item = items_[0].data() + counts_[range].taken;
        for (; first < end; first += kBits) {
          for (std::uint64_t bits = *word++; bits != 0; bits &= bits - 1) {
            const BodyPair bodies =
                source.bodies(first + static_cast<std::size_t>(std::countr_zero(bits)));
            const BodyPair places = selection == nullptr ? bodies
                                                         : BodyPair{selection->place[bodies.a],
                                                                    selection->place[bodies.b]};
            *item++ = packing.pack(known.shapes, bodies, places);
          }
        }
      });
}

// The last range of each source may be partly filled.
bool BodyPairs::reserve_choice(std::size_t count, Pages pages) noexcept {
  const std::size_t range_count = count / kPairsPerRange + kMaxSources;
  return kept_.reserve(range_count * kWordsPerRange, pages) && counts_.reserve(range_count, pages);
}

void BodyPairs::name_bodies(const PairSelection& selection, const Execution& execution) noexcept {
  std::uint64_t* const items = items_[sorted_].data();
  const std::uint64_t bodies = (std::uint64_t{1} << 2 * bits_) - 1;
  for_each_range(execution, size_, kPairsPerRange, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const BodyPair places = (*this)[i];
      items[i] = (items[i] & ~bodies) | std::uint64_t{selection.body[places.a]} << bits_ |
                 selection.body[places.b];
    }
  });
}

void BodyPairs::clear() noexcept {
  size_ = apart_ = 0;
  for (std::uint64_t& change : changes) change = ~0ULL;
  ++serial_;
}

Bytes BodyPairs::bytes() const noexcept {
  Bytes bytes = kept_.bytes();
  bytes += counts_.bytes();
  for (const Column<std::uint64_t>& items : items_) bytes += items.bytes();
  return bytes;
}

}  // namespace winnow
