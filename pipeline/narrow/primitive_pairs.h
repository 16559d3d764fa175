#pragma once

#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Margins of pairs of bodies or primitives: one for all pairs, or one per pair. Pairs farther
/// apart than their margin are ignored.
struct PairMargins {
  /// Uses the same margin for all pairs; implicit, so that a number can be passed.
  PairMargins(double margin) noexcept : largest(margin) {}
  /// Uses one margin per pair; `most` is not below any of them.
  PairMargins(double most, std::span<const double> margins) noexcept
      : largest(most), each(margins) {}

  double largest;                ///< upper bound of all margins
  std::span<const double> each;  ///< one per pair; empty if all equal `largest`

  /// Returns the margin of a pair.
  [[nodiscard]] double of(std::size_t pair) const noexcept {
    return each.empty() ? largest : each[pair];
  }
};

/// Pairs of convex primitives that may touch: the input of the narrow phase for pairs of bodies
/// with composite shapes. Coordinates are relative to the position of body a of the pair of bodies,
/// in world axes, so that precision is the same far from the origin of the world.
class PrimitivePairs {
 public:
  /// Creates an empty list. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first use.
  explicit PrimitivePairs(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Removes all pairs; memory is kept.
  void clear() noexcept;
  /// Returns the bytes of readable columns under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

  /// The primitives, one entry per use: shape (triangles are in `triangles`, hulls may be in
  /// `hulls`, all others in the ShapePool) and pose.
  Column<ShapeId> shapes;
  Column<Pose> poses;  ///< pose of each primitive
  /// Part of the body: the number of the triangle or child; kWholeShape for a convex body.
  Column<std::uint32_t> part;
  /// All triangles, of meshes, height fields and the ShapePool, each in the frame of its pose.
  /// Triangle ids in `shapes` are indices of this column.
  Column<TriangleShape> triangles;
  /// Flags of each entry of `triangles`. Bit k is set if edge k (from vertex k to the next) is
  /// active, that is, not internal to the surface. Bit 3 + k is set if vertex k is on an active
  /// edge of any triangle. A contact at an active feature may have a normal other than the face
  /// normal. kAllActive for triangles that belong to no mesh. kOneSided is set if the triangle is
  /// one-sided; kClockwise is set if it is one-sided and its vertices are clockwise as seen from
  /// its front.
  Column<std::uint8_t> active_edges;
  static constexpr std::uint8_t kAllActive = 63;   ///< all edges and vertices are active
  static constexpr std::uint8_t kOneSided = 64;    ///< the triangle is one-sided
  static constexpr std::uint8_t kClockwise = 128;  ///< clockwise vertices as seen from the front
  /// The hulls of the ShapePool, then those of convex solids. Empty without convex solids: hull ids
  /// in `shapes` then belong to the ShapePool.
  Column<HullShape> hulls;
  /// Pairs of primitives, grouped by pair of bodies, in the order of the pairs of bodies; `a`
  /// belongs to body a.
  Column<BodyPair> pairs;
  /// The pairs of primitives of body pair i are [first[i], first[i + 1]).
  Column<std::uint32_t> first;
  /// Output of parallel tasks before it is put in order.
  Column<std::uint32_t> scratch;

  /// Returns the tables of the pool with `triangles` and `hulls` in place of the pool's.
  [[nodiscard]] ShapeTables tables(const ShapePool& pool) const noexcept;
};

}  // namespace winnow
