// The kernels of cylinders, cones, ellipsoids and tapered capsules with everything except spheres
// and half-spaces, and of user shapes with everything except half-spaces. All pair kinds share one
// code, which branches by the kinds of the job's shapes; the branch is the same for all pairs of a
// job.

#include "pipeline/kernels/curved/curved_answers.wide.h"

namespace winnow {

#define WINNOW_CURVED(pair)                                        \
  extern const NarrowKernels WINNOW_KERNEL_TABLE(pair##_kernels) = \
      WINNOW_ISA_NAME::curved::kCurvedKernels;
WINNOW_CURVED(capsule_cylinder)
WINNOW_CURVED(capsule_cone)
WINNOW_CURVED(box_cylinder)
WINNOW_CURVED(box_cone)
WINNOW_CURVED(cylinder_cylinder)
WINNOW_CURVED(cylinder_cone)
WINNOW_CURVED(cylinder_hull)
WINNOW_CURVED(cylinder_triangle)
WINNOW_CURVED(cone_cone)
WINNOW_CURVED(cone_hull)
WINNOW_CURVED(cone_triangle)
WINNOW_CURVED(capsule_ellipsoid)
WINNOW_CURVED(box_ellipsoid)
WINNOW_CURVED(cylinder_ellipsoid)
WINNOW_CURVED(cone_ellipsoid)
WINNOW_CURVED(hull_ellipsoid)
WINNOW_CURVED(triangle_ellipsoid)
WINNOW_CURVED(ellipsoid_ellipsoid)
WINNOW_CURVED(capsule_tapered_capsule)
WINNOW_CURVED(box_tapered_capsule)
WINNOW_CURVED(cylinder_tapered_capsule)
WINNOW_CURVED(cone_tapered_capsule)
WINNOW_CURVED(hull_tapered_capsule)
WINNOW_CURVED(triangle_tapered_capsule)
WINNOW_CURVED(ellipsoid_tapered_capsule)
WINNOW_CURVED(tapered_capsule_tapered_capsule)
WINNOW_CURVED(sphere_support)
WINNOW_CURVED(capsule_support)
WINNOW_CURVED(box_support)
WINNOW_CURVED(cylinder_support)
WINNOW_CURVED(cone_support)
WINNOW_CURVED(hull_support)
WINNOW_CURVED(triangle_support)
WINNOW_CURVED(ellipsoid_support)
WINNOW_CURVED(tapered_capsule_support)
WINNOW_CURVED(support_support)
#undef WINNOW_CURVED

}  // namespace winnow
