#pragma once

#include "pipeline/manifold/contact_patch.h"

#include <cmath>
#include <cstdint>

namespace winnow {

inline constexpr std::uint32_t kOutlineVertices = 16;

/// As a share of the patches' size: places that are closer are one.
inline constexpr double kSamePlace = 1e-9;

[[nodiscard]] inline double dot(const double a[3], const double b[3]) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Axes in which the normal is the third.
struct PatchFrame {
  double axis[3][3];

  /// `normal` is a unit vector.
  explicit PatchFrame(const double normal[3]) noexcept;
  explicit PatchFrame(const SeenFaces& faces) noexcept;
};

[[nodiscard]] constexpr std::uint32_t feature_id(FeatureKind kind, std::uint32_t number) noexcept {
  return static_cast<std::uint32_t>(kind) << kFeatureKindShift | (number & 0x3FFFFFFFU);
}

/// What the faces of boxes and triangles are called, and their vertices and edges: as numbers of
/// their kind.
struct FaceNames {
  std::uint32_t count;
  std::uint32_t face;
  std::uint32_t vertex[4];
  std::uint32_t edge[4];
};

/// Corners of face 2 i + up of a box lie at (-, -), (+, -), (+, +), (-, +) of the axes after i.
inline constexpr bool kPlusCorner[4][2] = {
    {false, false}, {true, false}, {true, true}, {false, true}};

/// Vertices are numbered by the bits x > 0, y > 0, z > 0, edges by 4 x their axis and the bits of
/// the others.
[[nodiscard]] constexpr FaceNames box_face_names(std::uint32_t face) noexcept {
  const std::uint32_t i = face / 2;
  const std::uint32_t k = (i + 1) % 3;
  const std::uint32_t l = (i + 2) % 3;
  const std::uint32_t up = face % 2 << i;
  FaceNames names{4, face, {}, {}};
  for (std::uint32_t c = 0; c < 4; ++c) {
    const std::uint32_t at_k = kPlusCorner[c][0] ? 1U << k : 0U;
    const std::uint32_t at_l = kPlusCorner[c][1] ? 1U << l : 0U;
    names.vertex[c] = up | at_k | at_l;
    // Edges run along k, l, k, l.
    const std::uint32_t along = c % 2 == 0 ? k : l;
    const std::uint32_t bits = up | (c % 2 == 0 ? at_l : at_k);
    const std::uint32_t low = bits & ((1U << along) - 1U);
    names.edge[c] = 4 * along + (low | (bits >> (along + 1U)) << along);
  }
  return names;
}

/// By face of a box, then the triangle.
inline constexpr FaceNames kFaceNames[kTriangleFace + 1] = {
    box_face_names(0), box_face_names(1), box_face_names(2),           box_face_names(3),
    box_face_names(4), box_face_names(5), {3, 0, {0, 1, 2}, {0, 1, 2}}};

/// A patch seen along the normal: counter-clockwise in x and y, with its heights h. What looks like
/// a segment or a point from there has become one.
struct Outline {
  double x[kOutlineVertices];
  double y[kOutlineVertices];
  double h[kOutlineVertices];
  std::uint32_t vertex_id[kOutlineVertices];
  /// Of the edge from vertex i to the next.
  std::uint32_t edge_id[kOutlineVertices];
  std::uint32_t face_id;
  std::uint32_t count;
  /// Largest side of its bounds in x and y.
  double size;
  /// With three vertices or more: how fast h grows along x and y, and the cosine between the normal
  /// and that of the polygon.
  double slope[2];
  double cosine;

  /// `up` is 1 for the patch of a, whose highest point is its deepest, and -1 for that of b.
  Outline(const Patch& patch, const PatchFrame& frame, double up) noexcept;
  Outline(const SeenFaces& faces, int side) noexcept;

  /// Height of the polygon's plane.
  [[nodiscard]] double height(double px, double py) const noexcept {
    return h[0] + slope[0] * (px - x[0]) + slope[1] * (py - y[0]);
  }
  [[nodiscard]] std::uint32_t next(std::uint32_t i) const noexcept {
    return i + 1 == count ? 0 : i + 1;
  }
  /// One that turns with the body, of any length, whichever vertex the outline begins with and
  /// whichever way round it goes.
  void find_direction(double (&direction)[2]) const noexcept;

 private:
  void take(const Patch& patch, const PatchFrame& frame, std::uint32_t vertex) noexcept;
  void take_outermost(const Patch& patch, const PatchFrame& frame, double up) noexcept;
  void orient(double up) noexcept;
  void reverse() noexcept;
  void flatten(double up) noexcept;
  [[nodiscard]] std::uint32_t farthest_from(std::uint32_t vertex) const noexcept;
  [[nodiscard]] std::uint32_t least_rise_from(std::uint32_t vertex, double up) const noexcept;
};

/// A place where two patches are, seen along the normal: patch 0 is that of a.
struct PatchMeeting {
  double x;
  double y;
  double height[2];
  std::uint32_t id[2];
};

/// The corners of what two outlines share, in order around it.
struct PatchMeetings {
  PatchMeeting point[2 * kOutlineVertices];
  std::uint32_t count = 0;
  /// Points closer than that are one, and points so little outside of a side are inside.
  double same;
  /// How far the outlines are from each other where they do not meet.
  double apart = 0.0;

  explicit PatchMeetings(double tolerance) noexcept : same(tolerance) {}

  /// Room for one more, to be written in place: copied from elsewhere it would wait for what was
  /// just stored there.
  [[nodiscard]] PatchMeeting& next() noexcept { return point[count]; }
  /// Keeps the next one, unless it is where the first or the last one is.
  void keep_next() noexcept {
    const PatchMeeting& m = point[count];
    for (std::uint32_t i = 0; i<count; i += count> 1 ? count - 1 : 1) {
      if (std::abs(point[i].x - m.x) <= same && std::abs(point[i].y - m.y) <= same) return;
    }
    ++count;
  }
  void add(const PatchMeeting& m) noexcept {
    next() = m;
    keep_next();
  }
};

/// Finds them; where outlines do not meet, as rounding or a caller's normal may have it, the one
/// place where they come closest.
void find_meetings(const Outline& a, const Outline& b, PatchMeetings& out) noexcept;

}  // namespace winnow
