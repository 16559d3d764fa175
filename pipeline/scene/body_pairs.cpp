#include <winnow/partitions/radix_sort.h>
#include <winnow/pipeline/scene/body_pairs.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace winnow {
namespace {

[[nodiscard]] std::uint64_t swap_halves(std::uint64_t item) noexcept {
  return item << 32U | item >> 32U;
}

[[nodiscard]] std::uint32_t code_of(const ShapeId* shapes, const BodyPair& pair) noexcept {
  return shapes[pair.a].kind_index() * kAllShapeKinds + shapes[pair.b].kind_index();
}

// b << 32 | a, with a the body that comes first.
[[nodiscard]] std::uint64_t item_of(const ShapeId* shapes, std::uint32_t one,
                                    std::uint32_t other) noexcept {
  const std::uint32_t kind_one = shapes[one].kind_index();
  const std::uint32_t kind_other = shapes[other].kind_index();
  const bool swapped = kind_one != kind_other ? kind_other < kind_one : other < one;
  const std::uint64_t a = swapped ? other : one;
  const std::uint64_t b = swapped ? one : other;
  return b << 32U | a;
}

}  // namespace

Status BodyPairs::assign(std::span<const Source> sources, const ShapeId* shapes, std::size_t bodies,
                         const Execution& execution) {
  std::size_t count = 0;
  for (const Source& source : sources) count += source.pairs.size();
  if (!items_.resize(count) || !spare_.resize(count) || !pairs_.resize(count)) {
    clear();
    return Status::out_of_memory;
  }
  std::uint64_t* item = items_.data();
  for (const Source& source : sources) {
    for (const Pair& pair : source.pairs) {
      *item++ = item_of(shapes, source.first_body[pair.first], source.second_body[pair.second]);
    }
  }
  const auto bits = static_cast<unsigned>(std::bit_width(bodies));
  std::uint64_t* sorted = radix_sort(items_.data(), spare_.data(), count, bits, execution);
  std::uint64_t* other = sorted == items_.data() ? spare_.data() : items_.data();
  std::transform(sorted, sorted + count, sorted, swap_halves);
  sorted = radix_sort(sorted, other, count, bits, execution);

  std::uint32_t place[kPairCodes + 1] = {};
  for (std::size_t i = 0; i < count; ++i) {
    ++place[code_of(shapes, {static_cast<std::uint32_t>(sorted[i] >> 32U),
                             static_cast<std::uint32_t>(sorted[i])}) +
            1];
  }
  for (std::uint32_t code = 0; code < kPairCodes; ++code) place[code + 1] += place[code];
  std::copy_n(place, kPairCodes + 1, first_);
  for (std::size_t i = 0; i < count; ++i) {
    const BodyPair pair{static_cast<std::uint32_t>(sorted[i] >> 32U),
                        static_cast<std::uint32_t>(sorted[i])};
    pairs_[place[code_of(shapes, pair)]++] = pair;
  }
  ++serial_;
  return Status::ok;
}

void BodyPairs::clear() noexcept {
  pairs_.clear();
  std::fill_n(first_, kPairCodes + 1, 0U);
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
