// Supporting features of cores, and contact manifolds of single pairs; see manifold.h. Called by
// the solver and by composites/internal_edges.cpp and manifold_reduction.cpp.

#include "pipeline/solver/manifold.h"

#include <winnow/core/rounding.h>
#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/polygon_clip.h"
#include "pipeline/shapes/directions_around.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace winnow::solver {
namespace {

bool is_on_top(const HullShape& hull, std::uint32_t i, const Vec& d, double least) noexcept {
  return d.dot(Vec(hull.vertex[0][i], hull.vertex[1][i], hull.vertex[2][i])) >= least;
}

/// Number of vertices of a hull, or of a face of it, at height `least` or more along d.
std::uint32_t count_on_top(const HullShape& hull, const Vec& d, double least) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < hull.vertex_count; ++i) count += is_on_top(hull, i, d, least);
  return count;
}
std::uint32_t count_on_top(const HullShape& hull, const HullFace& face, const Vec& d,
                           double least) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < face.count; ++i) {
    count += is_on_top(hull, hull.loop[face.first + i], d, least);
  }
  return count;
}

}  // namespace

SupportingPatch::SupportingPatch(const Core& core, const Vec& outward) noexcept {
  rounding_ = core.rounding;
  switch (core.kind) {
    case CoreKind::box: {
      const Vec d = core.rotation.transpose() * outward;
      int axis = 0;
      d.cwiseAbs().maxCoeff(&axis);
      add_face(core, 2 * static_cast<std::uint32_t>(axis) + (d[axis] > 0.0 ? 1U : 0U));
      break;
    }
    case CoreKind::triangle:
      add_face(core, 0);
      break;
    case CoreKind::segment:
      add_edge(core, 0, 0);
      break;
    case CoreKind::hull:
      add_hull(core, outward);
      break;
    case CoreKind::cylinder:
    case CoreKind::cone:
      add_round(core, outward);
      break;
    case CoreKind::support:
      core.farthest.kind == ShapeKind::tapered_capsule ? add_taper(core, outward)
                                                       : add_samples(core, outward);
      break;
    default:
      add(core.center, 0, 0);
      break;
  }
}

SupportingPatch SupportingPatch::of_half_space(const Core& core, const Vec& middle,
                                               double reach) noexcept {
  SupportingPatch patch;
  const Vec& n = core.normal;
  int least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vec u = without(Vec::Unit(least), n);
  const Vec v = n.cross(u);
  const Vec foot = middle - n * (n.dot(middle - core.center) - core.offset);
  patch.add(foot - (u + v) * reach, 0, 0);
  patch.add(foot + (u - v) * reach, 1, 1);
  patch.add(foot + (u + v) * reach, 2, 2);
  patch.add(foot - (u - v) * reach, 3, 3);
  return patch;
}

void SupportingPatch::add(const Vec& v, std::uint32_t vertex_feature,
                          std::uint32_t edge_feature) noexcept {
  Vec::Map(vertex_[count_]) = v;
  vertex_feature_[count_] = vertex_feature;
  edge_feature_[count_] = edge_feature;
  ++count_;
}

void SupportingPatch::add_face(const Core& core, std::uint32_t face) noexcept {
  const std::uint32_t size = face_size(core, face);
  // If the face has too many corners, take every second (third, ...) one.
  const std::uint32_t stride = (size + kRoom - 1) / kRoom;
  for (std::uint32_t i = 0; i < size; i += stride) {
    const std::uint32_t corner = face_vertex(core, face, i);
    add(vertex(core, corner), corner, face_edge(core, face, i));
  }
  feature_ = face;
}

void SupportingPatch::add_edge(const Core& core, std::uint32_t number,
                               std::uint32_t feature) noexcept {
  for (const std::uint32_t corner : edge(core, number)) add(vertex(core, corner), corner, number);
  feature_ = feature;
}

