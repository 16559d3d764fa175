#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/footprint.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/shapes/pair_order.h"

#include <compare>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Bodies of a scene: two numbers and a code fit into 64 bits.
inline constexpr std::size_t kMaxBodies = std::size_t{1} << 28U;

/// A pair of bodies as one number, which sorts as pairs are sorted: by the kinds of their shapes,
/// then by a, then by b.
struct PairOrder {
  static constexpr unsigned kBodyBits = 28;
  static_assert(kMaxBodies <= std::size_t{1} << kBodyBits && KindPairs::kCount <= 256);

  std::uint64_t bits;

  [[nodiscard]] static constexpr PairOrder of(std::uint32_t code, BodyPair bodies) noexcept {
    return {(std::uint64_t{code} << kBodyBits | bodies.a) << kBodyBits | bodies.b};
  }
  [[nodiscard]] constexpr std::uint32_t code() const noexcept {
    return static_cast<std::uint32_t>(bits >> 2 * kBodyBits);
  }
  [[nodiscard]] constexpr BodyPair bodies() const noexcept {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << kBodyBits) - 1;
    return {static_cast<std::uint32_t>(bits >> kBodyBits & kMask),
            static_cast<std::uint32_t>(bits & kMask)};
  }
  friend constexpr auto operator<=>(const PairOrder&, const PairOrder&) noexcept = default;
};

/// What a rank of a cluster makes of its scene's pairs: bodies stand in an order of their own in
/// place of that of their numbers, and some pairs are another rank's.
struct PairSelection {
  std::span<const std::uint32_t> place;  ///< in that order, by body
  std::span<const std::uint32_t> body;   ///< by place
  bool (*wants)(const void* context, std::uint32_t a, std::uint32_t b) = nullptr;
  const void* context = nullptr;  ///< handed to `wants`
};

/// Pairs of bodies in the order of a scene's answers: by the kinds of their shapes, then by body; a
/// is the body with the smaller kind, or the smaller number.
class BodyPairs {
 public:
  explicit BodyPairs(std::pmr::memory_resource* memory) noexcept
      : items_{Column<std::uint64_t>(memory), Column<std::uint64_t>(memory)} {}

  /// Pairs of objects of two partitions, and which bodies these are.
  struct Source {
    std::span<const Pair> pairs;
    const std::uint32_t* first_body;
    const std::uint32_t* second_body;
  };

  /// Takes all pairs of the sources. `bodies`: every body's number is below it, at most kMaxBodies.
  /// `selection`: null for all pairs, by number. O(n).
  Status assign(std::span<const Source> sources, const ShapeId* shapes, std::size_t bodies,
                const Execution& execution, const PairSelection* selection = nullptr);

  /// Room for so many pairs. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages) noexcept {
    return items_[0].reserve(count, pages) && items_[1].reserve(count, pages);
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Pair i, below `size()`.
  [[nodiscard]] BodyPair operator[](std::size_t i) const noexcept {
    const std::uint64_t item = items_[sorted_][i];
    const std::uint64_t mask = (std::uint64_t{1} << bits_) - 1;
    return {static_cast<std::uint32_t>(item >> bits_ & mask),
            static_cast<std::uint32_t>(item & mask)};
  }
  [[nodiscard]] PairOrder order(std::size_t i) const noexcept {
    return PairOrder::of(static_cast<std::uint32_t>(items_[sorted_][i] >> 2 * bits_), (*this)[i]);
  }
  /// Pairs of a code are [first(code), first(code + 1)).
  [[nodiscard]] std::uint32_t first(std::uint32_t code) const noexcept { return first_[code]; }
  /// Grows with every `assign`.
  [[nodiscard]] std::uint64_t serial() const noexcept { return serial_; }
  /// What the partitions had gone through when the pairs were taken.
  std::uint64_t changes[3] = {~0ULL, ~0ULL, ~0ULL};

  void clear() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// Packs the pairs of the sources into items, and tells how many they are.
  std::size_t pack(std::span<const Source> sources, const ShapeId* shapes,
                   const Execution& execution, const PairSelection* selection);
  /// Places of a selection become bodies.
  void name_bodies(const PairSelection& selection, const Execution& execution) noexcept;

  /// Code, body a and body b as one number; and room to sort them.
  Column<std::uint64_t> items_[2];
  /// Which of the two is sorted.
  unsigned sorted_ = 0;
  /// That a body's number takes in an item.
  unsigned bits_ = 0;
  std::size_t size_ = 0;
  std::uint32_t first_[KindPairs::kCount + 1] = {};
  std::uint64_t serial_ = 0;
};

}  // namespace winnow
