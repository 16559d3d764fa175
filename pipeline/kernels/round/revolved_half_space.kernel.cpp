// Half-spaces against cylinders and cones. Levels boolean and distance use the lowest point. Level
// manifold uses four points on the rim of a cap that faces the plane, or the two ends of the lowest
// line of the side.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/half_space_common.wide.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// Number of rim corners in a quarter turn.
constexpr int kQuarter = kRimCorners / 4;

/// A cylinder or cone over a plane.
template <typename T>
struct RevolvedOverPlane {
  PlacedPlane<T> plane;
  Rotation<T> axes;
  RevolvedLanes<T> shape;
  Lanes<T> scale;
  /// Normal of the plane in the frame of the shape; its components along and across the shape's
  /// axis.
  Vec3<T> normal;
  Lanes<T> along;
  Lanes<T> across;
  /// The radius vector that points down most, in world axes.
  Vec3<T> down;
  Vec3<T> half;
};

template <typename T, typename Shape>
[[gnu::always_inline]] inline RevolvedOverPlane<T> place_revolved(const NarrowJob& job,
                                                                  const PairBlock<T>& block,
                                                                  const Shape* table) {
  const Lanes<T> zero(T(0));
  RevolvedOverPlane<T> r;
  r.plane = load_plane<SideB>(job, block);
  const ScaledQuaternion<T> turn = load_turn<SideA>(job, block);
  r.shape = load_revolved<SideA, T>(job, block, table);
  r.axes = rotation(turn);
  const Vec3<T> n = r.axes.to_local(r.plane.normal);
  r.normal = n;
  r.along = n.z;
  r.across = sqrt(n.x * n.x + n.y * n.y);
  const LaneMask<T> has_side = r.across > Lanes<T>(T(kAlongAxis));
  const Lanes<T> over = r.shape.radius / r.across;
  const Lanes<T> x = select(has_side, -n.x * over, r.shape.radius);
  const Lanes<T> y = select(has_side, -n.y * over, zero);
  r.down = r.axes.to_world(Vec3<T>{x, y, zero});
  r.half = r.axes.z * r.shape.half_length;
  r.scale = r.plane.scale + r.shape.radius + r.shape.half_length + r.shape.rounding + doubt(turn);
  return r;
}

/// Sets four corners of the rim of a cap, the lowest first and its opposite last. The corners are
/// fixed in the shape; but if the first one is higher than the lowest point of the rim by more than
/// 2 kTiedDepth radii, that point replaces it.
template <typename T>
[[gnu::always_inline]] inline void set_cap(LowestPoints<T, 4>& feet, const RevolvedOverPlane<T>& s,
                                           const Vec3<T>& middle, const Lanes<T>& rise,
                                           const Lanes<T>& name) {
  const Lanes<T> zero(T(0));
  const Lanes<T> slope[2] = {s.normal.x * s.shape.radius, s.normal.y * s.shape.radius};
  const Vec3<T> on_x = s.axes.x * (s.shape.radius * -sign_or_one(s.normal.x));
  const Vec3<T> on_y = s.axes.y * (s.shape.radius * -sign_or_one(s.normal.y));
  const Lanes<T> name_x = select(s.normal.x >= zero, Lanes<T>(T(2 * kQuarter)), zero);
  const Lanes<T> name_y =
      select(s.normal.y >= zero, Lanes<T>(T(3 * kQuarter)), Lanes<T>(T(kQuarter)));
  const LaneMask<T> x_first = abs(slope[0]) >= abs(slope[1]);
  const Vec3<T> low = select(x_first, on_x, on_y);
  const Vec3<T> next = select(x_first, on_y, on_x);
  const Lanes<T> low_name = select(x_first, name_x, name_y);
  const Lanes<T> next_name = select(x_first, name_y, name_x);
  // The name of a corner is its number on the rim. Opposite corners are at 0 and 2 quarter turns,
  // or at 1 and 3, so the sum of their names is 2 kQuarter or 4 kQuarter.
  const Lanes<T> across[2] = {Lanes<T>(T(2 * kQuarter)), Lanes<T>(T(4 * kQuarter))};
  const Lanes<T> low_across = select(x_first, across[0], across[1]) - low_name;
  const Lanes<T> next_across = select(x_first, across[1], across[0]) - next_name;
  const Lanes<T> drop[2] = {max(abs(slope[0]), abs(slope[1])), min(abs(slope[0]), abs(slope[1]))};
  const Lanes<T> most = s.shape.radius * s.across;
  const LaneMask<T> is_tied = most - drop[0] <= s.shape.radius * Lanes<T>(T(2.0 * kTiedDepth));
  const Lanes<T> height = s.plane.height + rise;
  feet.foot[0] = middle + select(is_tied, low, s.down);
  feet.foot[1] = middle + next;
  feet.foot[2] = middle - next;
  feet.foot[3] = middle - low;
  feet.height[0] = height - most;
  feet.height[1] = height - drop[1];
  feet.height[2] = height + drop[1];
  feet.height[3] = height + drop[0];
  feet.feature[0] = name + low_name;
  feet.feature[1] = name + next_name;
  feet.feature[2] = name + next_across;
  feet.feature[3] = name + low_across;
  feet.rounding = s.shape.rounding;
  feet.normal = s.plane.normal;
  feet.scale = s.scale;
}

