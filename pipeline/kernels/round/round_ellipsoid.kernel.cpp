// The kernels of ellipsoids with spheres and half-spaces.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/ellipsoid_surface.wide.h"
#include "pipeline/kernels/round/half_space_common.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

template <typename T>
struct EllipsoidLanes {
  Vec3<T> radius;
  Lanes<T> rounding;
};

template <typename T>
[[gnu::always_inline]] inline EllipsoidLanes<T> load_ellipsoid(const NarrowJob& job,
                                                               const PairBlock<T>& block) {
  Lanes<T> r[4];
  load_shapes<SideB>(job, block, job.tables->ellipsoids, r);
  return {{r[0], r[1], r[2]}, r[3]};
}

struct SphereEllipsoid {
  template <typename T>
  struct Solution {
    ProofLanes<T> proof;
    Vec3<T> normal;
    Lanes<T> radius;
  };

  /// Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static Solution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const Vec3<T> c = load_offset(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const EllipsoidLanes<T> shape = load_ellipsoid(job, block);
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> p = -axes.to_local(c);
    const SurfaceView<T> view = view_surface(shape.radius, {abs(p.x), abs(p.y), abs(p.z)});
    const Vec3<T> sign{sign_or_one(p.x), sign_or_one(p.y), sign_or_one(p.z)};
    const Lanes<T> rounding = ra + shape.rounding;
    const Lanes<T> scale = norm_l1(c) + norm_l1(shape.radius) + rounding + doubt(turn);
    const Lanes<T> length = dot(view.outward, view.outward);
    return {{view.low - rounding, view.high - rounding, scale, length > Lanes<T>(T(0.5))},
            -axes.to_world(times(sign, view.outward)),
            ra};
  }

  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Solution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_proven_sign(job, block, r.proof);
    } else {
      return write_ball<L>(job, block, answer_proven(r.proof, r.normal), r.radius, Lanes<T>(T(0)));
    }
  }
};

struct HalfSpaceEllipsoid {
  template <typename T>
  struct Solution {
    Lanes<T> distance;
    Lanes<T> bound;
    Lanes<T> scale;
    Vec3<T> normal;
    /// The point of the plane under the ellipsoid's lowest point.
    Vec3<T> foot;
  };

  /// Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static Solution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const PlacedPlane<T> plane = load_plane<SideA>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const EllipsoidLanes<T> shape = load_ellipsoid(job, block);
    const Rotation<T> axes = rotation(turn);
    const EllipsoidSupport<T> reach = reach_of(shape.radius, axes.to_local(-plane.normal));
    const Lanes<T> height = plane.height - reach.height;
    const Lanes<T> scale = plane.scale + norm_l1(shape.radius) + shape.rounding + doubt(turn);
    return {height - shape.rounding, scale * Lanes<T>(T(kRoundings) * kEpsilon<T>), scale,
            plane.normal, plane.to_b + axes.to_world(reach.point) - plane.normal * height};
  }

  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Solution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_sign(job, block, r.distance, r.bound, r.scale);
    } else {
      const Lanes<T> zero(T(0));
      const CertifiedLanes<T> answer = answer_along(r.normal, r.distance, r.bound, r.scale);
      return write_touch<L>(job, block, answer, r.foot, zero, zero);
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_ellipsoid_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereEllipsoid>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(half_space_ellipsoid_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::HalfSpaceEllipsoid>();

}  // namespace winnow
