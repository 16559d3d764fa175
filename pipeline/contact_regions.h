#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/pipeline/contact_types.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Manifolds of one pair of bodies whose normals are within 5 degrees of that of the deepest of
/// them are one region: the angle by which Jolt tells its manifolds apart. The cosine.
inline constexpr double kRegionCosine = 0.99619469809174555;

/// What is left of the manifolds of one region.
struct ContactRegion {
  /// Of the deepest manifold: unit, from a to b, in the axes of the world.
  double normal[3];
  double distance;     ///< the smallest of the region
  double error_bound;  ///< the largest of the region
  /// The parts of the deepest manifold.
  std::uint32_t part[2];
  /// The deepest point of all, which comes first, and those that span the widest area: each of
  /// them a corner of what two parts share, with the position and depth that it has there. Relative
  /// to the position of body a of the pair of bodies. Features tell the points of a region apart
  /// and are the same from frame to frame, but name nothing; a vertex keeps its own while it slides
  /// over faces of other parts.
  std::uint32_t count;
  ContactPoint point[kManifoldPoints];  ///< of which the first `count` are set
};

/// Regions of contact of pairs of bodies: what MidPhase::reduce makes of the manifolds of their
/// parts. The caller's, reused from frame to frame.
class WINNOW_API ContactRegions {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// use.
  explicit ContactRegions(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Pairs of bodies.
  [[nodiscard]] std::size_t size() const noexcept { return count.size(); }
  /// Regions of pair i, that of the deepest manifold first; none if it does not touch.
  [[nodiscard]] std::span<const ContactRegion> of(std::size_t pair) const noexcept {
    return {regions.data() + first[pair], count[pair]};
  }

  /// Forgets all regions; memory is kept.
  void clear() noexcept;
  /// Regions under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

  /// Places for as many regions as manifolds touch: those of pair i are [first[i], first[i + 1]),
  /// of which the first count[i] are taken.
  Column<ContactRegion> regions;
  /// Where the places of each pair begin, and where the last ones end.
  Column<std::uint32_t> first;
  Column<std::uint32_t> count;  ///< regions of each pair
  /// Of each pair of parts: where its answer is, which answers touch, and their regions.
  Column<std::uint32_t> scratch;
};

}  // namespace winnow
