#pragma once

// Which points of the manifolds of one region of contact stay.

#include <winnow/pipeline/contact_types.h>
#include "pipeline/manifold/patch_meetings.h"

#include <cstdint>

namespace winnow {

/// As a share of the largest coordinate of a pair's points: lengths that differ by less are equal.
/// A few times what rounding a position to float costs.
inline constexpr double kRegionTie = 1e-6;

/// A feature among those of other parts of the same bodies. A vertex of one body is the same
/// whatever face of the other it lies on, so that it keeps its name while it slides from triangle
/// to triangle.
[[nodiscard]] std::uint64_t feature_among_parts(std::uint64_t feature,
                                                const std::uint32_t (&part)[2]) noexcept;

/// The points of one region, seen along its normal, and the few of them that say the most.
///
/// Kept are points that span the widest area: one that is outermost along a direction, then three
/// times the one that is farthest from the convex hull of those kept, as long as it is outside. Of
/// those that are equally far, but for a thousandth of what the points span, it is the outermost
/// along the direction. No point that is dropped is then farther from that hull, but for as much,
/// than the last one kept was from the hull of those before. If none of them is as deep as the
/// deepest of all (but for kTiedDepth), that one takes the place of the last. So a face that rests
/// keeps its corners, the same from frame to frame, however many points lie along its sides and
/// however regular it is.
class RegionPoints {
 public:
  /// Places that differ by no more than `tie` are the same. `direction`: any, fixed in a body.
  RegionPoints(const double normal[3], const double direction[3], double tie) noexcept;

  /// A point of the manifold of two parts, and where the body of a stands that the parts are of.
  /// O(1) amortized; of more than some sixty points those stay that are outermost in sixteen
  /// directions, and the deepest.
  void add(const ContactPoint& contact, const double* offset,
           const std::uint32_t (&part)[2]) noexcept;

  /// A point that counts only if it is deeper than all others that are added.
  void add_beside(const ContactPoint& contact, const double* offset,
                  const std::uint32_t (&part)[2]) noexcept;

  /// Writes the points that are kept (room for kManifoldPoints), the deepest first, and returns how
  /// many; 0 only if none was added. The first has the depth of the deepest, the others their own.
  /// Features are those among parts.
  std::uint32_t choose(ContactPoint* out) noexcept;

 private:
  static constexpr std::uint32_t kRoom = 64;

  struct Point {
    double x;
    double y;
    /// The direction.
    double along;
    ContactPoint contact;
    std::uint32_t part[2];
  };
  using Chosen = std::uint32_t[kManifoldPoints];

  template <typename Value>
  [[nodiscard]] std::uint32_t first_of_largest(Value&& value, double slack,
                                               double& most) const noexcept;
  [[nodiscard]] double distance_from_hull(const Point& p, const Chosen& hull,
                                          std::uint32_t count) const noexcept;
  [[nodiscard]] std::uint32_t spread(Chosen& chosen, double span) const noexcept;
  [[nodiscard]] double span_from(std::uint32_t point) const noexcept;
  void thin() noexcept;
  [[nodiscard]] Point point_of(const ContactPoint& contact, const double* offset,
                               const std::uint32_t (&part)[2]) const noexcept;
  void keep(const Point& point) noexcept;
  [[nodiscard]] std::uint32_t deepest() const noexcept;
  [[nodiscard]] const Point& deepest_at(const Point& place) const noexcept;

  PatchFrame frame_;
  double direction_[3];
  double tie_;
  std::uint32_t count_ = 0;
  Point point_[kRoom];
  bool has_beside_ = false;
  Point beside_;
};

}  // namespace winnow
