#include "pipeline/kernels/flat/triangle_closest.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

// Where a pair stands, and its normal, in memory.
template <typename T>
struct TriangleStage {
  Stage<T, 26> stage;

  [[gnu::always_inline]] TriangleStage(const TrianglePair<T>& pair, const Vec3<T>& normal) {
    for (int i = 0; i < 3; ++i) {
      stage.put(3 * i, pair.a.vertex[i]);
      stage.put(9 + 3 * i, pair.b.vertex[i]);
    }
    stage.put(18, normal);
    stage.put(21, pair.offset);
    stage.put(24, pair.a.rounding);
    stage.put(25, pair.b.rounding);
  }
  [[nodiscard]] auto offset() const { return stage.value + 21; }
  void patches(unsigned lane, FlatPatch& a, FlatPatch& b, double (&normal)[3]) const {
    TriangleFrame frame_a;
    TriangleFrame frame_b;
    stage.get(0, 9, lane, &frame_a.vertex[0][0]);
    stage.get(9, 9, lane, &frame_b.vertex[0][0]);
    stage.get(18, 3, lane, normal);
    stage.get(24, 1, lane, &frame_a.rounding);
    stage.get(25, 1, lane, &frame_b.rounding);
    a = triangle_patch(frame_a);
    b = triangle_patch(frame_b);
  }
};

struct TriangleTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& given) {
    if constexpr (L == kBoolean) return overlap<T>(job, given);
    const OrderedBlock<T> ordered(job, given);
    const TrianglePair<T> pair(job, ordered.block);
    return answer_flat<L, TriangleStage<T>>(job, given, pair, ordered.sign);
  }

  template <typename T>
  [[gnu::always_inline]] static Mask16 overlap(NarrowJob& job, const PairBlock<T>& block) {
    const TrianglePair<T> pair(job, block);
    const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
    const Mask16 valid = bits(in_range(pair.scale * pair.scale));
    // An axis is at most as long as the edges' product: what is above the slack and the roundings
    // times that is separated by more.
    const Lanes<T> reach = slack + pair.a.rounding + pair.b.rounding;
    const Lanes<T> over_a = pair.over_a();
    const Lanes<T> over_b = pair.over_b();
    LaneMask<T> apart = (over_a > reach * pair.a.area) | (over_b > reach * pair.b.area);
    LaneMask<T> over = (over_a < -(slack * pair.a.area)) & (over_b < -(slack * pair.b.area));
    if ((bits(apart) & valid) != kAllLanes<T>) {
      for_products(
          pair, [&](int, int, const Vec3<T>&, const Lanes<T>& s, const Lanes<T>& size)
                    __attribute__((always_inline)) {
                      apart = apart | (s > reach * size);
                      over = over & (s < -(slack * size));
                    });
    }
    return answer_overlaps<TriangleStage<T>>(job, block, pair, apart, over);
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const NarrowKernels WINNOW_KERNEL_TABLE(triangle_triangle_kernels) =
    WINNOW_ISA_NAME::narrow_kernels_of<WINNOW_ISA_NAME::TriangleTriangle>();

}  // namespace winnow
