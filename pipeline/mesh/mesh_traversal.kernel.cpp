#include "pipeline/mesh/mesh_descent.wide.h"
#include "pipeline/mesh/mesh_near_pairs.wide.h"
#include "pipeline/mesh/mesh_overlaps.wide.h"
#include "pipeline/mesh/mesh_pairs.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME::mesh {
namespace {

void find_pairs(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out) {
  PairTraversal(a, b, job, out).run();
}

void show_cast(const MeshView& mesh, const MeshCastJob& job, double limit,
               const SlotVisitor& visitor) {
  CastMeasure measure(job, limit);
  visit_nearest_first(mesh, measure, visitor);
}

void show_near_pairs(const MeshView& a, const MeshView& b, const MeshPairJob& job, double limit,
                     const SlotPairVisitor& visitor) {
  NearPairTraversal(a, b, job, limit, visitor).run();
}

void show_near(const MeshView& mesh, const MeshNearJob& job, double limit,
               const SlotVisitor& visitor) {
  NearMeasure measure(job, limit);
  visit_nearest_first(mesh, measure, visitor);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME::mesh

extern const MeshKernels WINNOW_KERNEL_TABLE(mesh_kernels) = {
    WINNOW_ISA_NAME::mesh::find_overlaps, WINNOW_ISA_NAME::mesh::find_pairs,
    WINNOW_ISA_NAME::mesh::show_cast,     WINNOW_ISA_NAME::mesh::show_near_pairs,
    WINNOW_ISA_NAME::mesh::show_near,
};

}  // namespace winnow
