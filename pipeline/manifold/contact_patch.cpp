#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/patch_meetings.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// The corners of what two patches share that are within the margin, the deepest first.
struct SharedPatch {
  PatchFrame frame;
  PatchMeetings corners;
  double rounding[2];

  SharedPatch(const Patch& a, const Patch& b, const double normal[3], double margin) noexcept
      : frame(normal), corners(0.0), rounding{a.rounding, b.rounding} {
    meet({a, frame, 1.0}, {b, frame, -1.0}, margin);
  }
  SharedPatch(const SeenFaces& faces, double margin) noexcept
      : frame(faces), corners(0.0), rounding{faces.rounding[0], faces.rounding[1]} {
    meet({faces, 0}, {faces, 1}, margin);
  }

  /// Writes the deepest one and those that span the largest area with it.
  std::uint32_t write_widest(ContactPoint* out) const noexcept {
    std::uint32_t chosen[kManifoldPoints] = {0, 1, 2, 3};
    const std::uint32_t found = corners.count;
    const std::uint32_t count = found > kManifoldPoints ? spread(corners, chosen) : found;
    for (std::uint32_t i = 0; i < count; ++i) out[i] = contact(chosen[i]);
    return count;
  }

  [[nodiscard]] ContactPoint contact(std::uint32_t i) const noexcept {
    return write(corners.point[i], frame, rounding);
  }

 private:
  void meet(const Outline& a, const Outline& b, double margin) noexcept {
    corners.same = kSamePlace * std::max(a.size, b.size);
    find_meetings(a, b, corners);
    put_deepest_first();
    drop_beyond(margin);
  }

  [[nodiscard]] static double rise(const PatchMeeting& m) noexcept {
    return m.height[0] - m.height[1];
  }

  void put_deepest_first() noexcept {
    const double highest = rise(corners.point[largest(corners, rise)]);
    // Of equally deep points always the same is first.
    std::uint32_t deepest = 0;
    while (rise(corners.point[deepest]) < highest - corners.same) ++deepest;
    std::swap(corners.point[0], corners.point[deepest]);
  }

  void drop_beyond(double margin) noexcept {
    const double least = -margin - rounding[0] - rounding[1] - corners.same;
    std::uint32_t kept = 1;
    for (std::uint32_t i = 1; i < corners.count; ++i) {
      if (rise(corners.point[i]) >= least) corners.point[kept++] = corners.point[i];
    }
    corners.count = kept;
  }
};

static_assert(kSharedCorners == 2 * kOutlineVertices);

}  // namespace

std::uint32_t contact_patch(const Patch& a, const Patch& b, const double normal[3], double margin,
                            ContactPoint* out) noexcept {
  if (a.count == 0 || b.count == 0) return 0;
  return SharedPatch(a, b, normal, margin).write_widest(out);
}

std::uint32_t seen_contacts(const SeenFaces& faces, double margin, ContactPoint* out) noexcept {
  return SharedPatch(faces, margin).write_widest(out);
}

std::uint32_t shared_corners(const Patch& a, const Patch& b, const double normal[3], double margin,
                             ContactPoint* out) noexcept {
  if (a.count == 0 || b.count == 0) return 0;
  const SharedPatch shared(a, b, normal, margin);
  for (std::uint32_t i = 0; i < shared.corners.count; ++i) out[i] = shared.contact(i);
  return shared.corners.count;
}

namespace {

Patch view(const FlatPatch& p) {
  return {p.vertex, p.vertex_feature, p.edge_feature, p.count, p.feature, p.rounding};
}

// Without places.
FlatPatch named(const FaceNames& names, double rounding) {
  FlatPatch patch;
  patch.count = names.count;
  patch.feature = names.face;
  patch.rounding = rounding;
  std::copy_n(names.vertex, 4, patch.vertex_feature);
  std::copy_n(names.edge, 4, patch.edge_feature);
  return patch;
}

}  // namespace

FlatPatch box_patch(const BoxFrame& box, const double normal[3]) noexcept {
  double rise[3];
  for (int i = 0; i < 3; ++i) rise[i] = dot(box.axis[i], normal);
  std::uint32_t i = std::abs(rise[1]) > std::abs(rise[0]) ? 1 : 0;
  if (std::abs(rise[2]) > std::abs(rise[i])) i = 2;
  const std::uint32_t k = (i + 1) % 3;
  const std::uint32_t l = (i + 2) % 3;
  const bool up = rise[i] > 0.0;
  const FaceNames& names = kFaceNames[2 * i + (up ? 1 : 0)];
  FlatPatch patch = named(names, box.rounding);
  for (std::uint32_t c = 0; c < 4; ++c) {
    const double arm_i = up ? box.half[i] : -box.half[i];
    const double arm_k = kPlusCorner[c][0] ? box.half[k] : -box.half[k];
    const double arm_l = kPlusCorner[c][1] ? box.half[l] : -box.half[l];
    for (int r = 0; r < 3; ++r) {
      patch.vertex[c][r] = box.center[r] + (arm_i * box.axis[i][r] +
                                            (arm_k * box.axis[k][r] + arm_l * box.axis[l][r]));
    }
  }
  return patch;
}

FlatPatch triangle_patch(const TriangleFrame& triangle) noexcept {
  FlatPatch patch = named(kFaceNames[kTriangleFace], triangle.rounding);
  for (std::uint32_t i = 0; i < 3; ++i) std::copy_n(triangle.vertex[i], 3, patch.vertex[i]);
  return patch;
}

std::uint32_t flat_contacts(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                            double margin, ContactPoint* out) noexcept {
  return contact_patch(view(a), view(b), normal, margin, out);
}

double deepest_point(const Patch& a, const Patch& b, const double normal[3],
                     double point[3]) noexcept {
  const PatchFrame frame(normal);
  const Outline outline[2] = {{a, frame, 1.0}, {b, frame, -1.0}};
  PatchMeetings m(kSamePlace * std::max(outline[0].size, outline[1].size));
  find_meetings(outline[0], outline[1], m);
  const PatchMeeting* best = m.point;
  for (std::uint32_t i = 1; i < m.count; ++i) {
    const PatchMeeting& p = m.point[i];
    if (p.height[0] - p.height[1] > best->height[0] - best->height[1]) best = &p;
  }
  for (int r = 0; r < 3; ++r) {
    point[r] = best->x * frame.axis[0][r] + best->y * frame.axis[1][r] +
               best->height[0] * frame.axis[2][r];
  }
  const bool meets = m.apart <= m.same;
  return meets ? best->height[0] - best->height[1] : -std::numeric_limits<double>::infinity();
}

double deepest_point(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                     double point[3]) noexcept {
  return deepest_point(view(a), view(b), normal, point);
}

}  // namespace winnow