/// In lanes in which `side` is set, replaces feet 0 and 1 by the given ones, of which foot 0 is the
/// lower one, and removes feet 2 and 3.
template <typename T>
[[gnu::always_inline]] inline void set_side(LowestPoints<T, 4>& feet, const LaneMask<T>& side,
                                            const Vec3<T> (&foot)[2], const Lanes<T> (&height)[2],
                                            const Lanes<T> (&name)[2]) {
  for (int i = 0; i < 2; ++i) {
    feet.foot[i] = select(side, foot[i], feet.foot[i]);
    feet.height[i] = select(side, height[i], feet.height[i]);
    feet.feature[i] = select(side, name[i], feet.feature[i]);
    feet.height[2 + i] = select(side, Lanes<T>(kLargest<T>), feet.height[2 + i]);
  }
}

struct CylinderLowestPoints {
  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 4> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cylinders);
    const Lanes<T> zero(T(0));
    const LaneMask<T> upper = s.along < zero;
    const Vec3<T> low = select(upper, s.half, -s.half);
    const Lanes<T> rise = s.shape.half_length * abs(s.along);
    LowestPoints<T, 4> feet;
    set_cap(feet, s, low, -rise, select(upper, zero, Lanes<T>(T{kRimCorners})));
    const LaneMask<T> side = abs(s.along) <= Lanes<T>(T(kCapCosine));
    const Lanes<T> top(T{kSideLine});
    const Lanes<T> end(T{kSideLine + 1});
    set_side(feet, side, {s.down + low, s.down - low},
             {least_height(s), s.plane.height + rise - s.shape.radius * s.across},
             {select(upper, top, end), select(upper, end, top)});
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> lowest(const NarrowJob& job,
                                                     const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cylinders);
    const Vec3<T> low = s.half * -sign_or_one(s.along);
    return {{low + s.down}, {least_height(s)}, {}, s.shape.rounding, s.plane.normal, s.scale};
  }

  template <typename T>
  [[gnu::noinline]] static LowestHeight<T> least(const NarrowJob& job, const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cylinders);
    return {least_height(s), s.shape.rounding, s.scale};
  }

 private:
  template <typename T>
  [[gnu::always_inline]] static Lanes<T> least_height(const RevolvedOverPlane<T>& s) {
    return s.plane.height - s.shape.half_length * abs(s.along) - s.shape.radius * s.across;
  }
};

struct ConeLowestPoints {
  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 4> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cones);
    const Lanes<T> rise = s.shape.half_length * s.along;
    LowestPoints<T, 4> feet;
    set_cap(feet, s, -s.half, -rise, Lanes<T>(T{kRimCorners}));
    const Lanes<T> tip = tip_of(s);
    const Lanes<T> rim = rim_of(s);
    const LaneMask<T> side = s.along <= Lanes<T>(T(kCapCosine));
    const LaneMask<T> tip_first = tip <= rim;
    const Vec3<T> foot = s.down - s.half;
    const Lanes<T> top(T{kSideLine});
    const Lanes<T> end(T{kSideLine + 1});
    // A cone whose axis is vertical, with the tip below, touches with the tip only.
    const LaneMask<T> on_tip = tip_first & (s.across <= Lanes<T>(T(kAlongAxis)));
    const Lanes<T> second = select(on_tip, Lanes<T>(kLargest<T>), max(tip, rim));
    set_side(feet, side, {select(tip_first, s.half, foot), select(tip_first, foot, s.half)},
             {min(tip, rim), second}, {select(tip_first, top, end), select(tip_first, end, top)});
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> lowest(const NarrowJob& job,
                                                     const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cones);
    const Lanes<T> tip = tip_of(s);
    const Lanes<T> rim = rim_of(s);
    return {{select(tip <= rim, s.half, s.down - s.half)},
            {min(tip, rim)},
            {},
            s.shape.rounding,
            s.plane.normal,
            s.scale};
  }

  template <typename T>
  [[gnu::noinline]] static LowestHeight<T> least(const NarrowJob& job, const PairBlock<T>& block) {
    const RevolvedOverPlane<T> s = place_revolved(job, block, job.tables->cones);
    return {min(tip_of(s), rim_of(s)), s.shape.rounding, s.scale};
  }

 private:
  // Heights of the tip and of the rim.
  template <typename T>
  [[gnu::always_inline]] static Lanes<T> tip_of(const RevolvedOverPlane<T>& s) {
    return s.plane.height + s.shape.half_length * s.along;
  }
  template <typename T>
  [[gnu::always_inline]] static Lanes<T> rim_of(const RevolvedOverPlane<T>& s) {
    return s.plane.height - s.shape.half_length * s.along - s.shape.radius * s.across;
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(cylinder_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::CylinderLowestPoints, 4>>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(cone_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::ConeLowestPoints, 4>>();

}  // namespace winnow
