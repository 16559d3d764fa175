#include "pipeline/solver/manifold.h"

#include "pipeline/manifold/contact_patch.h"
#include "pipeline/solver/supporting_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::solver {
namespace {

/// What a single point of contact is called: as in the kernels of round shapes.
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

/// In the caller's units, at most the largest float.
float as_float(const Problem& problem, double length) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(std::clamp(unscaled(problem, length), -kMost, kMost));
}

/// The one point that the answer itself tells.
ContactPoint own_point(const Problem& problem, const Vec& point, const Vec& normal,
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

std::uint32_t meet(const Problem& problem, const Vec& normal, double margin,
                   ContactPoint* out) noexcept {
  const SupportingPatch a(problem.a, normal);
  const double direction[3] = {normal.x(), normal.y(), normal.z()};
  if (problem.b.kind != CoreKind::half_space) {
    return contact_patch(a.view(), SupportingPatch(problem.b, -normal).view(), direction, margin,
                         out);
  }
  const double reach = 2.0 * problem.a.size + problem.noise();
  const SupportingPatch b = SupportingPatch::of_half_space(problem.b, problem.a.center, reach);
  return contact_patch(a.view(), b.view(), direction, margin, out);
}

}  // namespace

void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept {
  const Vec normal = Vec::Map(answer.normal);
  // Lengths are about 1: only the endless depth of two half-spaces is more than 8.
  const ContactPoint own = own_point(problem, point, normal, std::max(distance, -8.0));
  const bool alone = problem.a.kind == CoreKind::point || problem.b.kind == CoreKind::point ||
                     problem.a.kind == CoreKind::half_space;
  ContactPoint* contacts = answer.contacts;
  std::uint32_t count = alone ? 0 : meet(problem, normal, margin, contacts);
  // Where the features miss the point of least distance, as caps with 16 corners do by a little, it
  // takes the place of their deepest; where they miss it by much, it is put in front of them.
  const double miss = std::abs(double{contacts[0].depth} - double{own.depth});
  if (count == 0 || miss > 1e-2 * problem.size) {
    count = std::min(count + 1, kManifoldPoints);
    std::copy_backward(contacts, contacts + count - 1, contacts + count);
    contacts[0] = own;
  } else if (miss > 4e-7 * problem.size) {
    const std::uint64_t feature = contacts[0].feature;
    contacts[0] = own;
    contacts[0].feature = feature;
  }
  answer.contact_count = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (float& x : contacts[i].position) {
      x = as_float(problem, static_cast<double>(x));
    }
    contacts[i].depth = as_float(problem, static_cast<double>(contacts[i].depth));
  }
}

}  // namespace winnow::solver
