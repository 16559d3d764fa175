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

/// What the ranks of a cluster did in a frame; the same on every process. Times are those of the
/// process that took longest.
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
  std::uint64_t bytes = 0;  ///< held by all ranks in the end

  /// Median of the frames after the first; of the first if there is no other.
  [[nodiscard]] double median_ms() const;
  /// Numbers of one kind, of each frame.
  template <typename Get>
  [[nodiscard]] auto each(Get&& get) const {
    std::vector<decltype(get(frames.front()))> values;
    for (const ClusterFrame& frame : frames) values.push_back(get(frame));
    return values;
  }
};

/// What a cluster is shown, and asked.
struct ClusterOrder {
  std::size_t frames = 1;  ///< at most so many
  /// Unset: the pairs of boxes. Else contacts of bodies, which have the sizes of the boxes that
  /// they come with and follow their middles.
  std::optional<ContactLevel> level;
};

/// Shows frames of a source to a cluster. Every process reads all of them, and tells its ranks what
/// became of the bodies that belong to these; the first frame's boxes are added where their rows
/// say. Finding what changed and fingerprints are outside the times. Throws std::runtime_error
/// where the cluster fails. Collective.
[[nodiscard]] ClusterRun run_cluster(FrameSource& source, Transport& transport,
                                     const ClusterOrder& order, const Execution& execution);

/// A box as a body: its shape is half as long, wide and high as it says, and stands at its middle.
[[nodiscard]] BoxShape box_shape_of(const Aabb& box) noexcept;
[[nodiscard]] Pose middle_of(const Aabb& box) noexcept;

}  // namespace winnow::bench
