#include "pipeline/solver/revolution.h"

namespace winnow::solver {
namespace {

bool is_round(const Core& core) noexcept {
  return core.kind == CoreKind::point || core.kind == CoreKind::segment ||
         core.kind == CoreKind::cylinder || core.kind == CoreKind::cone;
}

/// The two normals of a cone's side in the plane of its axis and `across`.
void look_at_side(const Core& core, const Vec& across, AxisSearch& search) noexcept {
  if (core.kind != CoreKind::cone) return;
  const Vec out = across * (2.0 * core.half.z());
  const Vec up = core.rotation.col(2) * core.half.x();
  search.look(unit(out + up));
  search.look(unit(out - up));
}

}  // namespace

bool look_at_revolution(const Problem& problem, AxisSearch& search) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  if (!is_round(a) || !is_round(b)) return false;
  const Core& first = a.kind != CoreKind::point ? a : b;
  const Vec axis = first.rotation.col(2);
  if (b.kind != CoreKind::point) {
    const double turn = axis.cross(b.rotation.col(2)).cwiseAbs().maxCoeff();
    if (turn > 4.0 * kEpsilon) return false;
  }
  Vec across = without(b.center - a.center, axis);
  // On the axis all directions are alike.
  const Vec aside = (b.center - a.center) - axis * axis.dot(b.center - a.center);
  for (int i = 0; i < 3 && aside.norm() <= kEpsilon * problem.size; ++i) {
    across = without(problem.tie_axes.col(i), axis);
    if (across != Vec::Zero()) break;
  }
  search.look(axis);
  search.look(across);
  look_at_side(a, across, search);
  look_at_side(b, across, search);
  return true;
}

}  // namespace winnow::solver
