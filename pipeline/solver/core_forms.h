#pragma once

// The kinds of cores in the solver, one struct for each: its support function, projection, features
// (vertices, edges, faces) and supporting feature. Called through with_form by core.cpp and
// manifold.cpp.

#include <winnow/core/volumes.h>
#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/kinds/with_shape.h"
#include "pipeline/manifold/feature_rules.h"
#include "pipeline/manifold/polygon_clip.h"
#include "pipeline/shapes/directions_around.h"
#include "pipeline/solver/core.h"
#include "pipeline/solver/manifold.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace winnow::solver {

/// Returns h with the sign of d; h if d is -0. Without a branch, because directions of searches are
/// unpredictable.
inline double towards(double h, double d) noexcept {
  return std::copysign(h, d + 0.0);
}

struct PointForm {
  static constexpr bool kIsPolytope = true;
  static constexpr bool kTouchesInPoint = true;

  static Vec support(const Core& core, const Vec& /*direction*/) noexcept { return core.center; }
  static AxisRange project(const Core& /*core*/, const Vec& /*n*/) noexcept { return {0.0, 0.0}; }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 1; }
  static Vec vertex(const Core& core, std::uint32_t /*i*/) noexcept { return core.center; }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 0; }
  static Edge edge(const Core& /*core*/, std::uint32_t /*i*/) noexcept { return {0, 1}; }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 0; }
  static Vec direction(const Core& core, std::uint32_t /*i*/) noexcept {
    return core.rotation.col(2);
  }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 0; }
  static Vec normal(const Core& core, std::uint32_t /*i*/) noexcept { return core.rotation.col(2); }
  static std::uint32_t face_count(const Core& /*core*/) noexcept { return 0; }
  static std::uint32_t face_size(const Core& /*core*/, std::uint32_t /*face*/) noexcept {
    return 0;
  }
  static std::uint32_t face_vertex(const Core& /*core*/, std::uint32_t /*face*/,
                                   std::uint32_t i) noexcept {
    return i;
  }
  static std::uint32_t face_edge(const Core& /*core*/, std::uint32_t /*face*/,
                                 std::uint32_t i) noexcept {
    return i;
  }
  static Vec face_normal(const Core& core, std::uint32_t /*face*/) noexcept {
    return core.rotation.col(2);
  }
  static void add_feature(const Core& core, const Vec& /*outward*/,
                          SupportingPatch& patch) noexcept {
    patch.add(core.center, 0, 0);
  }
  static std::uint32_t point_feature(const Core& /*core*/, const Vec& /*at*/) noexcept { return 0; }
  static double inscribe(Core& /*core*/) noexcept { return 0.0; }
};

/// The side of a point in the core's frame along an axis: 1 or -1 at the ends, else 0.
inline int side_of(const Core& core, const Vec& at, int axis) noexcept {
  const double near = core.half[axis] - 1e-9 * core.size;
  return at[axis] >= near ? 1 : (at[axis] <= -near ? -1 : 0);
}

/// A core with vertices, which are relative to `center`.
struct CornersForm : PointForm {
  static constexpr bool kTouchesInPoint = false;

  template <typename Form>
  static void add_face(const Core& core, std::uint32_t face, SupportingPatch& patch) noexcept {
    const std::uint32_t size = Form::face_size(core, face);
    // If the face has too many corners, take every second (third, ...) one.
    const std::uint32_t stride = (size + SupportingPatch::kRoom - 1) / SupportingPatch::kRoom;
    for (std::uint32_t i = 0; i < size; i += stride) {
      const std::uint32_t corner = Form::face_vertex(core, face, i);
      patch.add(Form::vertex(core, corner), corner, Form::face_edge(core, face, i));
    }
    patch.set_feature(face);
  }
  template <typename Form>
  static void add_edge(const Core& core, std::uint32_t number, std::uint32_t feature,
                       SupportingPatch& patch) noexcept {
    for (const std::uint32_t corner : Form::edge(core, number)) {
      patch.add(Form::vertex(core, corner), corner, number);
    }
    patch.set_feature(feature);
  }
};

