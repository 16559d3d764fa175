#pragma once

#include <winnow/partitions/partition.h>
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Runs a scene in a partition frame by frame, as a simulation does: updates only the objects that
/// moved, and finds all pairs of every frame. Row i of the scene is object i and has client data i.
/// Throws std::runtime_error if a call fails.
class Stage {
 public:
  /// Starts at the first frame. `source` must outlive this.
  Stage(std::string_view partition, FrameSource& source);

  /// Goes to the next frame. Returns false and changes nothing if there is none.
  bool advance();

  /// The number of the current frame; the first is 0.
  [[nodiscard]] std::size_t frame() const noexcept { return frame_; }
  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// The overlapping pairs of the frame, in canonical order, without pairs that the partition
  /// reported but whose boxes do not overlap.
  [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }
  /// Number of pairs that the partition reported.
  [[nodiscard]] std::size_t reported() const noexcept { return buffer_.size(); }

 private:
  void insert_new();
  void find_pairs();

  FrameSource& source_;
  std::size_t frame_ = 0;
  Partition partition_;
  PairBuffer buffer_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  std::vector<Pair> pairs_;
};

}  // namespace winnow::bench
