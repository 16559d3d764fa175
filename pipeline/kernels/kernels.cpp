#include "pipeline/kernels/kernels.h"
#include <winnow/simd/isa.h>

namespace winnow {

WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_sphere_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_capsule_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_box_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_triangle_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_half_space_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, capsule_capsule_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, capsule_box_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, capsule_triangle_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, capsule_half_space_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, box_half_space_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, triangle_half_space_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, box_box_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, box_triangle_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, hull_hull_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, triangle_triangle_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, sphere_hull_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, capsule_hull_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, box_hull_kernels)
WINNOW_DEFINE_KERNELS(NarrowKernels, hull_triangle_kernels)

namespace {

constexpr std::uint32_t code(ShapeKind a, ShapeKind b) {
  return static_cast<std::uint32_t>(a) * kShapeKinds + static_cast<std::uint32_t>(b);
}

}  // namespace

const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept {
  using enum ShapeKind;
  switch (code(a, b)) {
    case code(sphere, sphere):
      return &sphere_sphere_kernels();
    case code(sphere, capsule):
      return &sphere_capsule_kernels();
    case code(sphere, box):
      return &sphere_box_kernels();
    case code(sphere, triangle):
      return &sphere_triangle_kernels();
    case code(sphere, half_space):
      return &sphere_half_space_kernels();
    case code(capsule, capsule):
      return &capsule_capsule_kernels();
    case code(capsule, box):
      return &capsule_box_kernels();
    case code(capsule, triangle):
      return &capsule_triangle_kernels();
    case code(capsule, half_space):
      return &capsule_half_space_kernels();
    case code(box, half_space):
      return &box_half_space_kernels();
    case code(triangle, half_space):
      return &triangle_half_space_kernels();
    case code(box, box):
      return &box_box_kernels();
    case code(box, triangle):
      return &box_triangle_kernels();
    case code(hull, hull):
      return &hull_hull_kernels();
    case code(triangle, triangle):
      return &triangle_triangle_kernels();
    case code(sphere, hull):
      return &sphere_hull_kernels();
    case code(capsule, hull):
      return &capsule_hull_kernels();
    case code(box, hull):
      return &box_hull_kernels();
    case code(hull, triangle):
      return &hull_triangle_kernels();
    default:
      return nullptr;
  }
}

}  // namespace winnow
