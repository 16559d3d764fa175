// The kernels of tapered capsules with spheres and half-spaces. The nearest feature is one of the
// two balls, or the conical side between them.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/half_space_common.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

template <typename T>
struct TaperLanes {
  /// At z = -half_length and z = half_length.
  Lanes<T> radius[2];
  Lanes<T> half_length;
};

template <typename T>
[[gnu::always_inline]] inline TaperLanes<T> load_taper(const NarrowJob& job,
                                                       const PairBlock<T>& block) {
  Lanes<T> r[3];
  load_shapes<SideB>(job, block, job.tables->tapered_capsules, r);
  return {{r[0], r[1]}, r[2]};
}

/// The features of the lower and the upper ball; the feature of the side is 0.
template <typename T>
inline constexpr T kBallFeatures[2] = {T(2), T(1)};

struct SphereTaper {
  /// In the plane of the point and the axis, a tangent touches both balls; `sine` is the sine of
  /// its angle with the axis. Points that do not project between its two points of contact are
  /// nearest to a ball. Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static BallSolution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    const Vec3<T> c = load_offset(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const TaperLanes<T> shape = load_taper(job, block);
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> p = -axes.to_local(c);
    const Lanes<T> away = sqrt(p.x * p.x + p.y * p.y);
    const Lanes<T> rise = shape.radius[0] - shape.radius[1];
    const Lanes<T> length = shape.half_length + shape.half_length;
    const LaneMask<T> is_ball = abs(rise) >= length;
    const Lanes<T> sine = select(is_ball, zero, rise / length);
    const Lanes<T> cosine = sqrt((one - sine) * (one + sine));
    const Lanes<T> over_low = p.z + shape.half_length;
    const Lanes<T> along = cosine * over_low - sine * away;
    const LaneMask<T> low = select(is_ball, rise, -along) >= zero;
    const LaneMask<T> side = (!(is_ball | low)) & (along < cosine * length);

    const Lanes<T> over = select(low, over_low, p.z - shape.half_length);
    const Lanes<T> from_ball = sqrt(away * away + over * over);
    const Lanes<T> to_ball = from_ball - select(low, shape.radius[0], shape.radius[1]);
    const Lanes<T> to_side = cosine * away + sine * over_low - shape.radius[0];
    const Lanes<T> radial = select(side, cosine, away / from_ball);
    const Lanes<T> axial = select(side, sine, over / from_ball);
    // A point on the axis has no radial direction; `unique` excludes the cases that need one.
    const Lanes<T> outward = select(away > zero, radial / away, zero);
    const Lanes<T> scale =
        norm_l1(c) + length + max(shape.radius[0], shape.radius[1]) + ra + doubt(turn);
    return {select(side, to_side, to_ball) - ra,
            scale * Lanes<T>(T(kRoundings) * kEpsilon<T>),
            scale,
            -axes.to_world(Vec3<T>{p.x * outward, p.y * outward, axial}),
            select(side, away, from_ball) > scale * Lanes<T>(T(kShortest)),
            ra,
            select(side, zero,
                   select(low, Lanes<T>(kBallFeatures<T>[0]), Lanes<T>(kBallFeatures<T>[1])))};
  }

  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    return answer_ball<L>(job, block, solve(job, block));
  }
};

struct HalfSpaceTaper {
  /// Both balls over the plane, the one with the smaller distance first.
  template <typename T>
  struct Solution {
    Lanes<T> distance[2];
    /// The centers of the balls, projected onto the plane.
    Vec3<T> foot[2];
    Lanes<T> feature[2];
    /// False if one ball is inside the other, so that only one ball is part of the surface.
    LaneMask<T> has_second;
    Lanes<T> bound;
    Lanes<T> scale;
    Vec3<T> normal;
  };

  /// Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static Solution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const PlacedPlane<T> plane = load_plane<SideA>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const TaperLanes<T> shape = load_taper(job, block);
    const Vec3<T>& c = plane.to_b;
    const Vec3<T>& normal = plane.normal;
    const Vec3<T> half = axis_z(turn) * shape.half_length;
    const Lanes<T>& height = plane.height;
    const Lanes<T> up = dot(normal, half);
    const Lanes<T> distance[2] = {height - up - shape.radius[0], height + up - shape.radius[1]};
    const LaneMask<T> low = distance[0] <= distance[1];
    const Vec3<T> foot[2] = {c - half - normal * (height - up), c + half - normal * (height + up)};
    const Lanes<T> name[2] = {Lanes<T>(kBallFeatures<T>[0]), Lanes<T>(kBallFeatures<T>[1])};
    const Lanes<T> rise = abs(shape.radius[0] - shape.radius[1]);
    const Lanes<T> scale =
        plane.scale + shape.half_length + max(shape.radius[0], shape.radius[1]) + doubt(turn);
    return {{min(distance[0], distance[1]), max(distance[0], distance[1])},
            {select(low, foot[0], foot[1]), select(low, foot[1], foot[0])},
            {select(low, name[0], name[1]), select(low, name[1], name[0])},
            rise < shape.half_length + shape.half_length,
            scale * Lanes<T>(T(kRoundings) * kEpsilon<T>),
            scale,
            normal};
  }

  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    const Solution<T> r = solve(job, block);
    if constexpr (L == kBoolean) {
      return answer_sign(job, block, r.distance[0], r.bound, r.scale);
    } else {
      const CertifiedLanes<T> answer = answer_along(r.normal, r.distance[0], r.bound, r.scale);
      write_certified<L>(job, block, answer, r.foot[0], Lanes<T>(T(0)));
      if constexpr (L == kManifold) write_point_contacts(job, block, r, answer);
      return ~answer.certified;
    }
  }

  template <typename T>
  [[gnu::always_inline]] static void write_point_contacts(NarrowJob& job, const PairBlock<T>& block,
                                                          const Solution<T>& r,
                                                          const CertifiedLanes<T>& answer) {
    const Lanes<T> zero(T(0));
    CertifiedLanes<T> second = answer;
    second.distance = r.distance[1];
    ContactLanes<T> contacts[2] = {
        witness_contact(job, block, answer, r.foot[0], zero, zero, r.feature[0]),
        witness_contact(job, block, second, r.foot[1], zero, zero, r.feature[1])};
    contacts[1].lanes &= bits(r.has_second);
    write_contacts(job, block, contacts);
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_tapered_capsule_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::SphereTaper>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(half_space_tapered_capsule_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::HalfSpaceTaper>();

}  // namespace winnow