void SupportingPatch::add_hull(const Core& core, const Vec& outward) noexcept {
  const HullShape& hull = *core.hull;
  const Vec d = core.rotation.transpose() * outward;
  double height = 0.0;
  const std::uint32_t corner = farthest_vertex(hull, d, height);
  // If the support is an edge, only the two faces that share it count, not the faces at one of its
  // ends.
  const double least = height - kSamePlace * hull.radius;
  double best = kFaceCosine;
  std::uint32_t most = std::min(count_on_top(hull, d, least), 2U);
  std::uint32_t best_face = hull.face_count;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) {
    const double cosine = face_normal(core, f).dot(outward);
    if (cosine <= kFaceCosine) continue;
    const std::uint32_t corners = count_on_top(hull, hull.faces[f], d, least);
    if (corners < most || (corners == most && cosine <= best)) continue;
    most = corners;
    best = cosine;
    best_face = f;
  }
  if (best_face < hull.face_count) return add_face(core, best_face);
  best = kEdgeSine;
  std::uint32_t best_edge = hull.edge_count;
  for (std::uint32_t e = 0; e < hull.edge_count; ++e) {
    if (hull.edges[e].vertex[0] != corner && hull.edges[e].vertex[1] != corner) continue;
    const double sine = std::abs(direction(core, e).dot(outward));
    if (sine >= best) continue;
    best = sine;
    best_edge = e;
  }
  if (best_edge < hull.edge_count) return add_edge(core, best_edge, hull.face_count + best_edge);
  add(vertex(core, corner), corner, 0);
  feature_ = hull.face_count + hull.edge_count + corner;
}

void SupportingPatch::add_cap(const Core& core, double z) noexcept {
  const std::uint32_t first = z > 0.0 ? 0 : kRimCorners;
  static_assert(kRimCorners == std::size(kSixteenthsOfTurn));
  for (std::uint32_t i = 0; i < kRimCorners; ++i) {
    const auto [c, s] = kSixteenthsOfTurn[i];
    const Vec at(core.half.x() * c, core.half.x() * s, z);
    add(core.center + core.rotation * at, first + i, first + i);
  }
  feature_ = first;
}

void SupportingPatch::add_round(const Core& core, const Vec& outward) noexcept {
  const Vec d = core.rotation.transpose() * outward;
  const double r = core.half.x();
  const double h = core.half.z();
  const double radial = hypotenuse(d.x(), d.y());
  // A direction along the axis has no radial part: use +x.
  const Vec out = radial > kAlongAxis ? Vec(d.x() / radial, d.y() / radial, 0.0) : Vec::UnitX();
  const bool cone = core.kind == CoreKind::cone;
  const bool on_tip = cone && h * d.z() >= r * radial - h * d.z();
  // A cone has only the lower cap.
  const double over_cap = cone ? -d.z() : std::abs(d.z());
  if (over_cap > kCapCosine) return add_cap(core, d.z() > 0.0 ? h : -h);
  const Vec top = cone ? Vec(0.0, 0.0, h) : Vec(out * r + Vec(0.0, 0.0, h));
  add(core.center + core.rotation * top, kSideLine, kSideLine);
  feature_ = kSideLine;
  if (on_tip && radial <= kAlongAxis) return;
  add(core.center + core.rotation * (out * r - Vec(0.0, 0.0, h)), kSideLine + 1, kSideLine);
}

void SupportingPatch::add_taper(const Core& core, const Vec& outward) noexcept {
  const auto& taper = *static_cast<const TaperedCapsuleShape*>(core.farthest.shape);
  const auto scaled = [&](double length) { return length * core.unit[0] * core.unit[1]; };
  const double half = scaled(taper.half_length);
  const double more = scaled(std::max(taper.radius[0] - taper.radius[1], 0.0));
  const double less = scaled(std::max(taper.radius[1] - taper.radius[0], 0.0));
  const Vec axis = core.rotation.col(2) * half;
  // A ball inside the other one is not part of the surface.
  if (more == 0.0 || more < 2.0 * half) add(core.center + axis + outward * less, 0, 0);
  if (more > 0.0 || less < 2.0 * half) add(core.center - axis + outward * more, 1, 0);
}

