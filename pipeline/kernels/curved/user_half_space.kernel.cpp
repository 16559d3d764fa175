// Half-spaces against user shapes (support functions): the lowest point over the plane and, for
// contacts, the support points of directions that are slightly off.

#include "pipeline/kernels/cores/curved_pair.wide.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/round/half_space_common.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow {
namespace WINNOW_ISA_NAME::round {
namespace {

/// Points of a shape over a plane, the lowest first. Directions deviate slightly from the normal,
/// because bodies rock: the corners of a flat face stay far apart, and the points of a round
/// surface are close together and count as one. The name of a point is the index of its direction.
/// The lowest point has the name of the point that it replaces, else kMaxPoints (0 if it is the
/// only point).
class TiltedSupportPoints {
 public:
  static constexpr std::uint32_t kMaxPoints = 4;

  /// `up` is a unit vector. Except for the lowest, takes only points up to height `limit` along it.
  TiltedSupportPoints(const SupportShape& shape, const double* up, const double* lowest,
                      double limit) {
    double across[2][3];
    hull::directions_across(up, across);
    apart_ = sample_tolerance(shape, across, 1.0);
    constexpr int kCorners[kMaxPoints][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (std::uint32_t i = 0; i < kMaxPoints; ++i) {
      double down[3];
      double x[3];
      for (int k = 0; k < 3; ++k) {
        down[k] = kTilt * (kCorners[i][0] * across[0][k] + kCorners[i][1] * across[1][k]) - up[k];
      }
      user_support(shape, down, 1.0, x);
      if (dot3(up, x) <= limit && nearest(x) == count_) add(x, i);
    }
    put_first(up, lowest);
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] const double* point(std::uint32_t i) const { return point_[i]; }
  [[nodiscard]] std::uint32_t name(std::uint32_t i) const { return name_[i]; }

 private:
  /// Tangent of the deviation of the directions, on each of two axes.
  static constexpr double kTilt = 0.03;

  void add(const double* x, std::uint32_t name) {
    name_[count_] = name;
    set(count_++, x);
  }
  void set(std::uint32_t i, const double* x) {
    for (int k = 0; k < 3; ++k) point_[i][k] = x[k];
  }

  /// Returns the index of a point that counts as the same as x, or `count_`.
  [[nodiscard]] std::uint32_t nearest(const double* x) const {
    std::uint32_t i = 0;
    while (i < count_ && square_between(x, point_[i]) > apart_ * apart_) ++i;
    return i;
  }
  [[nodiscard]] static double square_between(const double* x, const double* y) {
    const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    return dot3(d, d);
  }

  /// Puts the lowest point first. The lowest point may be anywhere on a flat face: if the lowest of
  /// the other points is higher by at most kTiedDepth of their extent, that point is moved down to
  /// the height of the lowest point and is put first instead. Otherwise the lowest point replaces a
  /// point that counts as the same, or is added; if there is no room, it replaces the lowest of the
  /// other points.
  void put_first(const double* up, const double* lowest) {
    std::uint32_t best = 0;
    double reach = 0.0;
    for (std::uint32_t i = 1; i < count_; ++i) {
      if (dot3(up, point_[i]) < dot3(up, point_[best])) best = i;
      const double square = square_between(point_[i], point_[0]);
      reach = square > reach ? square : reach;
    }
    if (count_ == 0) return add(lowest, 0);
    const double rise = dot3(up, point_[best]) - dot3(up, lowest);
    if (rise <= kTiedDepth * __builtin_sqrt(reach)) {
      for (int k = 0; k < 3; ++k) point_[best][k] -= rise * up[k];
    } else {
      const std::uint32_t near = nearest(lowest);
      best = near < count_ ? near : best;
      if (near == count_ && count_ < kMaxPoints) {
        best = count_;
        add(lowest, kMaxPoints);
      }
      set(best, lowest);
    }
    for (int k = 0; k < 3; ++k) {
      const double first = point_[0][k];
      point_[0][k] = point_[best][k];
      point_[best][k] = first;
    }
    const std::uint32_t name = name_[0];
    name_[0] = name_[best];
    name_[best] = name;
  }

  double apart_ = 0.0;
  std::uint32_t count_ = 0;
  double point_[kMaxPoints][3];
  std::uint32_t name_[kMaxPoints];
};

struct UserShapeOverPlane {
  template <typename T, int L>
  [[gnu::always_inline]] static Mask16 block(NarrowJob& job, const PairBlock<T>& block) {
    if constexpr (L == kManifold) {
      return LowestPointAnswers<4, SideA>::write<L>(job, block, feet<T, 4>(job, block));
    } else {
      return LowestPointAnswers<1, SideA>::write<L>(job, block, feet<T, 1>(job, block));
    }
  }

