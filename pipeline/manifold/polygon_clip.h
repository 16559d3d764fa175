#pragma once

// Projections of patches along the contact normal (Outline), and the corners of the intersection of
// two of them (intersect_patches). Used by contact_patch.cpp.

#include "pipeline/manifold/contact_patch.h"

#include <cmath>
#include <cstdint>

namespace winnow {

inline constexpr std::uint32_t kOutlineVertices = 16;

/// Points that are closer than this share of the patches' size count as one.
inline constexpr double kSamePlace = 1e-9;

[[nodiscard]] inline double dot(const double a[3], const double b[3]) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Axes of which the third is the contact normal.
struct PatchFrame {
  double axis[3][3];

  /// `normal` is a unit vector.
  explicit PatchFrame(const double normal[3]) noexcept;
  explicit PatchFrame(const ProjectedFaces& faces) noexcept;
};

[[nodiscard]] constexpr std::uint32_t feature_id(FeatureKind kind, std::uint32_t number) noexcept {
  return static_cast<std::uint32_t>(kind) << kFeatureKindShift | (number & 0x3FFFFFFFU);
}

/// Feature numbers of a face of a box or of a triangle, and of its vertices and edges.
struct FaceNames {
  std::uint32_t count;
  std::uint32_t face;
  std::uint32_t vertex[4];
  std::uint32_t edge[4];
};

/// The corners of face 2 i + up of a box are at (-, -), (+, -), (+, +), (-, +) on the two axes that
/// follow axis i.
inline constexpr bool kPlusCorner[4][2] = {
    {false, false}, {true, false}, {true, true}, {false, true}};

/// Vertices are numbered by the bits x > 0, y > 0, z > 0; edges by 4 x their axis plus the bits of
/// the other axes.
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

/// Indexed by the face of a box; the last entry is the triangle.
inline constexpr FaceNames kFaceNames[kTriangleFace + 1] = {
    box_face_names(0), box_face_names(1), box_face_names(2),           box_face_names(3),
    box_face_names(4), box_face_names(5), {3, 0, {0, 1, 2}, {0, 1, 2}}};

/// A patch projected along the normal: counter-clockwise in x and y, with heights h along the
/// normal. A patch whose projection is nearly a segment or a point is reduced to that.
struct Outline {
  double x[kOutlineVertices];
  double y[kOutlineVertices];
  double h[kOutlineVertices];
  std::uint32_t vertex_id[kOutlineVertices];
  /// Id of the edge from vertex i to the next.
  std::uint32_t edge_id[kOutlineVertices];
  std::uint32_t face_id;
  std::uint32_t count;
  /// Longer side of the bounding rectangle in x and y.
  double size;
  /// For three or more vertices: the gradient of h along x and y, and the cosine between the
  /// contact normal and the normal of the polygon.
  double slope[2];
  double cosine;

  /// `up` is 1 for the patch of a, whose highest point is the deepest, and -1 for the patch of b.
  Outline(const SupportingFeature& patch, const PatchFrame& frame, double up) noexcept;
  Outline(const ProjectedFaces& faces, int side) noexcept;

  /// Height of the polygon's plane at a point.
  [[nodiscard]] double height(double px, double py) const noexcept {
    return h[0] + slope[0] * (px - x[0]) + slope[1] * (py - y[0]);
  }
  [[nodiscard]] std::uint32_t next(std::uint32_t i) const noexcept {
    return i + 1 == count ? 0 : i + 1;
  }
  /// Finds a direction that is fixed in the body, of any length. It does not depend on the first
  /// vertex or on the winding.
  void find_direction(double (&direction)[2]) const noexcept;

 private:
  void take(const SupportingFeature& patch, const PatchFrame& frame, std::uint32_t vertex) noexcept;
  void take_outermost(const SupportingFeature& patch, const PatchFrame& frame, double up) noexcept;
  void orient(double up) noexcept;
  void reverse() noexcept;
  void flatten(double up) noexcept;
  [[nodiscard]] std::uint32_t farthest_from(std::uint32_t vertex) const noexcept;
  [[nodiscard]] std::uint32_t least_rise_from(std::uint32_t vertex, double up) const noexcept;
};

/// A corner of the intersection of two projected patches. Index 0 belongs to a, index 1 to b.
struct ClipPoint {
  double x;
  double y;
  double height[2];
  std::uint32_t id[2];
};

/// The corners of the intersection of two outlines, in order around it.
struct ClipPoints {
  ClipPoint point[2 * kOutlineVertices];
  std::uint32_t count = 0;
  /// Tolerance, a length: points are merged if neither x nor y differs by more, and a point that is
  /// outside of a side by at most this counts as inside.
  double same;
  /// Distance of the outlines if they do not overlap.
  double apart = 0.0;

  explicit ClipPoints(double tolerance) noexcept : same(tolerance) {}

  /// Returns the next corner, to be written in place: copying a struct that was just stored would
  /// stall on store forwarding.
  [[nodiscard]] ClipPoint& next() noexcept { return point[count]; }
  /// Keeps the next corner, unless it coincides with the first or the last one.
  void keep_next() noexcept {
    const ClipPoint& m = point[count];
    const auto is_at = [&](std::uint32_t i) {
      return std::abs(point[i].x - m.x) <= same && std::abs(point[i].y - m.y) <= same;
    };
    if (count > 0 && (is_at(0) || is_at(count - 1))) return;
    ++count;
  }
  void add(const ClipPoint& m) noexcept {
    next() = m;
    keep_next();
  }
};

/// Finds the corners. If the outlines do not overlap, because of rounding or because of the
/// caller's normal, finds the one point where they are closest.
void intersect_patches(const Outline& a, const Outline& b, ClipPoints& out) noexcept;

}  // namespace winnow
