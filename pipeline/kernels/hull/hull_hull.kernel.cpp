// Hull against hull; hull_answers.wide.h runs the jobs.

#include "pipeline/kernels/hull/hull_answers.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::hull {
/// The kernels of hull-hull; both hulls are used as stored in the pool.
struct HullAndHull {
  static constexpr std::uint32_t kRoom = 128;
  static constexpr bool kSimpleSecond = false;
  static constexpr bool kPointSecond = false;
  using Seconds = HullSeconds;

  static bool place(const NarrowJob& job, BodyPair bodies, std::uint32_t /*slot*/, HullPair& pair) {
    const HullShape& a = job.tables->hulls[job.shapes[bodies.a].index()];
    const HullShape& b = job.tables->hulls[job.shapes[bodies.b].index()];
    const Pose& pose_a = job.poses[bodies.a];
    const Pose& pose_b = job.poses[bodies.b];
    return place_hulls(a, b, pose_a, pose_b, computes_b_first(a, b, pose_a, pose_b), pair);
  }
  static bool complete(std::uint32_t /*slot*/) { return true; }
};

}  // namespace WINNOW_ISA_NAME::hull

extern const NarrowKernels WINNOW_KERNEL_TABLE(hull_hull_kernels) =
    WINNOW_ISA_NAME::hull::kHullKernels<WINNOW_ISA_NAME::hull::HullAndHull>;

}  // namespace winnow
