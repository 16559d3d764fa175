#pragma once

// Traversals of implicit 16-ary trees, over blocks of rows or over triangles of a mesh. The
// children of node i of level l + 1 are the nodes [16 i, 16 i + 16) of level l, whose boxes are
// tested at once; the nodes of the top level have no parent. `traverse` visits nodes in the order
// of rows, `JointTraversal` runs many queries together, and `descend` visits the nearest nodes
// first.

#include "partitions/tree/block_tree.kernel.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// How a traversal continues after a visit: with the node's children, past them, or not at all.
enum class Next : std::uint8_t { below, past, stop };

/// Calls visit(level, node) for every node that passes test(level, first of 16 nodes), parents
/// before children. Its state is one mask and one node index per level, so it needs no stack.
/// Returns false if a visit stopped it.
template <std::uint32_t MaxLevels, typename Test, typename Visit>
[[gnu::always_inline]] inline bool traverse(std::uint32_t levels, Test&& test, Visit&& visit) {
  Mask16 open[MaxLevels];
  std::uint32_t base[MaxLevels];
  std::uint32_t level = levels - 1;
  std::uint32_t node = 0;
  for (Next next = Next::below;;) {
    if (next == Next::below) {
      base[level] = node * kLanes;
      open[level] = test(level, base[level]);
    }
    while (open[level] == 0) {
      if (++level == levels) return true;
    }
    node = base[level] + first(open[level]);
    open[level] &= open[level] - 1;
    next = visit(level, node);
    if (next == Next::stop) return false;
    if (next == Next::below) --level;
  }
}

/// Calls visit(node) for every node of level `bottom`, from node `from` on, that passes the test on
/// its own level and all levels above. Stops and returns false if visit returns false.
template <typename Test, typename Visit>
bool traverse_from(const TreeShape& tree, std::uint32_t bottom, std::uint32_t from, Test&& test,
                   Visit&& visit) {
  return traverse<kMaxTreeLevels>(
      tree.levels,
      [&](std::uint32_t level, std::uint32_t first_node) {
        Mask16 hits = test(level, first_node);
        // Skips nodes that end before `from`.
        const std::uint32_t first_needed = from >> (4 * (level - bottom));
        if (first_needed > first_node) {
          const std::uint32_t skip = first_needed - first_node;
          hits &= ~lanes_below(skip < kLanes ? skip : kLanes);
        }
        return hits;
      },
      [&](std::uint32_t level, std::uint32_t node) {
        if (level != bottom) return Next::below;
        return visit(node) ? Next::past : Next::stop;
      });
}

/// Pairs of a query and a node (or row) that are still to be processed.
struct QueryNodeList {
  static constexpr unsigned kRoom = 256;

  unsigned size = 0;
  std::uint32_t query[kRoom + kLanes];
  std::uint32_t at[kRoom + kLanes];

  /// True if there may be no room for 16 more.
  [[nodiscard]] bool full() const { return size > kRoom - kLanes; }
  void add(std::uint32_t q, std::uint32_t first_at, Mask16 mask) {
    Uints(q).store_unaligned(query + size);
    size += compress_store(mask, count_from(first_at), at + size);
  }
};

/// Traverses a tree with many queries together, level by level. Nodes to open on a level are listed
/// per level, and a list is processed in one long loop when the next nodes might not fit or when no
/// higher level has remaining nodes. The number of children that pass is unpredictable and each
/// test has a long latency; long loops hide both. The order of visits is unspecified.
///
/// `Queries` provides `auto prepare(tree, level, first query)`, which computes constants of a
/// loop; `Mask16 test(prepared, query, level, first of 16 nodes)`; and `bool visit(blocks)`, which
/// processes a list of reached blocks and returns false to stop the traversal.
template <typename Queries>
class JointTraversal {
 public:
  explicit JointTraversal(Queries& queries) : queries_(queries) {}

  /// Runs queries query_of(0), ..., query_of(count - 1). Returns false if a visit stopped it.
  template <typename QueryOf>
  bool run(const TreeShape& tree, std::uint32_t count, QueryOf&& query_of) {
    if (count == 0) return true;
    tree_ = &tree;
    const std::uint32_t top = tree.levels - 1;
    const auto prepared = queries_.prepare(tree, top, query_of(0U));
    for (std::uint32_t k = 0; k < count; ++k) {
      if (!test(prepared, query_of(k), top, 0)) return false;
    }
    for (std::uint32_t level = top + 1; level-- > 0;) {
      if (!drain(level)) return false;
    }
    return true;
  }

 private:
  /// Adds the nodes among the 16 from `first_node` on that pass the query's test.
  template <typename Prepared>
  bool test(const Prepared& prepared, std::uint32_t q, std::uint32_t level,
            std::uint32_t first_node) {
    if (open_[level].full() && !drain(level)) return false;
    open_[level].add(q, first_node, queries_.test(prepared, q, level, first_node));
    return true;
  }

  bool drain(std::uint32_t level) {
    QueryNodeList& open = open_[level];
    if (open.size == 0) return true;
    if (level == 0) {
      if (!queries_.visit(open)) return false;
    } else {
      const auto prepared = queries_.prepare(*tree_, level - 1, open.query[0]);
      for (unsigned k = 0; k < open.size; ++k) {
        if (!test(prepared, open.query[k], level - 1, open.at[k] * kLanes)) return false;
      }
    }
    open.size = 0;
    return true;
  }

  Queries& queries_;
  const TreeShape* tree_ = nullptr;
  QueryNodeList open_[kMaxTreeLevels];
};

/// Visits nodes of level 0 approximately in the order of a measure, the nearest child first.
/// `OpenNodes` stores open nodes: `bool open(level, first of 16 nodes, node)` tests 16 nodes,
/// returns the one to continue with in `node` and stores the others, or returns false if none
/// passes; `bool pop(level, node)` removes the next stored node, or returns false if there is
/// none. visit(node) returns false to stop the descent.
template <typename OpenNodes, typename Visit>
[[gnu::always_inline]] inline bool descend(std::uint32_t levels, OpenNodes& open_nodes,
                                           Visit&& visit) {
  // The children of this node are opened next; a node of level 0 is visited.
  std::uint32_t level = levels;
  std::uint32_t node = 0;
  do {
    bool reached = true;
    while (reached && level != 0) {
      --level;
      reached = open_nodes.open(level, node * kLanes, node);
    }
    if (reached && !visit(node)) return false;
  } while (open_nodes.pop(level, node));
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME
