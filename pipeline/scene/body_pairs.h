#pragma once

// The sorted list of a scene's pairs of bodies, made from the pairs that its partitions find.
// SceneState::find_pairs fills it; Collision (collide.cpp) reads it.

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/shapes/pair_order.h"

#include <compare>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Largest number of bodies in a scene: two body numbers and a code for the shape kinds fit into 64
/// bits.
inline constexpr std::size_t kMaxBodies = std::size_t{1} << 28U;

/// A pair of bodies as a 64-bit sort key: by the kinds of their shapes, then by a, then by b.
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

/// A ball around a body, grown like its box in the partition.
struct BodyBall {
  float center[3];
  float radius;
};

/// True only if the balls are disjoint; rounding never makes it true.
[[nodiscard]] inline bool are_apart(const BodyBall& a, const BodyBall& b) noexcept {
  // kSlack bounds the relative error of the sum of squares of float differences; kMinSquare covers
  // squares that underflow.
  constexpr float kSlack = 1.0F + 0x1p-19F;
  constexpr float kMinSquare = 1e-36F;
  const float x = a.center[0] - b.center[0];
  const float y = a.center[1] - b.center[1];
  const float z = a.center[2] - b.center[2];
  const float reach = a.radius + b.radius;
  // NaN compares false.
  return x * x + y * y + z * z > reach * reach * kSlack + kMinSquare;
}

/// On a rank of a cluster: replaces the order of bodies by their numbers with an order that all
/// ranks share, and drops pairs that belong to other ranks.
struct PairSelection {
  std::span<const std::uint32_t> place;  ///< by body: its position in the shared order
  std::span<const std::uint32_t> body;   ///< by position in the shared order
  bool (*accept)(const void* context, std::uint32_t a, std::uint32_t b) = nullptr;
  const void* context = nullptr;  ///< passed to `accept`
};

/// Pairs of bodies sorted by the kinds of their shapes, then by body. In a pair, a is the body with
/// the smaller kind, or with the smaller number if the kinds are equal.
class BodyPairs {
 public:
  explicit BodyPairs(std::pmr::memory_resource* memory) noexcept
      : items_{Column<std::uint64_t>(memory), Column<std::uint64_t>(memory)},
        kept_(memory),
        counts_(memory) {}

  /// Pairs of objects of two partitions, with the tables that map objects to bodies.
  struct PairSource {
    std::span<const Pair> pairs;
    const std::uint32_t* first_body;
    const std::uint32_t* second_body;

    [[nodiscard]] BodyPair bodies(std::size_t i) const noexcept {
      return {first_body[pairs[i].first], second_body[pairs[i].second]};
    }
  };

  static constexpr std::size_t kMaxSources = 3;

  /// Data of bodies, by number.
  struct BodyData {
    const ShapeId* shapes;
    /// Null: pairs whose balls are disjoint are kept too.
    const BodyBall* balls;
    /// All body numbers are below this; at most kMaxBodies.
    std::size_t bodies;
    /// Null: keeps all pairs and orders bodies by number.
    const PairSelection* selection;
  };

  /// Replaces the pairs with the pairs of at most kMaxSources sources. Tasks choose the pairs to
  /// keep and pack them as items, which a radix sort then orders: the order does not depend on the
  /// sources or on threads. O(n).
  Status assign(std::span<const PairSource> sources, const BodyData& known,
                const Execution& execution);

  /// Reserves for `count` pairs. Returns false if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages) noexcept {
    return items_[0].reserve(count, pages) && items_[1].reserve(count, pages) &&
           reserve_choice(count, pages);
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// True if `assign` kept pairs whose balls are disjoint.
  [[nodiscard]] bool are_all() const noexcept { return are_all_; }
  /// Number of pairs that `assign` dropped because their balls are disjoint.
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
  /// The second sort buffer, free for other use until the next `assign`.
  [[nodiscard]] Column<std::uint64_t>& spare() noexcept { return items_[1 - sorted_]; }
  /// Incremented by every `assign`.
  [[nodiscard]] std::uint64_t serial() const noexcept { return serial_; }
  /// SceneSet::changes of the sets when the pairs were found.
  std::uint64_t changes[3] = {~0ULL, ~0ULL, ~0ULL};

  void clear() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool reserve_choice(std::size_t count, Pages pages) noexcept;
  void choose(std::span<const PairSource> sources, const BodyData& known,
              const Execution& execution) noexcept;
  void pack(std::span<const PairSource> sources, const BodyData& known,
            const Execution& execution) noexcept;
  /// Replaces positions of a selection with body numbers.
  void name_bodies(const PairSelection& selection, const Execution& execution) noexcept;

  /// Code, body a and body b as one number; and a second buffer for sorting.
  Column<std::uint64_t> items_[2];
  /// Index of the buffer that contains the sorted pairs.
  unsigned sorted_ = 0;
  /// Bits of a body number in an item.
  unsigned bits_ = 0;
  std::size_t size_ = 0;
  std::size_t apart_ = 0;
  bool are_all_ = false;
  /// One bit for each source pair, set if it is kept; and for each range of pairs, the number kept
  /// (later the write position) and the number dropped because the balls are disjoint.
  Column<std::uint64_t> kept_;
  struct RangeCount {
    std::uint32_t taken;
    std::uint32_t apart;
  };
  Column<RangeCount> counts_;
  std::uint64_t serial_ = 0;
};

}  // namespace winnow
