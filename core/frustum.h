#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/export.h>
#include <winnow/core/matrix.h>
#include <winnow/core/plane.h>
#include <winnow/core/vec3.h>

#include <array>
#include <limits>

namespace winnow {

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

}  // namespace winnow
