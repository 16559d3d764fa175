#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>
#include "bench/measure/fingerprint.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace winnow::bench {

/// Results of one frame, equal on all processes. The times are the slowest process's.
struct ClusterFrame {
  double frame_ms = 0.0;
  double update_ms = 0.0;
  PairSummary pairs;
  ClusterDigest digest;
  ClusterStatistics statistics;
};

struct ClusterRun {
  std::uint32_t ranks = 1;
  std::vector<ClusterFrame> frames;
  std::uint64_t bytes = 0;  ///< allocated by all ranks at the end

  /// Median of the frames after the first, or the first frame's time if it is the only one.
  [[nodiscard]] double median_ms() const;
  /// Returns one value of each frame.
  template <typename Get>
  [[nodiscard]] auto each(Get&& get) const {
    std::vector<decltype(get(frames.front()))> values;
    for (const ClusterFrame& frame : frames) values.push_back(get(frame));
    return values;
  }
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
