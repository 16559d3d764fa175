#pragma once

// Regions of space that a partition can be searched for: capsules, oriented boxes, planes, frusta.

#include <winnow/core/export.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <variant>

namespace winnow {

/// The closed half-space of all points p with normal . p + offset >= 0. The normal points inward
/// and may have any finite length except zero.
struct Plane {
  /// Inward normal; finite, not zero.
  Vec3f normal = {1.0F, 0.0F, 0.0F};
  float offset = 0.0F;  ///< signed distance of the origin times the normal's length; finite

  /// Returns true if a query accepts this plane: all finite, and its normal not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    return normal.all_finite() && std::isfinite(offset) && !normal.is_zero();
  }
};

static_assert(sizeof(Plane) == 16 && alignof(Plane) == 4, "layout must not depend on build flags");

/// All points within `radius` of the segment from `a` to `b`; closed. If `a` equals `b` the capsule
/// is a ball; if the radius is zero it is a segment.
struct Capsule {
  /// First end of the segment; finite.
  Vec3f a;
  /// Second end of the segment; finite, may be equal to `a`.
  Vec3f b;
  float radius = 0.0F;  ///< finite, >= 0

  /// Returns true if a query accepts this capsule: finite ends, finite radius >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return a.all_finite() && b.all_finite() && std::isfinite(radius) && radius >= 0.0F;
  }

  /// Returns the smallest float box that contains the capsule.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box = Sphere{a, radius}.bounds();
    box.merge(Sphere{b, radius}.bounds());
    return box;
  }
};

static_assert(sizeof(Capsule) == 28 && alignof(Capsule) == 4,
              "layout must not depend on build flags");

/// All points center + axes * s with |s_i| <= half_i; closed. The columns of `axes` should be
/// orthogonal unit vectors. Other finite columns are accepted; the box is then a parallelepiped.
struct OrientedBox {
  /// Centre of the box.
  Vec3f center;
  /// Half extent along each column of `axes`.
  Vec3f half;
  /// Directions of the edges, as columns.
  Mat3f axes = Mat3f::identity();

  /// Returns true if a query accepts this box: all finite, half >= 0.
  [[nodiscard]] bool is_valid() const noexcept {
    return center.all_finite() && half.all_finite() && axes.all_finite() && half.x() >= 0.0F &&
           half.y() >= 0.0F && half.z() >= 0.0F;
  }

  /// Returns a float box that contains this box and is at most two ulp larger than the smallest
  /// one.
  [[nodiscard]] Aabb bounds() const noexcept {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      double reach = 0.0;
      for (int i = 0; i < 3; ++i) {
        reach += std::abs(detail::to_double(axes(axis, i))) * detail::to_double(half[i]);
      }
      reach *= 1.0 + 1e-15;
      const double c = detail::to_double(center[axis]);
      box.min[axis] = detail::round_down(detail::add_down(c, -reach));
      box.max[axis] = detail::round_up(detail::add_up(c, reach));
    }
    return box;
  }
};

static_assert(sizeof(OrientedBox) == 60 && alignof(OrientedBox) == 4,
              "layout must not depend on build flags");

/// Returns a k-DOP of a valid oriented box, rounded outward. Each slab is larger than the tightest
/// one by at most 1e-14 of the sum of the box's coordinates and edges, plus, at each end, two ulp
/// and the smallest normal float.
template <int K>
[[nodiscard]] Kdop<K> kdop_around(const OrientedBox& box) noexcept {
  constexpr auto directions = kdop_directions<K>();
  constexpr float kUlp = 1.2e-7F;  // a little more than 2^-23
  // Smaller numbers may be flushed to 0.
  constexpr float kMinNormal = std::numeric_limits<float>::min();
  double center[3];
  double edge[3][3];  // half edges as vectors
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = detail::to_double(box.center[axis]);
    size += std::abs(center[axis]);
    for (int i = 0; i < 3; ++i) {
      edge[i][axis] = detail::to_double(box.axes(axis, i)) * detail::to_double(box.half[i]);
      size += std::abs(edge[i][axis]);
    }
  }
  // Exceeds the rounding error of all sums, which is a few 2^-53 of their terms.
  const double slack = 4e-15 * size;
  Kdop<K> result;
  for (std::size_t s = 0; s < Kdop<K>::kSlabs; ++s) {
    const auto along = [&](const double* v) {
      double sum = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) sum += directions[s][axis] * v[axis];
      return sum;
    };
    const double middle = along(center);
    const double reach =
        slack + std::abs(along(edge[0])) + std::abs(along(edge[1])) + std::abs(along(edge[2]));
    // The nearest float moves outward by slightly more than one ulp, whichever way it was rounded.
    // Testing the direction would cost more. Ends beyond the float range become the largest float,
    // which a partition treats as infinity.
    const float low = detail::finite_float(middle - reach);
    const float high = detail::finite_float(middle + reach);
    result.min[s] = low - (std::abs(low) * kUlp + kMinNormal);
    result.max[s] = high + (std::abs(high) * kUlp + kMinNormal);
  }
  return result;
}

/// View volume of a camera: six planes whose normals point inward, and a bounding box.
struct WINNOW_API Frustum {
  /// Depth of the near plane in clip space.
  enum class NearDepth {
    zero,       ///< Vulkan, Direct3D and Metal
    minus_one,  ///< OpenGL
  };

  std::array<Plane, 6> planes;  ///< left, right, bottom, top, near, far
  /// Bounding box of the frustum; objects outside of it are not visible. Infinite if unknown.
  Aabb bounds{Vec3f::constant(-std::numeric_limits<float>::infinity()),
              Vec3f::constant(std::numeric_limits<float>::infinity())};

  /// Returns the frustum of a camera at `eye` that looks along `forward` (any length), with `up`
  /// roughly upward. The vertical field of view is in radians, in (0, pi); aspect = width / height
  /// > 0. `near_t` and `far_t` are distances along `forward`: 0 <= near_t < far_t, far_t finite.
  /// For other values the frustum is invalid.
  [[nodiscard]] static Frustum perspective(const Vec3f& eye, const Vec3f& forward, const Vec3f& up,
                                           float vertical_fov, float aspect, float near_t,
                                           float far_t) noexcept;

  /// Returns the frustum of a matrix that transforms column vectors from world to clip space (Gribb
  /// and Hartmann, "Fast extraction of viewing frustum planes", 2001). The planes have the rounding
  /// error of the matrix. A far plane at infinity and a reversed depth range are valid; the
  /// bounding box of an infinite frustum is infinite.
  [[nodiscard]] static Frustum from_matrix(const Mat4d& clip_from_world,
                                           NearDepth near_depth = NearDepth::zero) noexcept;

  /// Returns true if a query accepts this frustum: six valid planes and a valid box.
  [[nodiscard]] bool is_valid() const noexcept;
};

static_assert(sizeof(Frustum) == 120 && alignof(Frustum) == 4,
              "layout must not depend on build flags");

/// A closed region of space for queries; each alternative converts to it implicitly. A span of
/// planes is the set of points inside all of them, which is all of space if the span is empty; the
/// planes must outlive the call. An Aabb may extend to infinity.
using Region =
    std::variant<Vec3f, Aabb, OrientedBox, Sphere, Capsule, Frustum, std::span<const Plane>>;

}  // namespace winnow
