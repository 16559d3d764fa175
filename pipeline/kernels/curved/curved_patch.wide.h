#pragma once

// Contacts of one pair with curved shapes: the supporting features of both cores along a normal, as
// patches for contact_patch. Features are numbered as in solver/manifold.cpp.

#include "pipeline/kernels/cores/farthest_points.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// Cosines of the angles of a rim's corners. The sine is the cosine a quarter turn earlier.
inline constexpr double kRimCosine[kRimCorners] = {
    1.0,  0.92387953251128674,  0.70710678118654757,  0.38268343236508978,
    0.0,  -0.38268343236508978, -0.70710678118654757, -0.92387953251128674,
    -1.0, -0.92387953251128674, -0.70710678118654757, -0.38268343236508978,
    0.0,  0.38268343236508978,  0.70710678118654757,  0.92387953251128674};
/// Corners of the faces of a box, counter-clockwise seen from outside. Bit i of a corner's number
/// is set on the positive side of axis i. Face 2 i + 1 is the positive face of axis i.
inline constexpr std::uint32_t kBoxFace[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

/// Returns the edge between two corners of a box. Edges 4 i to 4 i + 3 are parallel to axis i.
constexpr std::uint32_t box_edge_between(std::uint32_t p, std::uint32_t q) {
  const std::uint32_t along = p ^ q;
  const std::uint32_t low = p & q;
  if (along == 1) return low >> 1U;
  if (along == 2) return 4 + (low & 1U) + (low >> 2U << 1U);
  return 8 + low;
}

/// The supporting feature of one core, in world axes, relative to body a.
class CurvedPatch {
 public:
  /// `normal` is in the frame of the first and points from the first to the second. `at` is the
  /// point of the core that is closest to the other core, or deepest in it, in the frame of the
  /// core.
  CurvedPatch(const CurvedPair& pair, bool of_first, const double* normal, const double* at)
      : pair_(pair), form_(of_first ? pair.first : pair.second), of_first_(of_first) {
    double d[3];
    if (of_first) {
      for (int k = 0; k < 3; ++k) d[k] = normal[k];
    } else {
      turn_back3(pair.turn, normal, d);
      for (double& x : d) x = -x;
    }
    switch (form_.kind) {
      case ShapeKind::capsule:
        add({0.0, 0.0, -form_.number[2]}, 0, 0);
        if (form_.number[2] > 0.0) add({0.0, 0.0, form_.number[2]}, 1, 0);
        break;
      case ShapeKind::box:
        add_box(d);
        break;
      case ShapeKind::triangle:
        for (std::uint32_t i = 0; i < 3; ++i) {
          const double* v = form_.number + 3 * i;
          add({v[0], v[1], v[2]}, i, i);
        }
        break;
      case ShapeKind::hull:
        add_hull(d, at);
        break;
      case ShapeKind::support:
        add_samples(d);
        break;
      case ShapeKind::tapered_capsule:
        add_taper(d);
        break;
      default:
        add_round(d);
        break;
    }
  }

  [[nodiscard]] SupportingFeature view() const {
    return {vertex_, vertex_feature_, edge_feature_, count_, feature_, form_.rounding * pair_.unit};
  }

 private:
  static constexpr std::uint32_t kRoom = kPatchRoom;

  struct Local {
    double x;
    double y;
    double z;
  };

  void add(const Local& at, std::uint32_t vertex_feature, std::uint32_t edge_feature) {
    const double local[3] = {at.x * pair_.unit, at.y * pair_.unit, at.z * pair_.unit};
    double* r = vertex_[count_];
    double x[3] = {local[0], local[1], local[2]};
    if (!of_first_) {
      turn3(pair_.turn, local, x);
      for (int k = 0; k < 3; ++k) x[k] += pair_.shift[k] * pair_.unit;
    }
    turn3(pair_.frame, x, r);
    if (pair_.swapped) {
      for (int k = 0; k < 3; ++k) r[k] -= pair_.offset[k];
    }
    vertex_feature_[count_] = vertex_feature;
    edge_feature_[count_++] = edge_feature;
  }

  void add_box(const double* d) {
    std::uint32_t axis = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
      if (__builtin_fabs(d[k]) > __builtin_fabs(d[axis])) axis = k;
    }
    feature_ = 2 * axis + (d[axis] > 0.0 ? 1U : 0U);
    const double* h = form_.number;
    for (int i = 0; i < 4; ++i) {
      const std::uint32_t corner = kBoxFace[feature_][i];
      const std::uint32_t next = kBoxFace[feature_][(i + 1) % 4];
      add({(corner & 1U) != 0 ? h[0] : -h[0], (corner & 2U) != 0 ? h[1] : -h[1],
           (corner & 4U) != 0 ? h[2] : -h[2]},
          corner, box_edge_between(corner, next));
    }
  }

  void add_vertex(std::uint32_t vertex, std::uint32_t edge_feature) {
    const double* const* v = form_.hull->vertex;
    add({v[0][vertex] * pair_.scale, v[1][vertex] * pair_.scale, v[2][vertex] * pair_.scale},
        vertex, edge_feature);
  }

  /// Only faces that contain the point `at` can be the feature: if `at` is on an edge, these are
  /// the two faces beside the edge, not the other faces at its ends.
  void add_hull(const double* d, const double* at) {
    const HullShape& shape = *form_.hull;
    const float direction[3] = {static_cast<float>(d[0]), static_cast<float>(d[1]),
                                static_cast<float>(d[2])};
    const float touched[3] = {static_cast<float>(at[0] * pair_.unit),
                              static_cast<float>(at[1] * pair_.unit),
                              static_cast<float>(at[2] * pair_.unit)};
    const float doubt = hull::kFloatError * static_cast<float>(pair_.size * pair_.unit);
    const std::uint32_t face = hull::face_across(shape, d, touched, doubt);
    if (face != hull::kNoFeature) {
      const HullFace& f = shape.faces[face];
      // If the polygon has too many corners, take every second (third, ...) one.
      const std::uint32_t stride = (f.count + kRoom - 1) / kRoom;
      for (std::uint32_t i = 0; i < f.count; i += stride) {
        add_vertex(shape.loop[f.first + i], shape.loop_edge[f.first + i]);
      }
      feature_ = face;
      return;
    }
    const std::uint32_t vertex = hull::farthest_vertex(shape, direction);
    float x[3];
    hull::vertex_at(shape, vertex, x);
    const std::uint32_t other = hull::neighbour_across(shape, direction, vertex, x);
    if (other == hull::kNoFeature) {
      add_vertex(vertex, 0);
      feature_ = shape.face_count + shape.edge_count + vertex;
      return;
    }
    const std::uint32_t low = vertex < other ? vertex : other;
    const std::uint32_t high = vertex < other ? other : vertex;
    std::uint32_t edge = 0;
    const auto joins = [&](const HullEdge& e) {
      return (e.vertex[0] == low && e.vertex[1] == high) ||
             (e.vertex[0] == high && e.vertex[1] == low);
    };
    while (edge + 1 < shape.edge_count && !joins(shape.edges[edge])) ++edge;
    add_vertex(low, edge);
    add_vertex(high, edge);
    feature_ = shape.face_count + edge;
  }

  void add_cap(double z) {
    feature_ = z > 0.0 ? 0 : kRimCorners;
    const double r = form_.number[0];
    for (std::uint32_t i = 0; i < kRimCorners; ++i) {
      const double c = kRimCosine[i];
      const double s = kRimCosine[(i + 3 * kRimCorners / 4) % kRimCorners];
      add({r * c, r * s, z}, feature_ + i, feature_ + i);
    }
  }

  void add_round(const double* d) {
    const double r = form_.number[0];
    const double h = form_.number[2];
    const bool cone = form_.kind == ShapeKind::cone;
    const double across = __builtin_sqrt(d[0] * d[0] + d[1] * d[1]);
    const bool has_side = across > kAlongAxis;
    const double out[2] = {has_side ? d[0] / across : 1.0, has_side ? d[1] / across : 0.0};
    const bool on_tip = cone && h * d[2] >= r * across - h * d[2];
    // A cone has only the lower cap.
    const double over_cap = cone ? -d[2] : __builtin_fabs(d[2]);
    if (over_cap > kCapCosine && r > 0.0) return add_cap(d[2] > 0.0 ? h : -h);
    const double top = cone ? 0.0 : r;
    add({out[0] * top, out[1] * top, h}, kSideLine, kSideLine);
    feature_ = kSideLine;
    if (on_tip && !has_side) return;
    add({out[0] * r, out[1] * r, -h}, kSideLine + 1, kSideLine);
  }

  /// The line between the balls. A ball inside the other one is not part of it.
  void add_taper(const double* d) {
    const double more = form_.number[0];
    const double ball = form_.number[1];
    const double tip = form_.number[2];
    add({more * d[0], more * d[1], ball + more * d[2]}, ball < 0.0 ? 1 : 0, 0);
    if (tip != ball) add({0.0, 0.0, tip}, tip < 0.0 ? 1 : 0, 0);
  }

  /// Uses directions that are slightly off, because bodies rock. The corners of a flat face stay
  /// far apart; the points of a round surface are close together, and the farthest of them is kept.
  void add_samples(const double* d) {
    constexpr std::uint32_t kSamples = 8;
    double across[2][3];
    directions_across(d, across);
    const double apart = sample_tolerance(*form_.own, across, pair_.scale);
    double kept[kSamples][3];
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const double c = kSampleTilt * kRimCosine[2 * i];
      const double s = kSampleTilt * kRimCosine[(2 * i + 3 * kRimCorners / 4) % kRimCorners];
      double tilted[3];
      for (int k = 0; k < 3; ++k) tilted[k] = d[k] + across[0][k] * c + across[1][k] * s;
      double x[3];
      farthest(form_, tilted, pair_.scale, x);
      std::uint32_t at = 0;
      while (at < count && !(distance_of(x, kept[at]) <= apart)) ++at;
      if (at < count && !(dot3(d, x) > dot3(d, kept[at]))) continue;
      for (int k = 0; k < 3; ++k) kept[at][k] = x[k];
      count = at < count ? count : count + 1;
    }
    if (count == 1) farthest(form_, d, pair_.scale, kept[0]);
    count = keep_coplanar(kept, count);
    for (std::uint32_t i = 0; i < count; ++i) add({kept[i][0], kept[i][1], kept[i][2]}, i, i);
  }

  /// Keeps the points that are in the plane of point 0, the point farthest from it, and the point
  /// with which these two span the largest triangle. Returns their number.
  static std::uint32_t keep_coplanar(double (*x)[3], std::uint32_t count) {
    if (count < 4) return count;
    std::uint32_t far = 1;
    for (std::uint32_t i = 2; i < count; ++i) {
      if (distance_of(x[i], x[0]) > distance_of(x[far], x[0])) far = i;
    }
    double normal[3] = {};
    for (std::uint32_t i = 1; i < count; ++i) {
      double e[3];
      double f[3];
      double n[3];
      for (int k = 0; k < 3; ++k) {
        e[k] = x[far][k] - x[0][k];
        f[k] = x[i][k] - x[0][k];
      }
      cross3(e, f, n);
      if (!(dot3(n, n) > dot3(normal, normal))) continue;
      for (int k = 0; k < 3; ++k) normal[k] = n[k];
    }
    const double level =
        kSampleLevel * distance_of(x[far], x[0]) * __builtin_sqrt(dot3(normal, normal));
    const double base = dot3(normal, x[0]);
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (__builtin_fabs(dot3(normal, x[i]) - base) > level) continue;
      for (int k = 0; k < 3; ++k) x[kept][k] = x[i][k];
      ++kept;
    }
    return kept;
  }

  static double distance_of(const double* x, const double* y) {
    const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    return __builtin_sqrt(dot3(d, d));
  }

  const CurvedPair& pair_;
  const CoreDesc& form_;
  bool of_first_;
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double vertex_[kRoom][3];
  std::uint32_t vertex_feature_[kRoom];
  std::uint32_t edge_feature_[kRoom];
};

