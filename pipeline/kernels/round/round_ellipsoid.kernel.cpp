// Ellipsoids against spheres and half-spaces: how far a point or a plane is from one.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/over_plane.wide.h"

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

template <typename T>
[[gnu::always_inline]] inline Vec3<T> times(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// An ellipsoid as far as it goes along a direction.
template <typename T>
struct Reach {
  Lanes<T> height;
  Vec3<T> point;
};

template <typename T>
[[gnu::always_inline]] inline Reach<T> reach_of(const Vec3<T>& radius, const Vec3<T>& direction) {
  const Vec3<T> stretched = times(radius, direction);
  const Lanes<T> height = sqrt(dot(stretched, stretched));
  const Lanes<T> least(sizeof(T) == sizeof(double) ? T(1e-150) : T(1e-18F));
  return {height, times(radius, stretched) * (Lanes<T>(T(1)) / max(height, least))};
}

/// A point seen from an ellipsoid, in its frame and, by its symmetry, where no coordinate is
/// negative. The way out of, or to, the surface is along q_i / (s + e_i), where e_i are the squares
/// of the radii less that of the least, and s is the largest at which the r_i q_i / (s + e_i) are a
/// unit vector (Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid",
/// 2013). Its length's inverse is nearly straight in s, and Newton's method goes up to the root (as
/// Moré and Sorensen, "Computing a trust region step", 1983).
template <typename T>
struct SurfaceView {
  /// Unit.
  Vec3<T> outward;
  /// Signed, between these.
  Lanes<T> low;
  Lanes<T> high;
};

template <typename T>
[[gnu::always_inline]] inline SurfaceView<T> view_surface(const Vec3<T>& radius, const Vec3<T>& q) {
  constexpr int steps = sizeof(T) == sizeof(double) ? 8 : 6;
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> thin = min(min(radius.x, radius.y), radius.z);
  const auto square_beyond = [&](const Lanes<T>& r) { return (r - thin) * (r + thin); };
  const Vec3<T> excess{square_beyond(radius.x), square_beyond(radius.y), square_beyond(radius.z)};
  const Vec3<T> weight = times(radius, q);
  const auto of_least = [&](const Lanes<T>& w, const Lanes<T>& e) {
    return select(e > zero, zero, w * w);
  };
  // Never 0, which has no inverse: beside a flat ellipsoid this is as good.
  const Lanes<T> most = max(max(radius.x, radius.y), radius.z);
  const Lanes<T> hardly =
      most * most * Lanes<T>(sizeof(T) == sizeof(double) ? T(1e-30) : T(1e-12F));
  Lanes<T> s = max(sqrt(of_least(weight.x, excess.x) + of_least(weight.y, excess.y) +
                        of_least(weight.z, excess.z)),
                   hardly);
  const auto inverse = [&] {
    return Vec3<T>{one / (s + excess.x), one / (s + excess.y), one / (s + excess.z)};
  };
  Vec3<T> over = inverse();
  for (int i = 0; i < steps; ++i) {
    const Vec3<T> share = times(weight, over);
    const Lanes<T> square = dot(share, share);
    const Lanes<T> bend = dot(times(share, share), over);
    s = s + max((sqrt(square) - one) * square / bend, zero);
    over = inverse();
  }
  const Vec3<T> way = times(q, over);
  const Vec3<T> outward = way * (one / sqrt(dot(way, way)));
  const Vec3<T> share = times(weight, over);
  const Lanes<T> within = one / max(sqrt(dot(share, share)), one);
  const Vec3<T> gap = q - times(radius, share) * within;
  // Any t above -thin^2 bounds the squared distance to the surface (Lagrange's dual function).
  // Where it is not above zero, the point is hardly inside or has no s: nothing is known.
  const Lanes<T> t = s - thin * thin;
  const Lanes<T> least = t * (dot(times(q, q), over) - one);
  const Lanes<T> unknown(T(__builtin_nan("")));
  const Lanes<T> inside = select(least > zero, -sqrt(max(least, zero)), unknown);
  const Lanes<T> low = dot(outward, q) - reach_of(radius, outward).height;
  return {outward, low, select(t > zero, sqrt(dot(gap, gap)), inside)};
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
    const Turn<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const EllipsoidLanes<T> shape = load_ellipsoid(job, block);
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> p = -axes.to_local(c);
    const SurfaceView<T> view = view_surface(shape.radius, {abs(p.x), abs(p.y), abs(p.z)});
    const Vec3<T> sign{sign_or_one(p.x), sign_or_one(p.y), sign_or_one(p.z)};
    const Lanes<T> rounding = ra + shape.rounding;
    const Lanes<T> scale = taxicab(c) + taxicab(shape.radius) + rounding + doubt(turn);
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
    /// Under the ellipsoid's lowest point, on the plane.
    Vec3<T> foot;
  };

  /// Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static Solution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const Plane<T> plane = load_plane<SideA>(job, block);
    const Turn<T> turn = load_turn<SideB>(job, block);
    const EllipsoidLanes<T> shape = load_ellipsoid(job, block);
    const Rotation<T> axes = rotation(turn);
    const Reach<T> reach = reach_of(shape.radius, axes.to_local(-plane.normal));
    const Lanes<T> height = plane.height - reach.height;
    const Lanes<T> scale = plane.scale + taxicab(shape.radius) + shape.rounding + doubt(turn);
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