/// Adds the supporting feature of a core with faces, edges and corners: a face, an edge or a
/// corner, numbered in this order.
template <typename Form>
void add_polytope_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
  const Vec d = core.rotation.transpose() * outward;
  double height = 0.0;
  const std::uint32_t corner = Form::highest_vertex(core, d, height);
  // If the support is an edge, only the two faces that share it count, not the faces at one of its
  // ends.
  const double least = height - kSamePlace * Form::own_radius(core);
  const auto is_on_top = [&](std::uint32_t i) { return Form::own_height(core, i, d) >= least; };
  const std::uint32_t faces = Form::face_count(core);
  const std::uint32_t edges = Form::edge_count(core);
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < Form::vertex_count(core); ++i) most += is_on_top(i);
  most = std::min(most, 2U);
  double best = kFaceCosine;
  std::uint32_t best_face = faces;
  for (std::uint32_t f = 0; f < faces; ++f) {
    const double cosine = Form::face_normal(core, f).dot(outward);
    if (cosine <= kFaceCosine) continue;
    std::uint32_t corners = 0;
    for (std::uint32_t i = 0; i < Form::face_size(core, f); ++i) {
      corners += is_on_top(Form::face_vertex(core, f, i));
    }
    if (corners < most || (corners == most && cosine <= best)) continue;
    most = corners;
    best = cosine;
    best_face = f;
  }
  if (best_face < faces) return CornersForm::add_face<Form>(core, best_face, patch);
  best = kEdgeSine;
  std::uint32_t best_edge = edges;
  for (std::uint32_t e = 0; e < edges; ++e) {
    const Edge ends = Form::edge(core, e);
    if (ends[0] != corner && ends[1] != corner) continue;
    const double sine = std::abs(Form::direction(core, e).dot(outward));
    if (sine >= best) continue;
    best = sine;
    best_edge = e;
  }
  if (best_edge < edges) {
    return CornersForm::add_edge<Form>(core, best_edge, faces + best_edge, patch);
  }
  patch.add(Form::vertex(core, corner), corner, 0);
  patch.set_feature(faces + edges + corner);
}

/// A polytope in a box, by its CornerTable.
struct PolytopeForm : CornersForm {
  /// Relative to the center, in the core's axes.
  static Vec own_vertex(const Core& core, std::uint32_t i) noexcept {
    const std::int8_t* const at = core.corners->corner[i];
    return {at[0] * core.half.x(), at[1] * core.half.y(), at[2] * core.half.z()};
  }
  static double own_height(const Core& core, std::uint32_t i, const Vec& d) noexcept {
    return d.dot(own_vertex(core, i));
  }
  static double own_radius(const Core& core) noexcept { return core.half.norm(); }
  static std::uint32_t highest_vertex(const Core& core, const Vec& d, double& height) noexcept {
    std::uint32_t best = 0;
    height = own_height(core, 0, d);
    for (std::uint32_t i = 1; i < core.corners->corners; ++i) {
      const double own = own_height(core, i, d);
      if (own <= height) continue;
      height = own;
      best = i;
    }
    return best;
  }
  static Vec support(const Core& core, const Vec& direction) noexcept {
    double height = 0.0;
    return vertex(core, highest_vertex(core, core.rotation.transpose() * direction, height));
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    AxisRange range{};
    highest_vertex(core, d, range.high);
    highest_vertex(core, -d, range.low);
    range.low = -range.low;
    return range;
  }
  static std::uint32_t vertex_count(const Core& core) noexcept { return core.corners->corners; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    return core.center + core.rotation * own_vertex(core, i);
  }
  static std::uint32_t edge_count(const Core& core) noexcept { return core.corners->edges; }
  static Edge edge(const Core& core, std::uint32_t i) noexcept {
    return {core.corners->edge[i][0], core.corners->edge[i][1]};
  }
  static std::uint32_t direction_count(const Core& core) noexcept { return edge_count(core); }
  static Vec direction(const Core& core, std::uint32_t i) noexcept {
    const auto [p, q] = edge(core, i);
    return core.rotation * unit(own_vertex(core, q) - own_vertex(core, p));
  }
  static std::uint32_t normal_count(const Core& core) noexcept { return face_count(core); }
  static Vec normal(const Core& core, std::uint32_t i) noexcept { return face_normal(core, i); }
  static std::uint32_t face_count(const Core& core) noexcept { return core.corners->faces; }
  static std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
    return core.corners->face_size[face];
  }
  static std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    return core.corners->face[face][i];
  }
  static std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    const std::uint32_t p = face_vertex(core, face, i);
    const std::uint32_t q = face_vertex(core, face, (i + 1) % face_size(core, face));
    const Edge ends{std::min(p, q), std::max(p, q)};
    std::uint32_t e = 0;
    while (e + 1 < edge_count(core) && edge(core, e) != ends) ++e;
    return e;
  }
  /// Each component of the cube's normal is divided by the half extent along its axis. Multiplied
  /// by the half extents along the other axes of the normal, it needs no division.
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    const std::int8_t* const cube = core.corners->normal[face];
    Vec n(cube[0], cube[1], cube[2]);
    Vec scaled = n;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        if (k != i && cube[k] != 0) scaled[i] *= core.half[k];
      }
    }
    return core.rotation * unit(scaled == Vec::Zero() ? n : scaled);
  }
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    add_polytope_feature<PolytopeForm>(core, outward, patch);
  }
};

