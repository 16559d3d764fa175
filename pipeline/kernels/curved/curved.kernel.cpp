// Cylinders and cones against everything but spheres and half-spaces. The code is one for all kinds
// of pairs, which a job tells: a branch that goes the same way for all of its pairs.

#include "pipeline/kernels/curved/curved_answers.wide.h"

namespace winnow {

extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_cylinder_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_cone_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(box_cylinder_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(box_cone_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cylinder_cylinder_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cylinder_cone_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cylinder_hull_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cylinder_triangle_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cone_cone_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cone_hull_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;
extern const NarrowKernels WINNOW_KERNEL_TABLE(cone_triangle_kernels) =
    WINNOW_ISA_NAME::curved::kCurvedKernels;

}  // namespace winnow
