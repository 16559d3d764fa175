// The kernels of half-spaces with spheres, capsules, boxes and triangles. They compute the heights
// of the cores' vertices over the plane; half_space_common.wide.h turns the heights into answers.

#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/half_space_common.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

struct SphereLowestPoints {
  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    const PlacedPlane<T> plane = load_plane<SideB>(job, block);
    const Lanes<T> radius = load_sphere<SideA>(job, block);
    const Lanes<T> zero(T(0));
    return {{{zero, zero, zero}}, {plane.height},      {zero}, radius,
            plane.normal,         plane.scale + radius};
  }
};

template <typename T>
struct CapsuleOverPlane {
  PlacedPlane<T> plane;
  Lanes<T> radius;
  /// From the middle to the upper end of the core, and its component along the normal.
  Vec3<T> arm;
  Lanes<T> rise;
  Lanes<T> scale;

  [[gnu::always_inline]] CapsuleOverPlane(const NarrowJob& job, const PairBlock<T>& block) {
    plane = load_plane<SideB>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideA>(job, block);
    const CapsuleLanes<T> a = load_capsule<SideA>(job, block);
    radius = a.radius;
    arm = axis_z(turn) * a.half_length;
    rise = dot(plane.normal, arm);
    scale = plane.scale + a.radius + a.half_length + doubt(turn);
  }
};

struct CapsuleLowestPoints {
  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 2> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    const CapsuleOverPlane<T> a(job, block);
    LowestPoints<T, 2> feet{{a.arm, -a.arm},
                            {a.plane.height + a.rise, a.plane.height - a.rise},
                            {Lanes<T>(T(1)), Lanes<T>(T(2))},
                            a.radius,
                            a.plane.normal,
                            a.scale};
    sort_two(feet, 0, 1);
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> lowest(const NarrowJob& job,
                                                     const PairBlock<T>& block) {
    const CapsuleOverPlane<T> a(job, block);
    return {{a.arm * sign_or_one(-a.rise)},
            {a.plane.height - abs(a.rise)},
            {},
            a.radius,
            a.plane.normal,
            a.scale};
  }

  template <typename T>
  [[gnu::noinline]] static LowestHeight<T> least(const NarrowJob& job, const PairBlock<T>& block) {
    const CapsuleOverPlane<T> a(job, block);
    return {a.plane.height - abs(a.rise), a.radius, a.scale};
  }
};

struct TriangleLowestPoints {
  /// Feet in the order of the vertices, not sorted by height.
  template <typename T>
  [[gnu::always_inline]] static LowestPoints<T, 3> in_order(const NarrowJob& job,
                                                            const PairBlock<T>& block) {
    const PlacedPlane<T> plane = load_plane<SideB>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideA>(job, block);
    const TriangleLanes<T> a = load_triangle<SideA>(job, block);
    const Rotation<T> axes = rotation(turn);
    LowestPoints<T, 3> feet;
    Lanes<T> reach(T(0));
    for (int i = 0; i < 3; ++i) {
      feet.foot[i] = axes.to_world(a.vertex[i]);
      feet.height[i] = plane.height + dot(plane.normal, feet.foot[i]);
      feet.feature[i] = Lanes<T>(T(1 + i));
      reach = max(reach, norm_l1(a.vertex[i]));
    }
    feet.rounding = a.rounding;
    feet.normal = plane.normal;
    feet.scale = plane.scale + a.rounding + reach + doubt(turn);
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 3> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    LowestPoints<T, 3> feet = in_order(job, block);
    sort_two(feet, 0, 1);
    sort_two(feet, 1, 2);
    sort_two(feet, 0, 1);
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> lowest(const NarrowJob& job,
                                                     const PairBlock<T>& block) {
    const LowestPoints<T, 3> all = in_order(job, block);
    Vec3<T> foot = all.foot[0];
    Lanes<T> height = all.height[0];
    for (int i = 1; i < 3; ++i) {
      const LaneMask<T> lower = all.height[i] < height;
      foot = select(lower, all.foot[i], foot);
      height = min(all.height[i], height);
    }
    return {{foot}, {height}, {}, all.rounding, all.normal, all.scale};
  }

  template <typename T>
  [[gnu::noinline]] static LowestHeight<T> least(const NarrowJob& job, const PairBlock<T>& block) {
    const LowestPoints<T, 3> all = in_order(job, block);
    return {min(min(all.height[0], all.height[1]), all.height[2]), all.rounding, all.scale};
  }
};

/// A box over a plane, given by its half axes.
template <typename T>
struct BoxOverPlane {
  PlacedPlane<T> plane;
  Lanes<T> cosine[3];       // of the axes with the normal
  LaneMask<T> negative[3];  // half axes that are reversed so that they point down
  Vec3<T> down[3];
  Lanes<T> rise[3];  // of a half axis from its lower end to the middle
  Lanes<T> rounding;
  Lanes<T> scale;

