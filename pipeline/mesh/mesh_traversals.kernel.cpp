#include "pipeline/mesh/mesh_ball.wide.h"
#include "pipeline/mesh/mesh_ordered.wide.h"
#include "pipeline/mesh/mesh_pairs.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Calls show(corners, hits, first slot) for leaves with triangles in the box. One mask a level is
/// all the state: the walk goes on where the mask of the level left off.
template <typename Show>
[[gnu::always_inline]] inline void walk_box(const MeshView& mesh, const MeshBoxJob& job,
                                            Show&& show) {
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
      const std::uint32_t first_slot = node * kMeshFanout;
      const Corners16 corners = load_corners(mesh, node);
      const Mask16 hits =
          overlap(box_of(corners), job.low, job.high) & present(mesh.triangle_count, first_slot);
      if (hits != 0) show(corners, hits, first_slot);
    } else {
      --level;
      enter(node * kMeshFanout);
    }
  }
}

void overlap_walk(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out) {
  if (job.has_ball) {
    BallSieve sieve(job.ball, out);
    walk_box(mesh, job, [&](const Corners16& corners, Mask16 hits, std::uint32_t first_slot) {
      sieve.add(corners, hits, first_slot);
    });
    sieve.finish();
    return;
  }
  walk_box(mesh, job, [&](const Corners16&, Mask16 hits, std::uint32_t first_slot) {
    put_slots(count_from(first_slot), hits, out);
  });
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
