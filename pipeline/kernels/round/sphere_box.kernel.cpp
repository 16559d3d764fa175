#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The core of a box seen from a point.
template <typename T>
struct BoxView {
  /// Negative inside, by the distance to the nearest face.
  Lanes<T> distance;
  /// Unit, towards the box (inside: away from the nearest face), in the box's frame.
  Vec3<T> towards;
  /// How far the nearest of another direction is behind; the direction is unique if above zero.
  Lanes<T> lead;
};

/// `p` is in the box's frame.
template <typename T>
[[gnu::always_inline]] inline BoxView<T> view_box(const Vec3<T>& p, const Vec3<T>& half) {
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
  return {select(outside, length, best), select(outside, w * (one / length), face),
          select(outside, length, min(best - second, beside))};
}

struct SphereBox {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Vec3<T> c = load_offset(job, block);
    const Turn<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const BoxLanes<T> box = load_box<SideB>(job, block);

    // The signed distance changes by no more than its argument, so this is as good as the centre.
    const Rotation<T> axes = rotation(turn);
    const BoxView<T> view = view_box(-axes.to_local(c), box.half);
    const Lanes<T> radius = ra + box.rounding;
    const Lanes<T> scale = taxicab(c) + taxicab(box.half) + radius + doubt(turn);
    const Lanes<T> distance = view.distance - radius;
    const Lanes<T> bound = scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
    if constexpr (L == kBoolean) {
      return answer_sign(job, block, distance, bound, scale);
    } else {
      const LaneMask<T> unique = view.lead > scale * Lanes<T>(kShortest<T>);
      const CertifiedLanes<T> answer{distance, bound, axes.to_world(view.towards),
                                     certified_lanes(distance, bound, scale, unique)};
      const Lanes<T> zero(T(0));
      const Vec3<T> foot{zero, zero, zero};
      write_certified<L>(job, block, answer, foot, ra);
      if constexpr (L == kManifold) {
        write_contacts(
            job, block,
            {witness_contact(job, block, answer, foot, ra, zero, box_feature(view.towards))});
      }
      return ~answer.certified;
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_box_kernels) =
    WINNOW_ISA_NAME::narrow_kernels_of<WINNOW_ISA_NAME::round::SphereBox>();

}  // namespace winnow
