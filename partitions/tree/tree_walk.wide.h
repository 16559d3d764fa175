#pragma once

#include "partitions/tree/block_tree.kernel.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Calls visit(node) for every node of `stop` level that test(level, first of 16 nodes) lets
/// through on each level above and its own, in order, from node `from` on. One mask per level is
/// all the state a walk needs: depth is bounded by the number of objects, not by a stack. False as
/// soon as visit says false.
template <typename Test, typename Visit>
bool walk(const TreeView& tree, std::uint32_t stop, std::uint32_t from, Test&& test,
          Visit&& visit) {
  Mask16 open[kMaxTreeLevels];
  std::uint32_t base[kMaxTreeLevels];
  std::uint32_t level = tree.levels - 1;
  const auto enter = [&](std::uint32_t first_node) {
    base[level] = first_node;
    Mask16 hits = test(level, first_node);
    // Nodes that end before `from` hold nothing to visit.
    const std::uint32_t first_wanted = from >> (4 * (level - stop));
    if (first_wanted > first_node) {
      const std::uint32_t skip = first_wanted - first_node;
      hits &= ~lanes_below(skip < kLanes ? skip : kLanes);
    }
    open[level] = hits;
  };
  enter(0);
  for (;;) {
    if (open[level] == 0) {
      if (level == tree.levels - 1) return true;
      ++level;
      continue;
    }
    const std::uint32_t child = base[level] + first(open[level]);
    open[level] &= open[level] - 1;
    if (level == stop) {
      if (!visit(child)) return false;
    } else {
      --level;
      enter(child * kLanes);
    }
  }
}

}  // namespace winnow::WINNOW_ISA_NAME
