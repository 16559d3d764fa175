#include <winnow/pipeline/exact/exact_overlap.h>

namespace winnow {

ExactVerdict exact_overlap(const ShapeTables&, ShapeId, const Pose&, ShapeId, const Pose&,
                           const double[3]) noexcept {
  return ExactVerdict::undecided;
}

}  // namespace winnow
