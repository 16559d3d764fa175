#include "pipeline/kernels/flat/box_triangle_closest.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

// Where a pair stands, and its normal, in memory.
template <typename T>
struct BoxTriangleStage {
  Stage<T, 29> stage;

  [[gnu::always_inline]] BoxTriangleStage(const BoxTrianglePair<T>& pair, const Vec3<T>& normal) {
    stage.put(0, pair.frame.x);
    stage.put(3, pair.frame.y);
    stage.put(6, pair.frame.z);
    stage.put(9, pair.half);
    for (int i = 0; i < 3; ++i) stage.put(12 + 3 * i, pair.to_world(pair.b.vertex[i]));
    stage.put(21, normal);
    stage.put(24, pair.offset);
    stage.put(27, pair.box_rounding);
    stage.put(28, pair.b.rounding);
  }
  [[nodiscard]] auto offset() const { return stage.value + 24; }
  void patches(unsigned lane, FlatPatch& a, FlatPatch& b, double (&normal)[3]) const {
    BoxFrame box;
    TriangleFrame triangle;
    stage.get(0, 9, lane, &box.axis[0][0]);
    stage.get(9, 3, lane, box.half);
    stage.get(12, 9, lane, &triangle.vertex[0][0]);
    stage.get(21, 3, lane, normal);
    stage.get(27, 1, lane, &box.rounding);
    stage.get(28, 1, lane, &triangle.rounding);
    for (double& c : box.center) c = 0.0;
    a = box_patch(box, normal);
    b = triangle_patch(triangle);
  }
};

struct BoxTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& given) {
    if constexpr (L == kBoolean) return overlap<T>(job, given);
    alignas(64) T sign[Lanes<T>::kCount];
    Lanes<T>(T(1)).store(sign);
    const BoxTrianglePair<T> pair(job, given);
    return answer_flat<L, BoxTriangleStage<T>>(job, given, pair, sign);
  }

  template <typename T>
  [[gnu::always_inline]] static Mask16 overlap(NarrowJob& job, const PairBlock<T>& block) {
    const BoxTrianglePair<T> pair(job, block);
    const Lanes<T> slack = pair.scale * Lanes<T>(kSlack<T>);
    const Mask16 valid = bits(in_range(pair.scale * pair.scale));
    const Lanes<T> reach = slack + pair.box_rounding + pair.b.rounding;
    const Lanes<T> face = max(pair.face(0), max(pair.face(1), pair.face(2)));
    const Lanes<T> above = pair.over_triangle();
    LaneMask<T> apart = (face > reach) | (above > reach * pair.b.area);
    LaneMask<T> over = (face < -slack) & (above < -(slack * pair.b.area));
    if ((bits(apart) & valid) != kAllLanes<T>) {
      for_products(
          pair, [&](int, int j, const Lanes<T>&, const Lanes<T>& s) __attribute__((always_inline)) {
            apart = apart | (s > reach * pair.b.length[j]);
            over = over & (s < -(slack * pair.b.length[j]));
          });
    }
    return answer_overlaps<BoxTriangleStage<T>>(job, block, pair, apart, over);
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const NarrowKernels WINNOW_KERNEL_TABLE(box_triangle_kernels) =
    WINNOW_ISA_NAME::narrow_kernels_of<WINNOW_ISA_NAME::BoxTriangle>();

}  // namespace winnow
