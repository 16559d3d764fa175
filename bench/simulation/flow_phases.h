#pragma once

#include <winnow/core/pair_buffer.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/narrow_phase.h>
#include "bench/simulation/granular_flow.h"
#include "pipeline/narrow/primitive_pairs.h"

#include <memory>
#include <vector>

namespace winnow::bench {

/// Runs each phase of a flow's frame separately, without the scene: a partition with the same
/// boxes, and a mid phase and a narrow phase with the same pairs.
class FlowPhases {
 public:
  /// The flow must keep contact poses.
  FlowPhases(const GranularFlow& flow, const Execution& execution);

  /// Runs all phases for the poses of the flow's last step; returns milliseconds.
  FlowTimes run();

 private:
  void find_pairs();

  const GranularFlow& flow_;
  Execution execution_;
  Partition bodies_;
  Partition mesh_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  PairBuffer own_;
  PairBuffer with_mesh_;
  std::vector<ShapeId> shapes_;
  std::vector<Pose> poses_;
  std::vector<BodyPair> pairs_;
  std::vector<BodyPair> mesh_pairs_;
  PrimitivePairs primitives_;
  NarrowPhase narrow_;
  NarrowResult convex_;
  NarrowResult parts_;
};

}  // namespace winnow::bench
