#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

struct SphereCapsule {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Vec3<T> c = load_offset(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const CapsuleLanes<T> capsule = load_capsule<SideB>(job, block);

    // An error of t changes the distance by at most that error.
    const Vec3<T> axis = axis_z(turn);
    const Lanes<T> t = clamp(-dot(c, axis), -capsule.half_length, capsule.half_length);
    const Lanes<T> radius = ra + capsule.radius;
    const CoreGapLanes<T> witness{c + axis * t, radius,
                                  norm_l1(c) + capsule.half_length + radius + doubt(turn)};
    if constexpr (L == kBoolean) {
      return answer_overlap(job, block, witness);
    } else {
      CertifiedLanes<T> answer = answer_distance(witness, witness.scale * Lanes<T>(T(kShortest)));
      if ((~answer.certified & block.lanes()) != 0) [[unlikely]] {
        separate_across(answer, witness, any_across(axis), witness.scale > Lanes<T>(T(0)));
      }
      return write_ball<L>(job, block, answer, ra, segment_feature(t, capsule.half_length));
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_capsule_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereCapsule,
                                            WINNOW_ISA_NAME::kManifold, false>();

}  // namespace winnow
