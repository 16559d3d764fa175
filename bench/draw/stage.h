#pragma once

#include <winnow/partitions/partition.h>
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A partition that was shown a scene up to one of its frames as a simulation would show it: only
/// what moved is updated, and every frame's pairs are asked for. Row i of the scene is object i and
/// has client data i.
class Stage {
 public:
  /// Throws std::runtime_error if a call is refused, and ArgumentError if there is no such frame.
  Stage(std::string_view partition, FrameSource& source, std::size_t frame);

  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// The frame's pairs that overlap, in canonical order; those of NSquared tested.
  [[nodiscard]] const std::vector<Pair>& pairs() const noexcept { return pairs_; }
  /// How many the partition reported.
  [[nodiscard]] std::size_t reported() const noexcept { return reported_; }

 private:
  void step(std::span<const Aabb> boxes);

  Partition partition_;
  std::vector<Key> keys_;
  std::vector<Aabb> boxes_;
  std::vector<Pair> pairs_;
  std::size_t reported_ = 0;
};

/// Throws std::runtime_error unless the call was accepted.
void require_ok(Status status, const char* call);

}  // namespace winnow::bench