struct SegmentForm : PointForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    return core.center + core.rotation * Vec(0.0, 0.0, towards(core.half.z(), d.z()));
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double along = std::abs(d.z()) * core.half.z();
    return {-along, along};
  }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 2; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    return core.center + core.rotation.col(2) * (i == 0 ? -core.half.z() : core.half.z());
  }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 1; }
  static constexpr bool kTouchesInPoint = false;
  static void add_feature(const Core& core, const Vec& /*outward*/,
                          SupportingPatch& patch) noexcept {
    CornersForm::add_edge<SegmentForm>(core, 0, 0, patch);
  }
  static std::uint32_t point_feature(const Core& core, const Vec& at) noexcept {
    const int side = side_of(core, at, 2);
    return side == 0 ? 0 : (side > 0 ? 1 : 2);
  }
};

struct BoxForm : PolytopeForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const Vec& h = core.half;
    const Vec local(towards(h.x(), d.x()), towards(h.y(), d.y()), towards(h.z(), d.z()));
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double reach = d.cwiseAbs().dot(core.half);
    return {-reach, reach};
  }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 3; }
  static Vec direction(const Core& core, std::uint32_t i) noexcept {
    return core.rotation.col(static_cast<Eigen::Index>(i));
  }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 3; }
  static Vec normal(const Core& core, std::uint32_t i) noexcept { return direction(core, i); }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return (face & 1U) != 0 ? Vec(core.rotation.col(face / 2)) : Vec(-core.rotation.col(face / 2));
  }
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    const Vec d = core.rotation.transpose() * outward;
    int axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    add_face<BoxForm>(core, 2 * static_cast<std::uint32_t>(axis) + (d[axis] > 0.0 ? 1U : 0U),
                      patch);
  }
  static std::uint32_t point_feature(const Core& core, const Vec& at) noexcept {
    const auto side = [&](int axis) { return side_of(core, at, axis); };
    return static_cast<std::uint32_t>(13 + side(0) + 3 * side(1) + 9 * side(2));
  }
};

struct TriangleForm : CornersForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const double d0 = core.corner[0].dot(direction);
    const double d1 = core.corner[1].dot(direction);
    const double d2 = core.corner[2].dot(direction);
    return core.center + core.corner[d0 >= d1 && d0 >= d2 ? 0 : (d1 >= d2 ? 1 : 2)];
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const double d0 = core.corner[0].dot(n);
    const double d1 = core.corner[1].dot(n);
    const double d2 = core.corner[2].dot(n);
    return {std::min({d0, d1, d2}), std::max({d0, d1, d2})};
  }
  static std::uint32_t vertex_count(const Core& /*core*/) noexcept { return 3; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    return core.center + core.corner[i];
  }
  static std::uint32_t edge_count(const Core& /*core*/) noexcept { return 3; }
  static Edge edge(const Core& /*core*/, std::uint32_t i) noexcept {
    return {i, i == 2 ? 0U : i + 1};
  }
  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 3; }
  static Vec direction(const Core& core, std::uint32_t i) noexcept { return core.side[i]; }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 1; }
  static Vec normal(const Core& core, std::uint32_t /*i*/) noexcept {
    // Use the longest side, which has the most accurate direction, and the shortest.
    std::array<double, 3> length{};
    for (std::size_t i = 0; i < 3; ++i) {
      length[i] = (core.corner[(i + 1) % 3] - core.corner[i]).squaredNorm();
    }
    const auto longest =
        static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
    const std::size_t next = (longest + 1) % 3;
    const std::size_t last = (longest + 2) % 3;
    const bool next_is_shorter = length[next] < length[last];
    return perpendicular(core.side[longest],
                         next_is_shorter ? core.side[next] : Vec(-core.side[last]));
  }
  static std::uint32_t face_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t face_size(const Core& /*core*/, std::uint32_t /*face*/) noexcept {
    return 3;
  }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return normal(core, face);
  }
  static void add_feature(const Core& core, const Vec& /*outward*/,
                          SupportingPatch& patch) noexcept {
    add_face<TriangleForm>(core, 0, patch);
  }
};

