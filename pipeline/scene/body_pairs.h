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

/// A ball that holds a body as large as the box that its partition has.
struct BodyBall {
  float center[3];
  float radius;
};

/// True only if the two share no point, whatever the rounding.
[[nodiscard]] inline bool are_apart(const BodyBall& a, const BodyBall& b) noexcept {
  // More than a sum of three squares of float differences is off by: as a share, and where squares
  // are too small for floats.
  constexpr float kSlack = 1.0F + 0x1p-19F;
  constexpr float kLeast = 1e-36F;
  const float x = a.center[0] - b.center[0];
  const float y = a.center[1] - b.center[1];
  const float z = a.center[2] - b.center[2];
  const float reach = a.radius + b.radius;
  // False of what is not a number, too.
  return x * x + y * y + z * z > reach * reach * kSlack + kLeast;
}

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
      : items_{Column<std::uint64_t>(memory), Column<std::uint64_t>(memory)},
        wanted_(memory),
        counts_(memory) {}

  /// Pairs of objects of two partitions, and which bodies these are.
  struct Source {
    std::span<const Pair> pairs;
    const std::uint32_t* first_body;
    const std::uint32_t* second_body;

    [[nodiscard]] BodyPair bodies(std::size_t i) const noexcept {
      return {first_body[pairs[i].first], second_body[pairs[i].second]};
    }
  };

  static constexpr std::size_t kMostSources = 3;

  /// What is known of bodies, by number.
  struct Known {
    const ShapeId* shapes;
    /// Null: pairs whose balls are apart are taken too.
    const BodyBall* balls;
    /// Every body's number is below it, at most kMaxBodies.
    std::size_t bodies;
    /// Null for all pairs, by number.
    const PairSelection* selection;
  };

  /// Takes the pairs of at most kMostSources. O(n).
  Status assign(std::span<const Source> sources, const Known& known, const Execution& execution);

  /// Room for so many pairs. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages) noexcept {
    return items_[0].reserve(count, pages) && items_[1].reserve(count, pages) &&
           reserve_choice(count, pages);
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Pairs were taken whether their balls are apart or not.
  [[nodiscard]] bool are_all() const noexcept { return are_all_; }
  /// Of the pairs that were given, how many were not taken since their balls are apart.
  [[nodiscard]] std::size_t apart() const noexcept { return apart_; }
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
  /// The room in which they were sorted, for anything until pairs are taken anew.
  [[nodiscard]] Column<std::uint64_t>& spare() noexcept { return items_[1 - sorted_]; }
  /// Grows with every `assign`.
  [[nodiscard]] std::uint64_t serial() const noexcept { return serial_; }
  /// What the partitions had gone through when the pairs were taken.
  std::uint64_t changes[3] = {~0ULL, ~0ULL, ~0ULL};

  void clear() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool reserve_choice(std::size_t count, Pages pages) noexcept;
  void choose(std::span<const Source> sources, const Known& known,
              const Execution& execution) noexcept;
  void pack(std::span<const Source> sources, const Known& known,
            const Execution& execution) noexcept;
  /// Places of a selection become bodies.
  void name_bodies(const PairSelection& selection, const Execution& execution) noexcept;

  /// Code, body a and body b as one number; and room to sort them.
  Column<std::uint64_t> items_[2];
  /// Which of the two is sorted.
  unsigned sorted_ = 0;
  /// That a body's number takes in an item.
  unsigned bits_ = 0;
  std::size_t size_ = 0;
  std::size_t apart_ = 0;
  bool are_all_ = false;
  /// A bit for each pair that was given; and by stretch of them, how many are taken, then where
  /// they are put, and how many are apart.
  Column<std::uint64_t> wanted_;
  struct Count {
    std::uint32_t taken;
    std::uint32_t apart;
  };
  Column<Count> counts_;
  std::uint64_t serial_ = 0;
};

}  // namespace winnow
