#pragma once

#include <winnow/partitions/row_partition.h>

namespace winnow {

/// Linear bounding-volume hierarchy: rows sorted by size class and place on a space-filling curve
/// (Lauterbach et al., "Fast BVH construction on GPUs", Computer Graphics Forum 28(2), 2009; here
/// Hilbert's curve), blocks of 16 rows as leaves, and above them implicit nodes of 16 children that
/// one compare tests at once. A frame refits the nodes above what moved; the order is made anew
/// when refitting has cost more tests than a build is worth. No parameter, no world bounds; suits
/// every scene, mixed sizes included. Self pairs: O(n log n + pairs) for boxes of bounded overlap.
/// Exact.
class LinearBvh final : public RowPartition {
 public:
  explicit LinearBvh(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "LinearBvh"; }
};

}  // namespace winnow
