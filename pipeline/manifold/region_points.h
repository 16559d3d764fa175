#pragma once

// Chooses the points of one contact region from the manifolds that are merged into it. Called by
// composites/manifold_reduction.cpp.

#include <winnow/pipeline/contact_types.h>
#include "pipeline/manifold/polygon_clip.h"

#include <cstdint>

namespace winnow {

/// Lengths that differ by less than this share of the largest coordinate of a pair's points count
/// as equal. This is several times the error of rounding a position to float.
inline constexpr double kRegionTie = 1e-6;

/// Combines a feature id with the parts that it belongs to. If a vertex of one body touches a face
/// of the other, the face and its part are ignored: the id stays while the vertex slides from
/// triangle to triangle.
[[nodiscard]] std::uint64_t feature_among_parts(std::uint64_t feature,
                                                const std::uint32_t (&part)[2]) noexcept;

/// The points of one region, projected along its normal, and the choice of at most kManifoldPoints
/// of them.
///
/// The chosen points span the widest area: first the outermost point along a direction; then, up to
/// three times, the point farthest from the convex hull of the chosen ones, if it is outside of
/// that hull. Distances that differ by less than 1/1000 of the span count as equal, and the
/// outermost point along the direction wins. So, up to this tolerance, a dropped point is no
/// farther from the hull than the last chosen point was from the hull of the previous ones. If no
/// chosen point is as deep as the deepest (up to kTiedDepth), the deepest is added, or replaces the
/// last one if there are kManifoldPoints. A resting face therefore keeps the same corners from
/// frame to frame, however many points lie along its sides and however regular it is.
class RegionPoints {
 public:
  /// Lengths that differ by at most `tie` count as equal. `direction` is arbitrary, but fixed in a
  /// body.
  RegionPoints(const double normal[3], const double direction[3], double tie) noexcept;

  /// Adds a point of the manifold of two parts. `offset` is the origin of its position. Amortized
  /// O(1): beyond kRoom points, keeps only the outermost in sixteen directions and the deepest.
  void add(const ContactPoint& contact, const double* offset,
           const std::uint32_t (&part)[2]) noexcept;

  /// Adds a point that is chosen only if it is deeper than all points of `add`, or if there are
  /// none.
  void add_beside(const ContactPoint& contact, const double* offset,
                  const std::uint32_t (&part)[2]) noexcept;

  /// Writes the chosen points (room for kManifoldPoints), the deepest first, and returns their
  /// number; 0 only if none was added. The first point has the depth of the deepest, the others
  /// their own depth. Feature ids are made by feature_among_parts.
  std::uint32_t choose(ContactPoint* out) noexcept;

 private:
  static constexpr std::uint32_t kRoom = 64;

  struct RegionPoint {
    double x;
    double y;
    /// Coordinate along the direction.
    double along;
    ContactPoint contact;
    std::uint32_t part[2];
  };
  using Chosen = std::uint32_t[kManifoldPoints];

  template <typename Value>
  [[nodiscard]] std::uint32_t first_of_largest(Value&& value, double slack,
                                               double& most) const noexcept;
  [[nodiscard]] double distance_from_hull(const RegionPoint& p, const Chosen& hull,
                                          std::uint32_t count) const noexcept;
  [[nodiscard]] std::uint32_t spread(Chosen& chosen, double span) const noexcept;
  [[nodiscard]] double span_from(std::uint32_t point) const noexcept;
  void thin() noexcept;
  [[nodiscard]] RegionPoint point_of(const ContactPoint& contact, const double* offset,
                                     const std::uint32_t (&part)[2]) const noexcept;
  void keep(const RegionPoint& point) noexcept;
  [[nodiscard]] std::uint32_t deepest() const noexcept;
  [[nodiscard]] const RegionPoint& deepest_at(const RegionPoint& place) const noexcept;

  PatchFrame frame_;
  double direction_[3];
  double tie_;
  std::uint32_t count_ = 0;
  RegionPoint point_[kRoom];
  bool has_beside_ = false;
  RegionPoint beside_;
};

}  // namespace winnow