  template <typename T, int Count>
  [[gnu::noinline]] static LowestPoints<T, Count> feet(const NarrowJob& job,
                                                       const PairBlock<T>& block) {
    constexpr std::uint32_t kWidth = Lanes<T>::kCount;
    const PlacedPlane<T> plane = load_plane<SideA>(job, block);
    const ScaledQuaternion<T> turn = load_turn<SideB>(job, block);
    const Rotation<T> axes = rotation(turn);
    const Vec3<T> up = axes.to_local(plane.normal);
    alignas(64) T normal[3][kWidth];
    alignas(64) T height[kWidth];
    up.x.store(normal[0]);
    up.y.store(normal[1]);
    up.z.store(normal[2]);
    plane.height.store(height);
    alignas(64) T point[Count][3][kWidth] = {};
    alignas(64) T missing[Count][kWidth] = {};
    alignas(64) T name[Count][kWidth] = {};
    alignas(64) T rounding[kWidth] = {};
    alignas(64) T radius[kWidth] = {};
    for (std::uint32_t lane = 0; lane < block.count; ++lane) {
      const SupportShape& shape =
          job.tables->supports[shape_index<SideB>(job, block, static_cast<int>(lane))];
      rounding[lane] = static_cast<T>(shape.rounding);
      radius[lane] = static_cast<T>(shape.radius);
      double d[3];
      double down[3];
      for (int k = 0; k < 3; ++k) {
        d[k] = static_cast<double>(normal[k][lane]);
        down[k] = -d[k];
      }
      double lowest[3];
      user_support(shape, down, 1.0, lowest);
      put(lowest, lane, point[0]);
      if constexpr (Count == 1) continue;
      for (int i = 1; i < Count; ++i) missing[i][lane] = kLargest<T>;
      const double limit =
          job.margin_of(block.first + lane) + shape.rounding - static_cast<double>(height[lane]);
      if (!(dot3(d, lowest) <= limit)) continue;
      const TiltedSupportPoints print(shape, d, lowest, limit);
      for (std::uint32_t i = 0; i < print.count(); ++i) {
        put(print.point(i), lane, point[i]);
        name[i][lane] = static_cast<T>(print.name(i));
        missing[i][lane] = T(0);
      }
    }
    LowestPoints<T, Count> r;
    for (int i = 0; i < Count; ++i) {
      const Vec3<T> local{Lanes<T>::load(point[i][0]), Lanes<T>::load(point[i][1]),
                          Lanes<T>::load(point[i][2])};
      const Lanes<T> gone = Lanes<T>::load(missing[i]);
      r.foot[i] = plane.to_b + axes.to_world(local);
      r.height[i] = select(gone > Lanes<T>(T(0)), gone, plane.height + dot(up, local));
      r.feature[i] = Lanes<T>::load(name[i]);
    }
    r.rounding = Lanes<T>::load(rounding);
    r.normal = plane.normal;
    r.scale = plane.scale + r.rounding + Lanes<T>::load(radius) * Lanes<T>(T(2)) + doubt(turn);
    return r;
  }

  template <typename T, std::size_t Width>
  [[gnu::always_inline]] static void put(const double* x, std::uint32_t lane, T (&to)[3][Width]) {
    for (int k = 0; k < 3; ++k) to[k][lane] = static_cast<T>(x[k]);
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME::round

extern const NarrowKernels WINNOW_KERNEL_TABLE(half_space_support_kernels) =
    WINNOW_ISA_NAME::closed_form_kernels_of<WINNOW_ISA_NAME::round::UserShapeOverPlane>();

}  // namespace winnow
