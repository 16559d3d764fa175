#include "pipeline/motion/one_pair.h"

#include "pipeline/kernels/kernels.h"
#include "pipeline/shapes/pair_order.h"

namespace winnow::impact {

PairAnswer distance_of(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                       const Pose& pose_b) noexcept {
  const NarrowKernels* const kernels =
      is_mirrored(a, b) ? nullptr : narrow_kernels(a.kind(), b.kind());
  const NarrowKernel kernel =
      kernels == nullptr ? nullptr : kernels->robust[kernel_index(ContactLevel::distance)];
  const ShapeId shapes[2] = {a, b};
  const Pose poses[2] = {pose_a, pose_b};
  const BodyPair pair{0, 1};
  PairAnswer answer;
  std::uint32_t uncertified[1];
  NarrowJob job{};
  job.pairs = &pair;
  job.count = 1;
  job.shapes = shapes;
  job.poses = poses;
  job.tables = tables;
  job.distance = &answer.distance;
  job.error_bound = &answer.error_bound;
  for (int axis = 0; axis < 3; ++axis) {
    job.normal[axis] = &answer.normal[axis];
    job.point[axis] = &answer.point[axis];
  }
  job.uncertified = uncertified;
  if (kernel != nullptr && kernel(job) == 0) {
    answer.overlap = answer.distance <= 0.0;
    return answer;
  }
  SolverCounts counts;
  return solve_pair(tables, a, pose_a, b, pose_b, ContactLevel::distance, 0.0, counts);
}

}  // namespace winnow::impact
