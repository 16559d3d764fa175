#include "pipeline/composites/edge_contact.h"

#include <cmath>

namespace winnow::mid {
namespace {

// Of the size: corners whose heights differ by less are equally far along the normal. Narrow-phase
// normals of tier `fast` are as exact as that.
constexpr double kLevel = 1e-6;
constexpr double kSameNormal = 1e-13;

}  // namespace

EdgeContact classify(const TriangleShape& triangle, std::uint8_t active, const Vec& away,
                     Vec& face) noexcept {
  Vec corner[3];
  for (int i = 0; i < 3; ++i) corner[i] = Eigen::Map<const Vec>(triangle.vertex[i]);
  const Vec edge[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const Vec normal = edge[0].cross(edge[1]);
  const double length = normal.norm();
  // NaN fails too.
  if (!(length > 0.0 && length < kInfinity)) return EdgeContact::real;
  const double rise = normal.dot(away) / length;
  face = normal / (rise < 0.0 ? -length : length);
  if ((away - face).squaredNorm() <= kSameNormal * kSameNormal) return EdgeContact::real;

  double height[3];
  for (int i = 0; i < 3; ++i) height[i] = corner[i].dot(away);
  const double top = std::max({height[0], height[1], height[2]});
  const double level =
      kLevel *
      std::sqrt(std::max({edge[0].squaredNorm(), edge[1].squaredNorm(), edge[2].squaredNorm()}));
  int highest = 0;
  for (int i = 0; i < 3; ++i) highest += top - height[i] <= level ? 1 : 0;
  if (highest == 3) return EdgeContact::nearly_face;
  for (int i = 0; i < 3; ++i) {
    // On an active edge of another triangle. Those of this one are asked below.
    const bool is_own = (active >> i & 1U) != 0 || (active >> (i + 2) % 3 & 1U) != 0;
    const bool is_active = (active >> (3 + i) & 1U) != 0;
    if (highest == 1 && top - height[i] <= level && is_active && !is_own) return EdgeContact::real;
  }
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if ((active >> i & 1U) == 0) continue;
    const bool ends[2] = {top - height[i] <= level, top - height[next] <= level};
    // An edge of which both ends are highest, or one end that alone is.
    if (ends[0] && ends[1]) return EdgeContact::real;
    if (highest != 1 || (!ends[0] && !ends[1])) continue;
    // A corner belongs to the edge if the other shape is beyond the edge. Seen from the face's
    // side that `away` is on, edges may run either way.
    const Vec inward = corner[(i + 2) % 3] - corner[i];
    const Vec along = edge[i] / edge[i].norm();
    if ((inward - along * along.dot(inward)).dot(away) < 0.0) return EdgeContact::real;
  }
  return EdgeContact::inner;
}

}  // namespace winnow::mid
