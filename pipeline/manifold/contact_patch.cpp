#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/patch_meetings.h"

#include <algorithm>
#include <cmath>

namespace winnow {

namespace {

// Twice the area of a triangle, positive if it is counter-clockwise.
double area(const PatchMeeting& a, const PatchMeeting& b, const PatchMeeting& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double squared_distance(const PatchMeeting& a, const PatchMeeting& b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

// The first of the points of the largest value.
template <typename Value>
std::uint32_t largest(const PatchMeetings& points, Value&& value) {
  std::uint32_t best = 0;
  double most = value(points.point[0]);
  for (std::uint32_t i = 1; i < points.count; ++i) {
    const double v = value(points.point[i]);
    if (v > most) {
      most = v;
      best = i;
    }
  }
  return best;
}

// The point 0, the one farthest from it, the one that makes the largest triangle with both, and the
// one that adds most to its area. Returns how many: none is taken twice.
std::uint32_t spread(const PatchMeetings& m, std::uint32_t kept[kManifoldPoints]) {
  const PatchMeeting& p = m.point[0];
  kept[0] = 0;
  kept[1] = largest(m, [&](const PatchMeeting& x) { return squared_distance(p, x); });
  const PatchMeeting& q = m.point[kept[1]];
  kept[2] = largest(m, [&](const PatchMeeting& x) { return std::abs(area(p, q, x)); });
  const PatchMeeting& r = m.point[kept[2]];
  const double turn = area(p, q, r) < 0.0 ? -1.0 : 1.0;
  kept[3] = largest(m, [&](const PatchMeeting& x) {
    return -std::min({turn * area(p, q, x), turn * area(q, r, x), turn * area(r, p, x)});
  });
  std::uint32_t count = 1;
  for (std::uint32_t i = 1; i < kManifoldPoints; ++i) {
    if (std::find(kept, kept + count, kept[i]) == kept + count) kept[count++] = kept[i];
  }
  return count;
}

ContactPoint write(const PatchMeeting& m, const PatchFrame& frame, const double rounding[2]) {
  const double top = m.height[0] + rounding[0];
  const double bottom = m.height[1] - rounding[1];
  const double middle = 0.5 * (top + bottom);
  ContactPoint point;
  for (int i = 0; i < 3; ++i) {
    point.position[i] = static_cast<float>(m.x * frame.axis[0][i] + m.y * frame.axis[1][i] +
                                           middle * frame.axis[2][i]);
  }
  point.depth = static_cast<float>(top - bottom);
  point.feature = static_cast<std::uint64_t>(m.id[0]) << 32U | m.id[1];
  return point;
}

}  // namespace

std::uint32_t contact_patch(const Patch& a, const Patch& b, const double normal[3], double margin,
                            ContactPoint* out) noexcept {
  if (a.count == 0 || b.count == 0) return 0;
  const PatchFrame frame(normal);
  const Outline outline[2] = {{a, frame, 1.0}, {b, frame, -1.0}};
  const double size = std::max(outline[0].size, outline[1].size);
  PatchMeetings m(kSamePlace * size);
  find_meetings(outline[0], outline[1], m);

  const double rounding[2] = {a.rounding, b.rounding};
  const auto rise = [](const PatchMeeting& x) { return x.height[0] - x.height[1]; };
  const double highest = rise(m.point[largest(m, rise)]);
  // Of equally deep points always the same is first.
  std::uint32_t deepest = 0;
  while (rise(m.point[deepest]) < highest - m.same) ++deepest;
  std::swap(m.point[0], m.point[deepest]);
  const double least = -margin - rounding[0] - rounding[1] - m.same;
  std::uint32_t kept = 1;
  for (std::uint32_t i = 1; i < m.count; ++i) {
    if (rise(m.point[i]) >= least) m.point[kept++] = m.point[i];
  }
  m.count = kept;

  std::uint32_t chosen[kManifoldPoints] = {0, 1, 2, 3};
  const std::uint32_t count = m.count > kManifoldPoints ? spread(m, chosen) : m.count;
  for (std::uint32_t i = 0; i < count; ++i) {
    out[i] = write(m.point[chosen[i]], frame, rounding);
  }
  return count;
}

}  // namespace winnow