  [[gnu::always_inline]] BoxOverPlane(const NarrowJob& job, const PairBlock<T>& block) {
    plane = load_plane<SideB>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideA>(job, block);
    const BoxLanes<T> a = load_box<SideA>(job, block);
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> arm[3] = {axes.x * a.half.x, axes.y * a.half.y, axes.z * a.half.z};
    const Vec3<T> local = axes.to_local(plane.normal);
    cosine[0] = local.x;
    cosine[1] = local.y;
    cosine[2] = local.z;
    const Lanes<T> half[3] = {a.half.x, a.half.y, a.half.z};
    for (int i = 0; i < 3; ++i) {
      const Lanes<T> rises = cosine[i] * half[i];
      negative[i] = rises > Lanes<T>(T(0));
      down[i] = arm[i] * sign_or_one(-rises);
      rise[i] = abs(rises);
    }
    rounding = a.rounding;
    scale = plane.scale + a.rounding + norm_l1(a.half) + doubt(turn);
  }

  [[gnu::always_inline]] Vec3<T> lowest() const { return down[0] + down[1] + down[2]; }
  [[gnu::always_inline]] Lanes<T> height() const {
    return plane.height - (rise[0] + rise[1] + rise[2]);
  }
};

struct BoxLowestPoints {
  /// The four vertices of the face that is turned most towards the plane, the lowest first and the
  /// one opposite to it last. The feature of a vertex has bit i set if coordinate i is negative.
  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 4> feet(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
    BoxOverPlane<T> box(job, block);
    const Vec3<T> corner = box.lowest();
    const Lanes<T> height = box.height();
    Lanes<T> lowest(T(0));
    Lanes<T> flip[3];
    for (int i = 0; i < 3; ++i) {
      const Lanes<T> bit(T(1 << i));
      lowest = lowest + select(box.negative[i], bit, Lanes<T>(T(0)));
      flip[i] = select(box.negative[i], -bit, bit);
    }
    // The exchanges make arm 2 the one with the largest cosine to the normal; arms 0 and 1 span the
    // face.
    const auto exchange = [&](const LaneMask<T>& mask, int i) {
      const auto swap = [&](auto& x, auto& y) {
        const auto t = select(mask, y, x);
        y = select(mask, x, y);
        x = t;
      };
      swap(box.down[i], box.down[2]);
      swap(box.rise[i], box.rise[2]);
      swap(flip[i], flip[2]);
    };
    const Lanes<T> x = abs(box.cosine[0]);
    const Lanes<T> y = abs(box.cosine[1]);
    const Lanes<T> z = abs(box.cosine[2]);
    const LaneMask<T> is_x = (x > y) & (x > z);
    const LaneMask<T> is_y = (!is_x) & (y > z);
    exchange(is_x, 0);
    exchange(is_y, 1);
    const Vec3<T>* const down = box.down;
    const Lanes<T>* const rise = box.rise;
    const Lanes<T> two(T(2));
    LowestPoints<T, 4> feet{
        {corner, corner - down[0] * two, corner - down[1] * two,
         corner - (down[0] + down[1]) * two},
        {height, height + rise[0] * two, height + rise[1] * two,
         height + (rise[0] + rise[1]) * two},
        {lowest, lowest + flip[0], lowest + flip[1], lowest + flip[0] + flip[1]},
        box.rounding,
        box.plane.normal,
        box.scale};
    sort_two(feet, 1, 2);
    return feet;
  }

  template <typename T>
  [[gnu::noinline]] static LowestPoints<T, 1> lowest(const NarrowJob& job,
                                                     const PairBlock<T>& block) {
    const BoxOverPlane<T> box(job, block);
    return {{box.lowest()}, {box.height()}, {}, box.rounding, box.plane.normal, box.scale};
  }

  template <typename T>
  [[gnu::noinline]] static LowestHeight<T> least(const NarrowJob& job, const PairBlock<T>& block) {
    const BoxOverPlane<T> box(job, block);
    return {box.height(), box.rounding, box.scale};
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::SphereLowestPoints, 1>>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::CapsuleLowestPoints, 2>>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(box_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::BoxLowestPoints, 4>>();
extern const NarrowKernels WINNOW_KERNEL_TABLE(triangle_half_space_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<
        WINNOW_ISA_NAME::round::OverPlane<WINNOW_ISA_NAME::round::TriangleLowestPoints, 4>>();

}  // namespace winnow
