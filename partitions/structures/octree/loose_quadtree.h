#pragma once

#include "partitions/structures/octree/loose_octree.h"

namespace winnow {

/// The loose octree in two dimensions: the two axes with the most room are divided, and edges along
/// the third put no object on a coarser level. Suits flat worlds. Exact.
class LooseQuadtree final : public LooseOctree {
 public:
  explicit LooseQuadtree(const PartitionOptions& options = {}, const LooseOctreeOptions& loose = {})
      : LooseOctree(options, loose, 2) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "LooseQuadtree"; }
};

}  // namespace winnow
