#pragma once

#include <winnow/core/memory.h>
#include <winnow/pipeline/contact_types.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Cosine of 5 degrees. Manifolds of a pair of bodies whose normals are within this angle of the
/// normal of the deepest one form a region. Jolt uses the same angle.
inline constexpr double kRegionCosine = 0.99619469809174555;

/// The merged manifold of one contact region.
struct ContactRegion {
  /// Normal of the deepest manifold: a unit vector from a to b, in world axes.
  double normal[3];
  double distance;     ///< smallest distance of the region
  double error_bound;  ///< largest error bound of the region
  /// Parts of the deepest manifold.
  std::uint32_t part[2];
  /// Number of points: the deepest point of the region, which is first, and points that span the
  /// largest area. Each is a vertex of the contact polygon of two parts, with its own position and
  /// depth. Positions are relative to the position of body a of the pair of bodies. Features
  /// distinguish the points of a region and persist from frame to frame, but do not identify a
  /// geometric feature; a vertex keeps its feature while it slides over faces of other parts.
  std::uint32_t count;
  ContactPoint point[kManifoldPoints];  ///< only the first `count` are set
};

/// Contact regions of pairs of bodies, computed by mid::reduce_contacts from the manifolds of
/// their parts. The caller keeps the object from frame to frame.
class ContactRegions {
 public:
  /// Creates an empty list. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first use.
  explicit ContactRegions(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Returns the number of pairs of bodies.
  [[nodiscard]] std::size_t size() const noexcept { return count.size(); }
  /// Returns the regions of a pair, the one with the deepest manifold first; empty if the pair does
  /// not touch.
  [[nodiscard]] std::span<const ContactRegion> of(std::size_t pair) const noexcept {
    return {regions.data() + first[pair], count[pair]};
  }

  /// Removes all regions; memory is kept.
  void clear() noexcept;
  /// Returns the bytes of regions under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

  /// Regions, with room for one per manifold that touches. The room of pair i is [first[i], first[i
  /// + 1]); only the first count[i] elements are set.
  Column<ContactRegion> regions;
  /// Start of each pair's room, and the end of the last.
  Column<std::uint32_t> first;
  Column<std::uint32_t> count;  ///< number of regions of each pair
  /// For each pair of parts: the position of its answer; then answers that touch, and their
  /// regions.
  Column<std::uint32_t> scratch;
};

}  // namespace winnow