struct HullForm : CornersForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    double value = 0.0;
    const Vec d = core.rotation.transpose() * direction;
    return vertex(core, farthest_vertex(*core.hull, d, value));
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    AxisRange range{};
    farthest_vertex(*core.hull, d, range.high);
    farthest_vertex(*core.hull, -d, range.low);
    range.low = core.scale(-range.low);
    range.high = core.scale(range.high);
    return range;
  }
  static std::uint32_t vertex_count(const Core& core) noexcept { return core.hull->vertex_count; }
  static Vec vertex(const Core& core, std::uint32_t i) noexcept {
    const Vec local(core.hull->vertex[0][i], core.hull->vertex[1][i], core.hull->vertex[2][i]);
    const Vec point = core.rotation * local.unaryExpr(core.scale);
    return core.center + point;
  }
  static std::uint32_t edge_count(const Core& core) noexcept { return core.hull->edge_count; }
  static Edge edge(const Core& core, std::uint32_t i) noexcept {
    return {core.hull->edges[i].vertex[0], core.hull->edges[i].vertex[1]};
  }
  static std::uint32_t direction_count(const Core& core) noexcept { return edge_count(core); }
  static Vec direction(const Core& core, std::uint32_t i) noexcept {
    const HullShape& hull = *core.hull;
    const auto [p, q] = edge(core, i);
    const Vec local(hull.vertex[0][q] - hull.vertex[0][p], hull.vertex[1][q] - hull.vertex[1][p],
                    hull.vertex[2][q] - hull.vertex[2][p]);
    return core.rotation * unit(local);
  }
  static std::uint32_t normal_count(const Core& core) noexcept { return core.hull->face_count; }
  static Vec normal(const Core& core, std::uint32_t i) noexcept { return face_normal(core, i); }
  static std::uint32_t face_count(const Core& core) noexcept { return core.hull->face_count; }
  static std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
    return core.hull->faces[face].count;
  }
  static std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    return core.hull->loop[core.hull->faces[face].first + i];
  }
  static std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
    return core.hull->loop_edge[core.hull->faces[face].first + i];
  }
  static Vec face_normal(const Core& core, std::uint32_t face) noexcept {
    return core.rotation * as_eigen(core.hull->faces[face].normal);
  }
  // In the hull's frame and units.
  static std::uint32_t highest_vertex(const Core& core, const Vec& d, double& height) noexcept {
    return farthest_vertex(*core.hull, d, height);
  }
  static double own_height(const Core& core, std::uint32_t i, const Vec& d) noexcept {
    const double* const* v = core.hull->vertex;
    return d.dot(Vec(v[0][i], v[1][i], v[2][i]));
  }
  static double own_radius(const Core& core) noexcept { return core.hull->radius; }
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    add_polytope_feature<HullForm>(core, outward, patch);
  }
};

inline Vec rim(const Core& core, const Vec& local, double z) noexcept {
  const double length = hypotenuse(local.x(), local.y());
  if (length == 0.0) return {0.0, 0.0, z};
  // Divide by the length first: for very short directions, radius / length may overflow.
  return {core.half.x() * (local.x() / length), core.half.x() * (local.y() / length), z};
}

inline double radial(const Core& core, const Vec& local) noexcept {
  return core.half.x() * hypotenuse(local.x(), local.y());
}

/// A cylinder or cone: its direction and its normal are its axis.
struct CappedForm : PointForm {
  static constexpr bool kIsPolytope = false;
  static constexpr bool kTouchesInPoint = false;

