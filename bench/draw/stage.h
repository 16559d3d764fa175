#pragma once

#include <winnow/partitions/partition.h>
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A partition that is shown a scene as a simulation would show it, frame by frame: only what moved
/// is updated, and every frame's pairs are asked for. Row i of the scene is object i and has client
/// data i. Throws std::runtime_error where a call is refused.
class Stage {
 public:
  /// At the first frame. The source must live as long.
  Stage(std::string_view partition, FrameSource& source);

  /// Goes to the next frame; false, and no change, if there is none.
  bool advance();

  /// Of the frame that was reached; the first is 0.
  [[nodiscard]] std::size_t frame() const noexcept { return frame_; }
  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// The frame's pairs that overlap, in canonical order; those of NSquared tested.
  [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }
  /// How many the partition reported.
  [[nodiscard]] std::size_t reported() const noexcept { return reported_; }

 private:
  void step(std::span<const Aabb> boxes);
  void find_pairs();

  FrameSource& source_;
  std::size_t frame_ = 0;
  Partition partition_;
  PairBuffer buffer_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  std::vector<Pair> pairs_;
  std::size_t reported_ = 0;
};

/// Throws std::runtime_error unless the call was accepted.
void require_ok(Status status, const char* call);

}  // namespace winnow::bench