namespace {

/// Keeps the points that are in the plane of point 0, the point farthest from it, and the point
/// with which these two span the largest triangle. Returns their number.
std::uint32_t keep_coplanar(Vec* x, std::uint32_t count) noexcept {
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

}  // namespace

// Uses directions that are slightly off, because bodies rock. The corners of a flat face stay far
// apart; the points of a round surface are close together, and the farthest of them is kept.
void SupportingPatch::add_samples(const Core& core, const Vec& outward) noexcept {
  constexpr std::uint32_t kSamples = 8;
  const Vec d = core.rotation.transpose() * outward;
  int axis = 0;
  while (axis < 2 && !(std::abs(d[axis]) <= kAxisCosine)) ++axis;
  const Vec side = without(core.rotation.col(axis), outward);
  const Vec u = side * kOffAxes[0] + outward.cross(side) * kOffAxes[1];
  const Vec v = outward.cross(u);
  const AxisRange width[2] = {project(core, u), project(core, v)};
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
    take(support(core, outward + (u * c + v * s) * kSampleTilt));
  }
  if (count == 1) kept[0] = support(core, outward);
  count = keep_coplanar(kept, count);
  for (std::uint32_t i = 0; i < count; ++i) add(kept[i], i, i);
}

namespace {

/// Feature number of a single contact point, as in the kernels of round shapes.
std::uint32_t point_feature(const Core& core, const Vec& at) noexcept {
  const Vec x = core.rotation.transpose() * (at - core.center);
  const auto side = [&](int i) {
    const double near = core.half[i] - 1e-9 * core.size;
    return x[i] >= near ? 1 : (x[i] <= -near ? -1 : 0);
  };
  if (core.kind == CoreKind::segment) return side(2) == 0 ? 0 : (side(2) > 0 ? 1 : 2);
  if (core.kind != CoreKind::box) return 0;
  return static_cast<std::uint32_t>(13 + side(0) + 3 * side(1) + 9 * side(2));
}

/// Converts to the caller's units, limited to the largest float.
float as_float(const Problem& problem, double length) noexcept {
  return finite_float(unscaled(problem, length));
}

/// The contact point that follows from the distance result only.
ContactPoint single_contact(const Problem& problem, const Vec& point, const Vec& normal,
                            double distance) noexcept {
  const Vec middle = point + normal * (0.5 * distance);
  const Vec on_a = point - normal * problem.a.rounding;
  const Vec on_b = point + normal * (distance + problem.b.rounding);
  ContactPoint contact{};
  for (int i = 0; i < 3; ++i) contact.position[i] = static_cast<float>(middle[i]);
  contact.depth = static_cast<float>(-distance);
  contact.feature =
      std::uint64_t{point_feature(problem.a, on_a)} << 32U | point_feature(problem.b, on_b);
  return contact;
}

/// Writes the contacts of two segments at those ends of the range in which they are side by side
/// that are within the margin, the deeper one first, as in the kernels. Returns their number; 0 if
/// the segments are not side by side.
std::uint32_t parallel_segment_contacts(const Problem& problem, const Vec& normal, double distance,
                                        double margin, ContactPoint* out) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  const Vec u = a.rotation.col(2);
  const Vec w = b.rotation.col(2);
  const Vec c = b.center - a.center;
  const double half_a = a.half.z();
  const double half_b = b.half.z();
  const double reach = half_b * std::abs(u.dot(w));
  const double ends[2] = {std::max(u.dot(c) - reach, -half_a), std::min(u.dot(c) + reach, half_a)};
  const bool beside = u.cross(w).squaredNorm() < kBesideSquare &&
                      ends[1] - ends[0] > (half_a + half_b) * kMinOverlapLength;
  if (!beside) return 0;
  Vec foot[2][2];
  double apart[2];
  for (int i = 0; i < 2; ++i) {
    const double t = std::clamp(u.dot(w) * ends[i] - w.dot(c), -half_b, half_b);
    foot[i][0] = a.center + u * ends[i];
    foot[i][1] = b.center + w * t;
    apart[i] = (foot[i][1] - foot[i][0]).norm() - a.rounding - b.rounding;
  }
  const double behind = std::min(apart[0], apart[1]) - distance;
  if (!(behind <= (a.rounding + b.rounding) * kEndDepthTolerance)) return 0;
  const int first = apart[1] < apart[0] ? 1 : 0;
  std::uint32_t count = 0;
  for (const int i : {first, 1 - first}) {
    if (!(apart[i] - behind <= margin)) continue;
    const Vec middle = (foot[i][0] + normal * a.rounding + foot[i][1] - normal * b.rounding) * 0.5;
    for (int k = 0; k < 3; ++k) out[count].position[k] = static_cast<float>(middle[k]);
    out[count].depth = static_cast<float>(behind - apart[i]);
    out[count].feature =
        std::uint64_t{point_feature(a, foot[i][0])} << 32U | point_feature(b, foot[i][1]);
    ++count;
  }
  return count;
}