  static std::uint32_t direction_count(const Core& /*core*/) noexcept { return 1; }
  static std::uint32_t normal_count(const Core& /*core*/) noexcept { return 1; }
  static void add_cap(const Core& core, double z, SupportingPatch& patch) noexcept {
    const std::uint32_t first = z > 0.0 ? 0 : kRimCorners;
    static_assert(kRimCorners == std::size(kSixteenthsOfTurn));
    for (std::uint32_t i = 0; i < kRimCorners; ++i) {
      const auto [c, s] = kSixteenthsOfTurn[i];
      const Vec at(core.half.x() * c, core.half.x() * s, z);
      patch.add(core.center + core.rotation * at, first + i, first + i);
    }
    patch.set_feature(first);
  }

  /// A cap, or a line of the side. A cone has only the lower cap.
  static void add_side(const Core& core, const Vec& outward, bool is_cone,
                       SupportingPatch& patch) noexcept {
    const Vec d = core.rotation.transpose() * outward;
    const double r = core.half.x();
    const double h = core.half.z();
    const double radial = hypotenuse(d.x(), d.y());
    // A direction along the axis has no radial part: use +x.
    const Vec out = radial > kAlongAxis ? Vec(d.x() / radial, d.y() / radial, 0.0) : Vec::UnitX();
    const bool on_tip = is_cone && h * d.z() >= r * radial - h * d.z();
    const double over_cap = is_cone ? -d.z() : std::abs(d.z());
    if (over_cap > kCapCosine) return add_cap(core, d.z() > 0.0 ? h : -h, patch);
    const Vec top = is_cone ? Vec(0.0, 0.0, h) : Vec(out * r + Vec(0.0, 0.0, h));
    patch.add(core.center + core.rotation * top, kSideLine, kSideLine);
    patch.set_feature(kSideLine);
    if (on_tip && radial <= kAlongAxis) return;
    patch.add(core.center + core.rotation * (out * r - Vec(0.0, 0.0, h)), kSideLine + 1, kSideLine);
  }
};

struct CylinderForm : CappedForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const double z = towards(core.half.z(), d.z());
    return core.center + core.rotation * rim(core, d, z);
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double reach = radial(core, d) + std::abs(d.z()) * core.half.z();
    return {-reach, reach};
  }
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    add_side(core, outward, false, patch);
  }
  /// The largest rounding that fits.
  static double inscribe(Core& core) noexcept {
    const double rounding = std::min(core.half.x(), core.half.z());
    core.half -= Vec::Constant(rounding);
    if (!(core.half.x() > 0.0)) core.kind = ShapeKind::capsule;
    return rounding;
  }
};

struct ConeForm : CappedForm {
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const double h = core.half.z();
    const bool on_tip = h * d.z() >= radial(core, d) - h * d.z();
    const Vec local = on_tip ? Vec(0.0, 0.0, h) : rim(core, d, -h);
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const double tip = core.half.z() * d.z();
    const double side = radial(core, d);
    return {std::min(tip, -side - tip), std::max(tip, side - tip)};
  }
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    add_side(core, outward, true, patch);
  }
};

struct SupportForm : PointForm {
  static constexpr bool kIsPolytope = false;
  static constexpr bool kTouchesInPoint = false;

  /// Relative to the center, in the core's axes; `d` is unit.
  static Vec farthest_point(const Core& core, const Vec& d) noexcept {
    return core.farthest.farthest(d).unaryExpr(core.scale);
  }
  static Vec support(const Core& core, const Vec& direction) noexcept {
    const Vec d = core.rotation.transpose() * direction;
    const Vec local = farthest_point(core, unit(d));
    return core.center + core.rotation * local;
  }
  static AxisRange project(const Core& core, const Vec& n) noexcept {
    const Vec d = core.rotation.transpose() * n;
    const Vec u = unit(d);
    return {d.dot(farthest_point(core, -u)), d.dot(farthest_point(core, u))};
  }
  /// Keeps the points that are in the plane of point 0, the point farthest from it, and the point
  /// with which these two span the largest triangle. Returns their number.
  static std::uint32_t keep_coplanar(Vec* x, std::uint32_t count) noexcept {
    if (count < 4) return count;
    const Vec far = *std::max_element(x + 1, x + count, [&](const Vec& p, const Vec& q) {
      return (p - x[0]).norm() < (q - x[0]).norm();
    });
    Vec normal = Vec::Zero();
    for (std::uint32_t i = 1; i < count; ++i) {
      const Vec n = (far - x[0]).cross(x[i] - x[0]);
      if (n.squaredNorm() > normal.squaredNorm()) normal = n;
    }
    const double level = kSampleLevel * (far - x[0]).norm() * normal.norm();
    const double base = normal.dot(x[0]);
    const Vec* const kept = std::remove_if(
        x, x + count, [&](const Vec& p) { return std::abs(normal.dot(p) - base) > level; });
    return static_cast<std::uint32_t>(kept - x);
  }

