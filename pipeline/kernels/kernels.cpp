#include "pipeline/kernels/kernels.h"
#include <winnow/simd/isa.h>
#include "pipeline/shapes/pair_order.h"

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

const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept {
  using enum ShapeKind;
  switch (ConvexKindPairs::index(a, b)) {
    case ConvexKindPairs::index(sphere, sphere):
      return &sphere_sphere_kernels();
    case ConvexKindPairs::index(sphere, capsule):
      return &sphere_capsule_kernels();
    case ConvexKindPairs::index(sphere, box):
      return &sphere_box_kernels();
    case ConvexKindPairs::index(sphere, triangle):
      return &sphere_triangle_kernels();
    case ConvexKindPairs::index(sphere, half_space):
      return &sphere_half_space_kernels();
    case ConvexKindPairs::index(capsule, capsule):
      return &capsule_capsule_kernels();
    case ConvexKindPairs::index(capsule, box):
      return &capsule_box_kernels();
    case ConvexKindPairs::index(capsule, triangle):
      return &capsule_triangle_kernels();
    case ConvexKindPairs::index(capsule, half_space):
      return &capsule_half_space_kernels();
    case ConvexKindPairs::index(box, half_space):
      return &box_half_space_kernels();
    case ConvexKindPairs::index(triangle, half_space):
      return &triangle_half_space_kernels();
    case ConvexKindPairs::index(box, box):
      return &box_box_kernels();
    case ConvexKindPairs::index(box, triangle):
      return &box_triangle_kernels();
    case ConvexKindPairs::index(hull, hull):
      return &hull_hull_kernels();
    case ConvexKindPairs::index(triangle, triangle):
      return &triangle_triangle_kernels();
    case ConvexKindPairs::index(sphere, hull):
      return &sphere_hull_kernels();
    case ConvexKindPairs::index(capsule, hull):
      return &capsule_hull_kernels();
    case ConvexKindPairs::index(box, hull):
      return &box_hull_kernels();
    case ConvexKindPairs::index(hull, triangle):
      return &hull_triangle_kernels();
    default:
      return nullptr;
  }
}

}  // namespace winnow
