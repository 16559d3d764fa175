// Contacts of convex patches (patch_contact.h). Called by surface_contacts.cpp.

#include "pipeline/composites/patch_contact.h"

#include "pipeline/shapes/extent.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace winnow::mid {
namespace {

// Cosine of the angle between two normals of a patch that counts as gentle.
constexpr double kGentleCosine = 0.99;
// Times that a patch is solved while it grows.
constexpr int kMaxRounds = 12;

}  // namespace

bool PatchContact::is_of(const BodyPair& primitives) const noexcept {
  const std::uint32_t own[2] = {primitives.a, primitives.b};
  for (std::size_t k = 0; k < 2; ++k) {
    if (side[k].is_empty() ? other[k] != own[k] : !side[k].contains(own[k])) return false;
  }
  return !side[0].is_empty() || !side[1].is_empty();
}

// The least way out of a patch may lead over a neighbour that does not overlap the other body, and
// so is not in the patch. It then rises above the plane of the contact, and is added.
void PatchSolver::solve(const AnswerGroup& group, PatchContact& contact) const noexcept {
  if (solve_gentle(contact)) return;
  for (int round = 0; round < kMaxRounds; ++round) {
    solve_convex(contact);
    if (!contact.is_valid || !grow_to_blockers(group, contact)) return;
  }
  contact.is_valid = false;
}

// Finds the least translation that parts the convex patches.
void PatchSolver::solve_convex(PatchContact& contact) const noexcept {
  const std::uint32_t a = contact.other[0];
  const std::uint32_t b = contact.other[1];
  const PairAnswer answer =
      solve_patches(tables_, {pairs_.shapes[a], pairs_.poses[a], contact.side[0]},
                    {pairs_.shapes[b], pairs_.poses[b], contact.side[1]});
  contact.normal = as_eigen(answer.normal);
  contact.distance = answer.distance;
  contact.error = answer.error_bound;
  contact.is_valid = answer.distance <= 0.0 && std::isfinite(answer.distance);
  const Pose from = contact.side[0].is_empty() ? pairs_.poses[a] : contact.side[0].pose();
  contact.touched[0] = as_eigen(from.position) + as_eigen(answer.point);
  contact.touched[1] = contact.touched[0] + contact.distance * contact.normal;
}

// Adds the triangles at the touched points that rise above the plane of the contact. Returns
// whether a patch has grown. The contact is not valid if a patch cannot take such a triangle.
bool PatchSolver::grow_to_blockers(const AnswerGroup& group, PatchContact& contact) const noexcept {
  bool has_grown = false;
  for (const bool second : {false, true}) {
    ConvexPatch& own = contact.side[second ? 1 : 0];
    if (own.is_empty()) continue;
    const Vec& touched = contact.touched[second ? 1 : 0];
    const Vec outward = second ? Vec(-contact.normal) : contact.normal;
    SurfaceCones::Blocker blocker;
    if (!cones_.find_blocker(touched, outward, kPatchSlack * own.size(), second, group, blocker))
      continue;
    if (!own.add(blocker.primitive, blocker.facet)) {
      contact.is_valid = false;
      return false;
    }
    has_grown = true;
  }
  return has_grown;
}

// Solves a patch that bends so little that the best of its face normals is as good as any
// direction, if the other shape is deepest over the patch: then the depth along any normal between
// those of the faces is at least kGentleCosine of that depth.
bool PatchSolver::solve_gentle(PatchContact& contact) const noexcept {
  const bool second = contact.side[0].is_empty();
  const ConvexPatch& own = contact.side[second ? 1 : 0];
  if (!contact.side[second ? 0 : 1].is_empty()) return false;
  const std::span<const Facet> facets = own.facets();
  const Vec& middle = facets[0].normal;
  const auto is_bent = [&](const Facet& one) { return one.normal.dot(middle) < kGentleCosine; };
  if (std::ranges::any_of(facets, is_bent)) return false;
  const std::uint32_t a = contact.other[0];
  const std::uint32_t b = contact.other[1];
  const std::uint32_t other = second ? a : b;
  const Mat rotation = rotation_of(scale_to_unit_max(pairs_.poses[other].orientation));
  const auto at = as_eigen(pairs_.poses[other].position);
  contact.distance = -kInfinity;
  for (const Facet& facet : facets) {
    const SupportExtent reach =
        extent(tables_, pairs_.shapes[other], rotation.transpose() * facet.normal);
    const double gap = facet.normal.dot(at - facet.corner[0]) + reach.low;
    if (gap <= contact.distance) continue;
    contact.distance = gap;
    contact.normal = second ? Vec(-facet.normal) : facet.normal;
    contact.error = kSlack * (reach.scale + at.lpNorm<1>() + facet.corner[0].lpNorm<1>());
  }
  solver::Problem problem;
  prepare(tables_, pairs_.shapes[a], pairs_.poses[a], pairs_.shapes[b], pairs_.poses[b], false,
          problem);
  const Vec deepest = solver::support(second ? problem.a : problem.b,
                                      second ? contact.normal : Vec(-contact.normal));
  if (!own.is_under(as_eigen(pairs_.poses[a].position) + unscaled(problem, 1.0) * deepest)) {
    return false;
  }
  contact.error += (1.0 - kGentleCosine) * std::abs(contact.distance);
  // Each triangle that reaches the plane is clipped against it.
  contact.touched[0] = contact.touched[1] = Vec::Constant(kInfinity);
  contact.is_valid = contact.distance <= 0.0;
  return true;
}

}  // namespace winnow::mid