  // Uses directions that are slightly off, because bodies rock. The corners of a flat face stay far
  // apart; the points of a round surface are close together, and the farthest of them is kept.
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    constexpr std::uint32_t kSamples = 8;
    const Vec d = core.rotation.transpose() * outward;
    int axis = 0;
    while (axis < 2 && !(std::abs(d[axis]) <= kAxisCosine)) ++axis;
    const Vec side = without(core.rotation.col(axis), outward);
    const Vec u = side * kOffAxes[0] + outward.cross(side) * kOffAxes[1];
    const Vec v = outward.cross(u);
    const AxisRange width[2] = {SupportForm::project(core, u), SupportForm::project(core, v)};
    const double apart =
        1.5 * kSampleTilt * std::max(width[0].high - width[0].low, width[1].high - width[1].low);
    Vec kept[kSamples];
    std::uint32_t count = 0;
    const auto take = [&](const Vec& x) {
      for (std::uint32_t i = 0; i < count; ++i) {
        if (!((x - kept[i]).norm() <= apart)) continue;
        if (outward.dot(x - kept[i]) > 0.0) kept[i] = x;
        return;
      }
      kept[count++] = x;
    };
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const auto [c, s] = kSixteenthsOfTurn[2 * i];
      take(SupportForm::support(core, outward + (u * c + v * s) * kSampleTilt));
    }
    if (count == 1) kept[0] = SupportForm::support(core, outward);
    count = keep_coplanar(kept, count);
    for (std::uint32_t i = 0; i < count; ++i) patch.add(kept[i], i, i);
  }
};

struct EllipsoidForm : SupportForm {
  static constexpr bool kTouchesInPoint = true;
};

/// Its feature is the line between the balls.
struct TaperForm : SupportForm {
  static void add_feature(const Core& core, const Vec& outward, SupportingPatch& patch) noexcept {
    const auto& taper = *static_cast<const TaperedCapsuleShape*>(core.farthest.shape);
    const double half = core.scale(taper.half_length);
    const double more = core.scale(std::max(taper.radius[0] - taper.radius[1], 0.0));
    const double less = core.scale(std::max(taper.radius[1] - taper.radius[0], 0.0));
    const Vec axis = core.rotation.col(2) * half;
    // A ball inside the other one is not part of the surface.
    if (more == 0.0 || more < 2.0 * half) patch.add(core.center + axis + outward * less, 0, 0);
    if (more > 0.0 || less < 2.0 * half) patch.add(core.center - axis + outward * more, 1, 0);
  }
};

/// Not bounded: it has no support points and no range.
struct HalfSpaceForm : PointForm {
  static constexpr bool kIsPolytope = false;
  static constexpr bool kTouchesInPoint = false;
};

/// The form of a shape's core. A kind with a CornerTable needs no form of its own.
template <typename Shape>
struct FormOf : PolytopeForm {};
template <>
struct FormOf<SphereShape> : PointForm {};
template <>
struct FormOf<CapsuleShape> : SegmentForm {};
template <>
struct FormOf<BoxShape> : BoxForm {};
template <>
struct FormOf<TriangleShape> : TriangleForm {};
template <>
struct FormOf<HullShape> : HullForm {};
template <>
struct FormOf<CylinderShape> : CylinderForm {};
template <>
struct FormOf<ConeShape> : ConeForm {};
template <>
struct FormOf<EllipsoidShape> : EllipsoidForm {};
template <>
struct FormOf<TaperedCapsuleShape> : TaperForm {};
template <>
struct FormOf<SupportShape> : SupportForm {};
template <>
struct FormOf<HalfSpaceShape> : HalfSpaceForm {};

/// Calls visit(form) with the form of a core, and returns its result.
template <typename Visit>
decltype(auto) with_form(const Core& core, Visit&& visit) {
  return with_kind(core.kind, [&](auto of) -> decltype(auto) {
    return visit(FormOf<typename decltype(of)::Shape>{});
  });
}

}  // namespace winnow::solver
