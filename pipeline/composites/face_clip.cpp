#include "pipeline/composites/face_clip.h"
#include "pipeline/solver/problem.h"
#include "pipeline/solver/supporting_patch.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

// Of float positions and depths.
constexpr double kFloatError = 1.2e-7;
constexpr double kFloatSlack = 1e-6;

/// If a point, seen along the triangle's normal, is in the triangle.
[[nodiscard]] bool is_over(const solver::Core& triangle, const Vec& normal, const float* point,
                           double size) noexcept {
  const Vec at = Eigen::Map<const Eigen::Vector3f>(point).cast<double>() - triangle.center;
  double least = 0.0;
  double most = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beside = triangle.side[k].cross(at - triangle.corner[k]).dot(normal);
    least = std::min(least, beside);
    most = std::max(most, beside);
  }
  // On the same side of all edges, whichever way they run.
  return std::min(-least, most) <= kFloatSlack * size;
}

/// To the caller's units, at most the largest float.
[[nodiscard]] float scaled(float x, double unit) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(std::clamp(static_cast<double>(x) * unit, -kMost, kMost));
}

}  // namespace

bool clip_to_face(const FacePair& pair, const Vec& normal, double margin, double least, double most,
                  FaceContacts& out) noexcept {
  solver::Problem problem;
  prepare(pair.tables, pair.a, pair.pose_a, pair.b, pair.pose_b, false, problem);
  const solver::SupportingPatch a(problem.a, normal);
  const solver::SupportingPatch b(problem.b, -normal);
  const double reach = std::min(std::ldexp(margin, -problem.exponent), 8.0);
  out.count = contact_patch(a.view(), b.view(), normal.data(), reach, out.points);
  ContactPoint& deepest = out.points[0];
  const solver::Core& triangle = pair.second ? problem.b : problem.a;
  if (!is_over(triangle, normal, deepest.position, problem.size)) return false;
  const double unit = unscaled(problem, 1.0);
  out.depth = static_cast<double>(deepest.depth) * unit;
  if (!(out.depth <= most)) return false;
  out.depth = std::max(out.depth, least);
  out.noise = unscaled(problem, problem.noise()) + kFloatError * out.depth;
  for (std::uint32_t k = 0; k < out.count; ++k) {
    for (float& x : out.points[k].position) x = scaled(x, unit);
    out.points[k].depth = scaled(out.points[k].depth, unit);
  }
  deepest.depth = std::max(deepest.depth, scaled(1.0F, least));
  return true;
}

}  // namespace winnow::mid
