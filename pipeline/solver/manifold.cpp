// Contact manifolds of single pairs; see manifold.h. Called by
// the solver and by composites/surface_contacts.cpp and manifold_reduction.cpp.

#include "pipeline/solver/manifold.h"

#include <winnow/core/volumes.h>
#include "core/numbers/rounding.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"
#include "pipeline/manifold/polygon_clip.h"
#include "pipeline/solver/core_forms.h"

#include <algorithm>
#include <cmath>

namespace winnow::solver {
SupportingPatch::SupportingPatch(const Core& core, const Vec& outward) noexcept {
  rounding_ = core.rounding;
  with_form(core, [&](auto form) { form.add_feature(core, outward, *this); });
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

namespace {

/// Feature number of a single contact point, as in the kernels of round shapes.
std::uint32_t point_feature(const Core& core, const Vec& at) noexcept {
  const Vec x = core.rotation.transpose() * (at - core.center);
  return with_form(core, [&](auto form) { return form.point_feature(core, x); });
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
  if (problem.b.kind != ShapeKind::half_space) {
    return contacts(a.view(), SupportingPatch(problem.b, -normal).view());
  }
  const double reach = 2.0 * problem.a.size + problem.noise();
  return contacts(a.view(),
                  SupportingPatch::of_half_space(problem.b, problem.a.center, reach).view());
}

bool touches_in_a_point(const Core& core) noexcept {
  return with_form(core, [](auto form) { return form.kTouchesInPoint; });
}

std::uint32_t feature_contacts(const Problem& problem, const Vec& normal, double distance,
                               double margin, ContactPoint* out) noexcept {
  if (problem.a.kind == ShapeKind::capsule && problem.b.kind == ShapeKind::capsule) {
    return parallel_segment_contacts(problem, normal, distance, margin, out);
  }
  return with_features(problem, normal,
                       [&](const SupportingFeature& a, const SupportingFeature& b) {
                         return contact_patch(a, b, normal.data(), margin, out);
                       });
}

}  // namespace

void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept {
  const Vec normal = as_eigen(answer.normal);
  // Lengths are about 1: only the depth of two half-spaces, which is unbounded, exceeds 8.
  const ContactPoint single = single_contact(problem, point, normal, std::max(distance, -8.0));
  const bool is_single_point = touches_in_a_point(problem.a) || touches_in_a_point(problem.b) ||
                               problem.a.kind == ShapeKind::half_space;
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
