#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The closest point of the triangle to the origin.
template <typename T>
[[gnu::always_inline]] inline NearestCandidate<T> nearest_point(const TriangleView<T>& b) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Vec3<T> origin{zero, zero, zero};
  NearestCandidate<T> nearest{origin, Lanes<T>(T(__builtin_inff())), zero, zero};
  for (int i = 0; i < 3; ++i) {
    const Lanes<T> place = -dot(b.vertex[i], b.edge[i]) / b.square[i];
    const Lanes<T> t = clamp(select(b.square[i] > zero, place, zero), zero, one);
    const Vec3<T> w = b.vertex[i] + b.edge[i] * t;
    nearer(nearest, w.x == w.x, w, zero, edge_feature(t, i));
  }
  nearer_in_face(nearest, b, origin, zero);
  return nearest;
}

/// Tests two axes and returns the axis with the larger separation of origin and triangle. One is
/// the triangle's normal, if the triangle has one. The other, only in the lanes `is_away`, is the
/// direction to the closest point `w`.
template <typename T>
[[gnu::always_inline]] inline AxisGap<T> widest_gap(const TriangleView<T>& b, const Vec3<T>& w,
                                                    const Lanes<T>& length,
                                                    const LaneMask<T>& is_away) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Vec3<T> n = w * (one / length);
  const Lanes<T> along = min(min(dot(b.vertex[0], n), dot(b.vertex[1], n)), dot(b.vertex[2], n));
  AxisGap<T> gap{select(is_away, along, Lanes<T>(T(-1e30F))), n};
  const AxisGap<T> flat = gap_along(b, b.normal * (one / sqrt(b.normal_square)), zero);
  widen(gap, has_normal(b), flat.distance, flat.normal);
  return gap;
}

template <typename T>
struct SphereTriangleSolution {
  ProofLanes<T> proof;
  /// In world axes.
  Vec3<T> normal;
  Lanes<T> radius;
  Lanes<T> feature;
};

/// Not inlined: all levels share it, and it takes long to compile.
template <typename T>
[[gnu::noinline]] SphereTriangleSolution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
  const Vec3<T> c = load_offset(job, block);
  const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
  const Lanes<T> ra = load_sphere<SideA>(job, block);
  const TriangleLanes<T> triangle = load_triangle<SideB>(job, block);

  const Rotation<T> axes = rotation(turn);
  const TriangleView<T> view = view_triangle(triangle, axes.to_local(c));
  const NearestCandidate<T> nearest = nearest_point(view);
  const Lanes<T> length = sqrt(nearest.square);
  const Lanes<T> radius = ra + triangle.rounding;
  const Lanes<T> scale = norm_l1(c) + largest(triangle) + radius + doubt(turn);
  // If the sphere's center is on the triangle, up to rounding, the normal is the triangle's.
  const LaneMask<T> is_away = length > scale * Lanes<T>(T(kRoundings) * kEpsilon<T>);
  const AxisGap<T> gap = widest_gap(view, nearest.w, length, is_away);
  const LaneMask<T> unique =
      (length > scale * Lanes<T>(T(kShortest))) | ((!is_away) & has_normal(view));
  return {{gap.distance - radius, length - radius, scale, unique},
          axes.to_world(gap.normal),
          ra,
          nearest.feature};
}

struct SphereTriangle {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const SphereTriangleSolution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_proven_sign(job, block, r.proof);
    } else {
      return write_ball<L>(job, block, answer_proven(r.proof, r.normal), r.radius, r.feature);
    }
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_triangle_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereTriangle>();

}  // namespace winnow
