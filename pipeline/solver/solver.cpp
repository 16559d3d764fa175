#include <winnow/pipeline/solver/solver.h>

namespace winnow {

PairAnswer solve_pair(const ShapeTables&, ShapeId, const Pose&, ShapeId, const Pose&, NarrowLevel,
                      double, SolverCounts&) noexcept {
  return {};
}

}  // namespace winnow
