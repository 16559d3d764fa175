#pragma once

#include <winnow/core/column.h>
#include <winnow/core/footprint.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// Which layers do not meet: a square of bits, as wide as the highest layer that was told of. All
/// others meet.
class LayerMatrix {
 public:
  explicit LayerMatrix(std::pmr::memory_resource* memory) noexcept : apart_(memory) {}

  [[nodiscard]] bool all_meet() const noexcept { return apart_.empty(); }
  [[nodiscard]] bool meet(std::uint32_t a, std::uint32_t b) const noexcept {
    if (a >= width_ || b >= width_) return true;
    return (apart_[word(a, b)] >> b % kBits & 1U) == 0;
  }

  /// Room to tell of layers up to `layer`. False, and unchanged, if memory is refused. O(layers^2).
  [[nodiscard]] bool reach(std::uint32_t layer) noexcept {
    if (layer < width_) return true;
    const std::uint32_t old = width_ / kBits;
    const std::uint32_t wide = (layer / kBits + 1);
    if (!apart_.grow(std::size_t{wide} * wide * kBits)) return false;
    apart_.set_size(std::size_t{wide} * wide * kBits);
    // The last rows first: each lies behind where it was.
    for (std::uint32_t row = wide * kBits; row-- > 0;) {
      std::uint64_t* const to = apart_.data() + std::size_t{row} * wide;
      const std::uint32_t known = row < width_ ? old : 0;
      std::copy_backward(apart_.data() + std::size_t{row} * known,
                         apart_.data() + std::size_t{row} * known + known, to + known);
      std::fill(to + known, to + wide, std::uint64_t{0});
    }
    width_ = wide * kBits;
    return true;
  }

  /// Both are within reach.
  void set(std::uint32_t a, std::uint32_t b, bool meet) noexcept {
    const std::uint32_t pair[2] = {a, b};
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t other = pair[1 - side];
      std::uint64_t& bits = apart_[word(pair[side], other)];
      const std::uint64_t bit = std::uint64_t{1} << other % kBits;
      bits = meet ? bits & ~bit : bits | bit;
    }
  }

  [[nodiscard]] Bytes bytes() const noexcept { return apart_.bytes(); }

 private:
  static constexpr std::uint32_t kBits = 64;

  [[nodiscard]] std::size_t word(std::uint32_t row, std::uint32_t column) const noexcept {
    return std::size_t{row} * (width_ / kBits) + column / kBits;
  }

  Column<std::uint64_t> apart_;
  std::uint32_t width_ = 0;
};

}  // namespace winnow
