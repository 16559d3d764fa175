#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"
#include "pipeline/kernels/shared_by_levels.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The signed distance of a point from the core of a box.
template <typename T>
struct BoxSurfaceView {
  /// Negative inside, by the distance to the nearest face.
  Lanes<T> distance;
  /// Unit, towards the box (if inside: away from the nearest face), in the box's frame.
  Vec3<T> towards;
  /// Unit, away from the nearest face, also if the point is outside.
  Vec3<T> face;
  /// `towards` is unique if this is above zero. Outside, the distance; inside, it is small if
  /// another face is nearly as near as the nearest one.
  Lanes<T> lead;
};

/// `p` is in the box's frame.
template <typename T>
[[gnu::always_inline]] inline BoxSurfaceView<T> view_box(const Vec3<T>& p, const Vec3<T>& half) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Vec3<T> w{clamp(p.x, -half.x, half.x) - p.x, clamp(p.y, -half.y, half.y) - p.y,
                  clamp(p.z, -half.z, half.z) - p.z};
  const Lanes<T> length = sqrt(dot(w, w));
  const Vec3<T> depth{abs(p.x) - half.x, abs(p.y) - half.y, abs(p.z) - half.z};
  const Lanes<T> xy = max(depth.x, depth.y);
  const Lanes<T> best = max(xy, depth.z);
  const Lanes<T> second = max(min(depth.x, depth.y), min(xy, depth.z));
  const LaneMask<T> outside = best > zero;

  const LaneMask<T> is_z = depth.z >= xy;
  const LaneMask<T> is_y = (!is_z) & (depth.y >= depth.x);
  const LaneMask<T> is_x = !(is_z | is_y);
  const Vec3<T> face{select(is_x, -sign_or_one(p.x), zero), select(is_y, -sign_or_one(p.y), zero),
                     select(is_z, -sign_or_one(p.z), zero)};
  const Lanes<T> beside = select(is_z, abs(p.z), select(is_y, abs(p.y), abs(p.x)));
  return {select(outside, length, best), select(outside, w * (one / length), face), face,
          select(outside, length, min(best - second, beside))};
}

template <typename T>
struct SphereBoxSolution {
  Rotation<T> axes;
  BoxSurfaceView<T> view;
  Lanes<T> sphere_radius;
  Lanes<T> distance;
  Lanes<T> scale;
};

template <typename T>
[[gnu::always_inline]] inline SphereBoxSolution<T> solve(const NarrowJob& job,
                                                         const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
  const BoxLanes<T> box = load_box<SideB>(job, block);
  SphereBoxSolution<T> r;
  r.sphere_radius = load_sphere<SideA>(job, block);
  // If the point moves by some length, its signed distance changes by at most that length. So the
  // error of the distance is at most that of the sphere's center.
  r.axes = rotation(turn);
  r.view = view_box(-r.axes.to_local(c), box.half);
  const Lanes<T> radius = r.sphere_radius + box.rounding;
  r.scale = norm_l1(c) + norm_l1(box.half) + radius + doubt(turn);
  r.distance = r.view.distance - radius;
  return r;
}

template <typename T>
WINNOW_SHARED_BY_LEVELS SphereBoxSolution<T> solve_all(const NarrowJob& job,
                                                       const PairBlock<T>& block) {
  return solve(job, block);
}

struct SphereBox {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Lanes<T> roundings(T(kRoundings) * kEpsilon<T>);
    if constexpr (L == kBoolean) {
      // Inlined, so that the compiler removes the code that only the other levels need.
      const SphereBoxSolution<T> r = solve(job, block);
      return answer_sign(job, block, r.distance, r.scale * roundings, r.scale);
    } else {
      const SphereBoxSolution<T> r = solve_all(job, block);
      const Lanes<T> bound = r.scale * roundings;
      // If several faces are the nearest, up to rounding, the normal of any of them is right.
      const LaneMask<T> tied = r.view.lead <= bound;
      const LaneMask<T> known = tied | (r.view.lead > r.scale * Lanes<T>(T(kShortest)));
      const Vec3<T> towards = select(tied, r.view.face, r.view.towards);
      const Lanes<T> widened = select(tied, bound + bound, bound);
      const CertifiedLanes<T> answer{r.distance, widened, r.axes.to_world(towards),
                                     certified_lanes(r.distance, widened, r.scale, known)};
      return write_ball<L>(job, block, answer, r.sphere_radius, box_feature(towards));
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_box_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereBox>();

}  // namespace winnow
