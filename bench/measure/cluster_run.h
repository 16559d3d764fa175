#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "bench/measure/race.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace winnow::bench {

/// Results of all ranks, equal on all processes. The times are the slowest process's; `bytes` are
/// allocated by all ranks at the end.
struct ClusterRun : Run {
  std::uint32_t ranks = 1;
  std::vector<ClusterDigest> digests;         ///< by frame
  std::vector<ClusterStatistics> statistics;  ///< by frame
};

/// Limits and contact level of a run.
struct ClusterRunOptions {
  std::size_t frames = 1;  ///< limit
  /// Unset: pairs of boxes. Otherwise contacts of bodies at this level; a body has the size of its
  /// first box and follows the box's centre.
  std::optional<ContactLevel> level;
};

/// Runs frames of a source on a cluster. Every process reads all frames and updates the bodies that
/// its ranks own. The boxes of the first frame are distributed to ranks by row. Finding changes,
/// and fingerprints, are not timed. Throws std::runtime_error if the cluster returns an error.
/// Collective: all processes must call it.
[[nodiscard]] ClusterRun run_cluster(FrameSource& source, Transport& transport,
                                     const ClusterRunOptions& order, const Execution& execution);

/// Returns the box as a body's shape, with half the edges, and its centre as a pose.
[[nodiscard]] BoxShape box_shape_of(const Aabb& box) noexcept;
[[nodiscard]] Pose middle_of(const Aabb& box) noexcept;

}  // namespace winnow::bench
