// The kernels of spheres with cylinders and cones: the distance of a point from a rectangle or
// triangle, in the plane of the point and the axis.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/round.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// The signed distance of a point from a solid of revolution; the point is `away` >= 0 from its
/// axis and z along it.
template <typename T>
struct MeridianView {
  /// Negative inside.
  Lanes<T> distance;
  /// Unit, towards the solid (if inside: away from the nearest surface point): the components away
  /// from the axis and along it.
  Lanes<T> radial;
  Lanes<T> axial;
  /// The direction is unique if this is above zero. Outside, the distance; inside, it is small if
  /// another part of the surface is nearly as near as the nearest one.
  Lanes<T> lead;
};

struct CylinderMeridian {
  static const CylinderShape* table(const NarrowJob& job) { return job.tables->cylinders; }

  template <typename T>
  [[gnu::always_inline]] static MeridianView<T> view(const RevolvedLanes<T>& s,
                                                     const Lanes<T>& away, const Lanes<T>& z) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    const Lanes<T> side = away - s.radius;
    const Lanes<T> cap = abs(z) - s.half_length;
    const Lanes<T> x = max(side, zero);
    const Lanes<T> y = max(cap, zero);
    const Lanes<T> length = sqrt(x * x + y * y);
    const Lanes<T> best = max(side, cap);
    const LaneMask<T> outside = best > zero;
    const LaneMask<T> is_cap = cap >= side;
    const Lanes<T> down = -sign_or_one(z);
    const Lanes<T> beside = select(is_cap, abs(z), away);
    return {select(outside, length, best), select(outside, -x / length, select(is_cap, zero, -one)),
            select(outside, down * y / length, select(is_cap, down, zero)),
            select(outside, length, min(abs(side - cap), beside))};
  }
};

struct ConeMeridian {
  static const ConeShape* table(const NarrowJob& job) { return job.tables->cones; }

  template <typename T>
  [[gnu::always_inline]] static MeridianView<T> view(const RevolvedLanes<T>& s,
                                                     const Lanes<T>& away, const Lanes<T>& z) {
    const Lanes<T> zero(T(0));
    const Lanes<T> one(T(1));
    const Lanes<T> rise = s.half_length + s.half_length;
    const Lanes<T> length = sqrt(s.radius * s.radius + rise * rise);
    // A cone of size zero is treated like a segment.
    const LaneMask<T> is_point = length <= zero;
    const Lanes<T> out_x = select(is_point, one, rise / length);
    const Lanes<T> out_z = select(is_point, zero, s.radius / length);
    // Relative to the rim.
    const Lanes<T> x = away - s.radius;
    const Lanes<T> y = z + s.half_length;
    const Lanes<T> side = x * out_x + y * out_z;
    const Lanes<T> base = -y;
    // The nearest points of the side and of the base.
    const Lanes<T> along = clamp(y * out_x - x * out_z, zero, length);
    const Lanes<T> side_x = -along * out_z - x;
    const Lanes<T> side_z = along * out_x - y;
    const Lanes<T> base_x = min(-x, zero);
    const Lanes<T> side_square = side_x * side_x + side_z * side_z;
    const Lanes<T> base_square = base_x * base_x + base * base;
    const LaneMask<T> nearer = base_square < side_square;
    const Lanes<T> w_x = select(nearer, base_x, side_x);
    const Lanes<T> w_z = select(nearer, base, side_z);
    const Lanes<T> gap = sqrt(min(side_square, base_square));
    // Points beyond the tip or the rim are outside, also if the cone is a segment or a disc.
    const LaneMask<T> outside = (side > zero) | (base > zero) | (y > rise) | (x > zero);
    const LaneMask<T> is_base = base >= side;
    return {select(outside, gap, max(side, base)),
            select(outside, w_x / gap, select(is_base, zero, -out_x)),
            select(outside, w_z / gap, select(is_base, one, -out_z)),
            select(outside, gap, min(abs(side - base), select(is_base, abs(side - base), away)))};
  }
};

template <typename Meridian>
struct SphereRevolved {
  /// Not inlined: all levels share it.
  template <typename T>
  [[gnu::noinline]] static BallSolution<T> solve(const NarrowJob& job, const PairBlock<T>& block) {
    const Lanes<T> zero(T(0));
    const Vec3<T> c = load_offset(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const Lanes<T> ra = load_sphere<SideA>(job, block);
    const RevolvedLanes<T> shape = load_revolved<SideB, T>(job, block, Meridian::table(job));
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> p = -axes.to_local(c);
    const Lanes<T> away = sqrt(p.x * p.x + p.y * p.y);
    const MeridianView<T> view = Meridian::view(shape, away, p.z);
    const Lanes<T> radius = ra + shape.rounding;
    const Lanes<T> scale = norm_l1(c) + shape.radius + shape.half_length + radius + doubt(turn);
    // A point on the axis has no radial direction; `unique` excludes the cases that need one.
    const Lanes<T> over = select(away > zero, view.radial / away, zero);
    return {view.distance - radius,
            scale * Lanes<T>(T(kRoundings) * kEpsilon<T>),
            scale,
            axes.to_world(Vec3<T>{p.x * over, p.y * over, view.axial}),
            view.lead > scale * Lanes<T>(T(kShortest)),
            ra,
            zero};
  }

  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    return answer_ball<L>(job, block, solve(job, block));
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_cylinder_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::SphereRevolved<WINNOW_ISA_NAME::round::CylinderMeridian>>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_cone_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::SphereRevolved<WINNOW_ISA_NAME::round::ConeMeridian>>();

}  // namespace winnow
