#pragma once

#include "partitions/rows/row_partition.h"

namespace winnow {

/// Linearised bounding-volume hierarchy: rows in an order in which every 16, 256, 4096 ... that
/// follow each other are near each other (see kd_order.h), blocks of 16 rows as leaves, and above
/// them implicit nodes of 16 children that one compare tests at once: no pointers, no node that
/// holds anything but boxes. A frame refits the nodes above what moved; the order is made anew when
/// refitting has cost more tests than a build is worth. No parameter, no world bounds; suits every
/// scene, mixed sizes included. Self pairs: O(n log n + pairs) for boxes of bounded overlap. Exact.
class LinearBvh final : public RowPartition {
 public:
  explicit LinearBvh(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "LinearBvh"; }
};

}  // namespace winnow