/// Calls `contacts` with the two supporting features, and returns its result.
template <typename Contacts>
std::uint32_t with_features(const Problem& problem, const Vec& normal, Contacts&& contacts) {
  const SupportingPatch a(problem.a, normal);
  if (problem.b.kind != CoreKind::half_space) {
    return contacts(a.view(), SupportingPatch(problem.b, -normal).view());
  }
  const double reach = 2.0 * problem.a.size + problem.noise();
  return contacts(a.view(),
                  SupportingPatch::of_half_space(problem.b, problem.a.center, reach).view());
}

std::uint32_t feature_contacts(const Problem& problem, const Vec& normal, double distance,
                               double margin, ContactPoint* out) noexcept {
  if (problem.a.kind == CoreKind::segment && problem.b.kind == CoreKind::segment) {
    return parallel_segment_contacts(problem, normal, distance, margin, out);
  }
  return with_features(problem, normal,
                       [&](const SupportingFeature& a, const SupportingFeature& b) {
                         return contact_patch(a, b, normal.data(), margin, out);
                       });
}

}  // namespace

namespace {

bool touches_in_a_point(const Core& core) noexcept {
  return core.kind == CoreKind::point ||
         (core.kind == CoreKind::support && core.farthest.kind == ShapeKind::ellipsoid);
}

}  // namespace

void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept {
  const Vec normal = Vec::Map(answer.normal);
  // Lengths are about 1: only the depth of two half-spaces, which is unbounded, exceeds 8.
  const ContactPoint single = single_contact(problem, point, normal, std::max(distance, -8.0));
  const bool is_single_point = touches_in_a_point(problem.a) || touches_in_a_point(problem.b) ||
                               problem.a.kind == CoreKind::half_space;
  ContactPoint* contacts = answer.contacts;
  std::uint32_t count =
      is_single_point ? 0 : feature_contacts(problem, normal, distance, margin, contacts);
  // The closest point of the pair replaces the deepest point of the features if the depths of the
  // two differ by more than rounding errors and tied_depth (as for caps, which are polygons of 16
  // corners), if the features are farther apart than the margin, or if they have only one contact.
  // If the depths differ by more than 1e-2 of the size, the closest point is inserted before the
  // points of the features instead. No point becomes deeper than the closest point, and the first
  // point has its depth.
  const double miss = std::abs(double{contacts[0].depth} - double{single.depth});
  const bool near = count > 0 && double{contacts[0].depth} >= -margin;
  if (near && count > 1 && miss > 1e-2 * problem.size) {
    count = std::min(count + 1, kManifoldPoints);
    std::copy_backward(contacts, contacts + count - 1, contacts + count);
    contacts[0] = single;
  } else if (!near || count == 1 ||
             miss > std::max(4e-7 * problem.size, tied_depth(contacts, count))) {
    const std::uint64_t feature = near ? contacts[0].feature : single.feature;
    contacts[0] = single;
    contacts[0].feature = feature;
    count = std::max(count, 1U);
  }
  contacts[0].depth = single.depth;
  answer.contact_count = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    contacts[i].depth = std::min(contacts[i].depth, single.depth);
    for (float& x : contacts[i].position) {
      x = as_float(problem, static_cast<double>(x));
    }
    contacts[i].depth = as_float(problem, static_cast<double>(contacts[i].depth));
  }
}

std::uint32_t intersection_corners(const Problem& problem, const Vec& normal, double margin,
                                   ContactPoint* out) noexcept {
  return with_features(problem, normal,
                       [&](const SupportingFeature& a, const SupportingFeature& b) {
                         return winnow::intersection_corners(a, b, normal.data(), margin, out);
                       });
}

}  // namespace winnow::solver
