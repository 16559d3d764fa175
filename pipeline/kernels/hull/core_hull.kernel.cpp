// Spheres, capsules and boxes against hulls, and hulls against triangles.

#include "pipeline/kernels/hull/hull_answers.wide.h"
#include "pipeline/kernels/hull/hull_cores.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {

static inline const SphereShape* table_of(const ShapeTables& t, const SphereShape*) {
  return t.spheres;
}
static inline const CapsuleShape* table_of(const ShapeTables& t, const CapsuleShape*) {
  return t.capsules;
}
static inline const BoxShape* table_of(const ShapeTables& t, const BoxShape*) {
  return t.boxes;
}
static inline const TriangleShape* table_of(const ShapeTables& t, const TriangleShape*) {
  return t.triangles;
}

/// A simple shape, of body a if `Before`, and a hull, which is the first of the HullPair.
template <typename Shape, bool Before>
class CoreAndHull {
 public:
  static constexpr std::uint32_t kRoom = 32;

  bool place(const NarrowJob& job, BodyPair bodies, std::uint32_t slot, HullPair& pair) {
    const std::uint32_t simple = Before ? bodies.a : bodies.b;
    const std::uint32_t body = Before ? bodies.b : bodies.a;
    const Shape& shape =
        table_of(job.tables, static_cast<const Shape*>(nullptr))[job.shapes[simple].index()];
    const HullShape& hull = job.tables.hulls[job.shapes[body].index()];
    const HullShape& core = core_[slot].of(shape);
    if (core_[slot].is_sliver()) return false;
    const HullShape& a = Before ? core : hull;
    const HullShape& b = Before ? hull : core;
    return place_hulls(a, b, job.poses[bodies.a], job.poses[bodies.b], Before, pair);
  }

 private:
  CoreHull core_[kRoom];
};

}  // namespace WINNOW_ISA_NAME

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_hull_kernels) =
    WINNOW_ISA_NAME::kHullKernels<WINNOW_ISA_NAME::CoreAndHull<SphereShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(capsule_hull_kernels) =
    WINNOW_ISA_NAME::kHullKernels<WINNOW_ISA_NAME::CoreAndHull<CapsuleShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(box_hull_kernels) =
    WINNOW_ISA_NAME::kHullKernels<WINNOW_ISA_NAME::CoreAndHull<BoxShape, true>>;
extern const NarrowKernels WINNOW_KERNEL_TABLE(hull_triangle_kernels) =
    WINNOW_ISA_NAME::kHullKernels<WINNOW_ISA_NAME::CoreAndHull<TriangleShape, false>>;

}  // namespace winnow
