#include "bench/simulation/flow_phases.h"

#include "bench/common/need.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "pipeline/composites/mid_phase.h"

#include <span>

namespace winnow::bench {
namespace {

BodyPair to_bodies(const Pair& pair) {
  return {pair.first, pair.second};
}

}  // namespace

FlowPhases::FlowPhases(const GranularFlow& flow, const Execution& execution)
    : flow_(flow),
      execution_(execution),
      bodies_(make_named("LinearBvh", {.execution = execution})),
      mesh_(make_named("LinearBvh", {.execution = execution})),
      keys_(flow.objects()),
      boxes_(flow.objects()) {
  for (std::size_t i = 0; i < boxes_.size(); ++i) boxes_[i] = flow.box(i);
  need(bodies_.insert(boxes_, {}, keys_), "boxes");
  const ShapeId mesh = flow.mesh_shape();
  Key key;
  need(mesh_.insert(flow.composites().bounds(mesh, Pose{}), 0, key), "the mesh's box");
  for (std::size_t i = 0; i < flow.objects(); ++i) shapes_.push_back(flow.shape(i));
  shapes_.push_back(mesh);
}

/// The objects of a new partition have the ids 0, 1, 2, ..., which are therefore rows.
void FlowPhases::find_pairs() {
  need(bodies_.update(keys_, boxes_), "boxes");
  need(bodies_.self_pairs(own_), "pairs");
  need(bodies_.pairs_with(mesh_, with_mesh_), "pairs");
}

FlowTimes FlowPhases::run() {
  poses_.assign(flow_.contact_poses().begin(), flow_.contact_poses().end());
  const auto mesh = static_cast<std::uint32_t>(flow_.objects());
  const Bodies bodies{shapes_, poses_};
  FlowTimes times;
  const Stopwatch broad;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    boxes_[i] = flow_.shapes().bounds(shapes_[i], poses_[i]);
  }
  find_pairs();
  times.broad = broad.ms();

  pairs_.clear();
  for (const Pair& pair : own_.pairs()) pairs_.push_back(to_bodies(pair));
  mesh_pairs_.clear();
  for (const Pair& pair : with_mesh_.pairs()) mesh_pairs_.push_back({pair.first, mesh});

  const Stopwatch finding;
  need(mid::find_primitive_pairs(flow_.composites(), flow_.shapes(), bodies, mesh_pairs_, 0.0,
                                 execution_, primitives_),
       "triangles");
  times.mid = finding.ms();

  const NarrowOptions options{.execution = execution_};
  const Stopwatch narrow;
  need(narrow_.collide(flow_.shapes(), bodies, pairs_, options, convex_), "contacts");
  const Bodies primitives{{primitives_.shapes.data(), primitives_.shapes.size()},
                          {primitives_.poses.data(), primitives_.poses.size()}};
  need(narrow_.collide(primitives_.tables(flow_.shapes()), primitives,
                       {primitives_.pairs.data(), primitives_.pairs.size()}, options, parts_),
       "contacts");
  times.narrow = narrow.ms();

  const Stopwatch smoothing;
  need(mid::correct_surface_contacts({flow_.composites(), flow_.shapes(), bodies, mesh_pairs_},
                                     primitives_, options.contact_margin, execution_, parts_),
       "contacts");
  times.mid += smoothing.ms();
  return times;
}

}  // namespace winnow::bench
