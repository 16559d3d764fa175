#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/export.h>
#include <winnow/core/matrix.h>
#include <winnow/core/plane.h>
#include <winnow/core/vec3.h>

#include <array>
#include <limits>

namespace winnow {

/// What a camera sees: six planes that face inward, and a box around what lies within them.
struct WINNOW_API Frustum {
  /// Depth that the near plane has in clip space.
  enum class NearDepth {
    zero,       ///< as Vulkan, Direct3D and Metal have it
    minus_one,  ///< as OpenGL has it
  };

  std::array<Plane, 6> planes;  ///< left, right, bottom, top, near, far
  /// Contains the frustum; whatever lies outside of it is not seen. Infinite where not known.
  Aabb bounds{Vec3f::constant(-std::numeric_limits<float>::infinity()),
              Vec3f::constant(std::numeric_limits<float>::infinity())};

  /// A camera at `eye` that looks along `forward` (any length), with `up` roughly upward; vertical
  /// field of view in radians, in (0, pi); aspect = width / height > 0; 0 <= near_t < far_t are
  /// distances along `forward`, far_t finite. Other values give an invalid frustum.
  [[nodiscard]] static Frustum perspective(const Vec3f& eye, const Vec3f& forward, const Vec3f& up,
                                           float vertical_fov, float aspect, float near_t,
                                           float far_t) noexcept;

  /// From a matrix that takes column vectors of the world to clip space (Gribb and Hartmann, "Fast
  /// extraction of viewing frustum planes", 2001). Planes carry the rounding of the matrix itself.
  /// A far plane at infinity is legal, and so is a reversed depth; the box of an infinite frustum
  /// is infinite.
  [[nodiscard]] static Frustum from_matrix(const Mat4d& clip_from_world,
                                           NearDepth near_depth = NearDepth::zero) noexcept;

  /// True if a query takes it: six valid planes and a valid box.
  [[nodiscard]] bool is_valid() const noexcept;
};

static_assert(sizeof(Frustum) == 120 && alignof(Frustum) == 4,
              "layout must not depend on build flags");

}  // namespace winnow
