#include <winnow/pipeline/mesh/mesh_ball.wide.h>
#include <winnow/pipeline/mesh/mesh_ordered.wide.h>
#include <winnow/pipeline/mesh/mesh_pairs.wide.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

void put_slots(std::uint32_t first_slot, Mask16 hits, SlotSink& out) {
  if (out.size + kLanes <= out.capacity) {
    out.size += compress_store(hits, count_from(first_slot), out.slot + out.size);
    return;
  }
  for (; hits != 0; hits &= hits - 1, ++out.size) {
    if (out.size < out.capacity) out.slot[out.size] = first_slot + first(hits);
  }
}

void show_leaf_in_box(const MeshView& mesh, const MeshBoxJob& job, std::uint32_t leaf,
                      SlotSink& out) {
  const std::uint32_t first_slot = leaf * kMeshFanout;
  const Corners16 corners = load_corners(mesh, leaf);
  Mask16 hits =
      overlap(box_of(corners), job.low, job.high) & present(mesh.triangle_count, first_slot);
  if (job.has_ball && hits != 0) hits &= ~outside_ball(corners, job.ball);
  if (hits != 0) put_slots(first_slot, hits, out);
}

/// One mask a level is all the state: the walk goes on where the mask of the level left off.
void overlap_walk(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out) {
  Mask16 open[kMaxMeshLevels];
  std::uint32_t base[kMaxMeshLevels];
  std::uint32_t level = mesh.levels - 1;
  const auto enter = [&](std::uint32_t first_node) {
    base[level] = first_node;
    open[level] = overlap(load_nodes(mesh, level, first_node), job.node_low, job.node_high) &
                  present(mesh.count[level], first_node);
  };
  enter(0);
  for (;;) {
    if (open[level] == 0) {
      if (++level == mesh.levels) return;
      continue;
    }
    const std::uint32_t node = base[level] + first(open[level]);
    open[level] &= open[level] - 1;
    if (level == 0) {
      show_leaf_in_box(mesh, job, node, out);
    } else {
      --level;
      enter(node * kMeshFanout);
    }
  }
}

void pair_walk(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out) {
  PairWalk(a, b, job, out).run();
}

void sweep_walk(const MeshView& mesh, const MeshSweepJob& job, double limit,
                const SlotVisitor& visitor) {
  SweepMeasure measure(job, limit);
  walk_in_order(mesh, measure, visitor);
}

void near_walk(const MeshView& mesh, const MeshNearJob& job, double limit,
               const SlotVisitor& visitor) {
  NearMeasure measure(job, limit);
  walk_in_order(mesh, measure, visitor);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const MeshKernels WINNOW_KERNEL_TABLE(mesh_kernels) = {
    WINNOW_ISA_NAME::overlap_walk,
    WINNOW_ISA_NAME::pair_walk,
    WINNOW_ISA_NAME::sweep_walk,
    WINNOW_ISA_NAME::near_walk,
};

}  // namespace winnow
