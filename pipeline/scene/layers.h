#pragma once

#include <winnow/core/memory.h>
#include <winnow/pipeline/scene.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// A symmetric bit matrix of the pairs of layers that do not collide. It has rows for the layers up
/// to the highest one that was excluded from colliding with another, rounded up to a multiple of
/// 64. Layers beyond these collide with all layers.
class LayerMatrix {
 public:
  enum class Restored : std::uint8_t { good, refused, out_of_memory };

  explicit LayerMatrix(std::pmr::memory_resource* memory) noexcept : apart_(memory) {}

  [[nodiscard]] bool all_collide() const noexcept { return apart_.empty(); }
  [[nodiscard]] bool collide(std::uint32_t a, std::uint32_t b) const noexcept {
    if (a >= width_ || b >= width_) return true;
    return (apart_[word(a, b)] >> b % kBits & 1U) == 0;
  }

  /// Grows the matrix to include `layer`. Returns false and changes nothing if memory is refused.
  /// O(layers^2).
  [[nodiscard]] bool grow_to(std::uint32_t layer) noexcept {
    if (layer < width_) return true;
    const std::uint32_t old = width_ / kBits;
    const std::uint32_t wide = (layer / kBits + 1);
    if (!apart_.grow(std::size_t{wide} * wide * kBits)) return false;
    apart_.set_size(std::size_t{wide} * wide * kBits);
    // From the last row on, because each row moves to a higher address.
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

  /// Requires both layers within the width of the matrix (see `grow_to`).
  void set(std::uint32_t a, std::uint32_t b, bool collide) noexcept {
    const std::uint32_t pair[2] = {a, b};
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t other = pair[1 - side];
      std::uint64_t& bits = apart_[word(pair[side], other)];
      const std::uint64_t bit = std::uint64_t{1} << other % kBits;
      bits = collide ? bits & ~bit : bits | bit;
    }
  }

  /// One bit for each pair that does not collide, row by row.
  [[nodiscard]] std::span<const std::uint64_t> words() const noexcept {
    return {apart_.data(), apart_.size()};
  }
  /// Replaces the matrix by saved `words`; refuses them unless the matrix is square and symmetric.
  [[nodiscard]] Restored restore(std::span<const std::uint64_t> words) noexcept {
    std::uint32_t wide = 0;
    while (std::size_t{wide} * wide * kBits < words.size() && wide < kMaxWords) ++wide;
    if (std::size_t{wide} * wide * kBits != words.size()) return Restored::refused;
    if (wide != 0 && !grow_to(wide * kBits - 1)) return Restored::out_of_memory;
    for (std::uint32_t a = 0; a < width_; ++a) {
      for (std::uint32_t b = a; b < width_; ++b) {
        if ((words[word(a, b)] >> b % kBits & 1U) != 0) set(a, b, false);
      }
    }
    return std::equal(words.begin(), words.end(), apart_.begin()) ? Restored::good
                                                                  : Restored::refused;
  }
  void swap(LayerMatrix& other) noexcept {
    apart_.swap(other.apart_);
    std::swap(width_, other.width_);
  }

  [[nodiscard]] Bytes bytes() const noexcept { return apart_.bytes(); }

 private:
  static constexpr std::uint32_t kBits = 64;
  static constexpr std::uint32_t kMaxWords = kSceneLayers / kBits;

  [[nodiscard]] std::size_t word(std::uint32_t row, std::uint32_t column) const noexcept {
    return std::size_t{row} * (width_ / kBits) + column / kBits;
  }

  Column<std::uint64_t> apart_;
  std::uint32_t width_ = 0;
};

}  // namespace winnow
