#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

struct SphereSphere {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Vec3<T> c = load_offset(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const Lanes<T> radius = ra + load_sphere<SideB>(job, block);
    const CoreGapLanes<T> witness{c, radius, norm_l1(c) + radius};
    if constexpr (L == kBoolean) {
      return answer_overlap(job, block, witness);
    } else {
      // The relative error of the offset is one rounding, however short the offset is. The error of
      // the normal is as small, so the limit kShortest is not needed.
      const CertifiedLanes<T> answer = answer_distance(witness, Lanes<T>(T(1e-130)));
      return write_ball<L>(job, block, answer, ra, Lanes<T>(T(0)));
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_sphere_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereSphere,
                                            WINNOW_ISA_NAME::kManifold, false>();

}  // namespace winnow