/// Feature number of a single contact point, at a point of the core in its frame; as in the kernels
/// of round shapes.
static inline std::uint32_t point_feature(const CoreDesc& form, const double* at, double size) {
  const auto side = [&](int k) {
    const double near = form.number[k] - 1e-9 * size;
    return at[k] >= near ? 1 : (at[k] <= -near ? -1 : 0);
  };
  if (form.kind == ShapeKind::capsule) return side(2) == 0 ? 0 : (side(2) > 0 ? 1 : 2);
  if (form.kind != ShapeKind::box) return 0;
  return static_cast<std::uint32_t>(13 + side(0) + 3 * side(1) + 9 * side(2));
}

static inline bool touches_in_a_point(const CoreDesc& form) {
  return form.kind == ShapeKind::sphere || form.kind == ShapeKind::ellipsoid;
}

/// Writes the contact points of a pair within the margin, and returns their number. `normal` is in
/// the frame of the first. `world`, from body a to body b, and `point`, on the surface of a and
/// relative to it, are in world axes. `core` is the point on the core of the first, `apart` the
/// distance of the cores, both scaled. The closest point of the pair replaces the deepest point of
/// the features if the depths of the two differ by more than rounding errors and tied_depth (as for
/// rims, whose features are polygons), if the features are farther apart than the margin, or if
/// they have only one contact. If the depths differ by more than 1e-2 of the size, the closest
/// point is inserted before the points of the features instead. No point becomes deeper than the
/// closest point, and the first point has its depth.
static inline std::uint32_t curved_contacts(const CurvedPair& pair, const double* normal,
                                            const double* world, const double* point,
                                            const double* core, double apart, double distance,
                                            double margin, ContactPoint (&out)[kManifoldPoints]) {
  double theirs[3];
  double local[3];
  for (int k = 0; k < 3; ++k) theirs[k] = core[k] + apart * normal[k] - pair.shift[k];
  turn_back3(pair.turn, theirs, local);
  std::uint32_t count = 0;
  if (!touches_in_a_point(pair.first) && !touches_in_a_point(pair.second)) {
    const CurvedPatch first(pair, true, normal, core);
    const CurvedPatch second(pair, false, normal, local);
    count = contact_patch(pair.swapped ? second.view() : first.view(),
                          pair.swapped ? first.view() : second.view(), world, margin, out);
  }
  ContactPoint own{};
  for (int k = 0; k < 3; ++k) {
    own.position[k] = static_cast<float>(point[k] + 0.5 * distance * world[k]);
  }
  own.depth = static_cast<float>(-distance);
  const std::uint64_t mine = point_feature(pair.first, core, pair.size);
  const std::uint64_t other = point_feature(pair.second, local, pair.size);
  own.feature = pair.swapped ? other << 32U | mine : mine << 32U | other;
  const double size = pair.size * pair.unit;
  const double miss =
      __builtin_fabs(static_cast<double>(out[0].depth) - static_cast<double>(own.depth));
  const bool near = count > 0 && static_cast<double>(out[0].depth) >= -margin;
  if (near && count > 1 && miss > 1e-2 * size) {
    count = count < kManifoldPoints ? count + 1 : count;
    for (std::uint32_t i = count - 1; i > 0; --i) out[i] = out[i - 1];
    out[0] = own;
  } else if (!near || count == 1 || (miss > 4e-7 * size && miss > tied_depth(out, count))) {
    if (near) own.feature = out[0].feature;
    out[0] = own;
    count = count == 0 ? 1 : count;
  }
  out[0].depth = own.depth;
  for (std::uint32_t i = 1; i < count; ++i) {
    out[i].depth = out[i].depth < own.depth ? out[i].depth : own.depth;
  }
  return count;
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
