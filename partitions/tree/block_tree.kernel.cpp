// Kernels of BlockTree: refit, self pairs and batch queries. Self pairs run leaf by leaf
// (NearGroups, BlockPairs), or group by group (environment_pairs.wide.h) if more than one
// environment is in use.

#include "partitions/tree/block_tree.kernel.h"
#include "partitions/tree/block_pairs.wide.h"
#include "partitions/tree/environment_pairs.wide.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/rows.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Computes nodes [begin, end) of `to`, each from 16 boxes of `from`.
void reduce(const float* const* from, std::uint32_t begin, std::uint32_t end, float* const* to) {
  std::size_t i = begin;
  for (; i + kLanes <= end; i += kLanes) {
    for (int s = 0; s < 3; ++s) {
      reduce_min_rows(from[s] + i * kLanes).store_unaligned(to[s] + i);
      reduce_max_rows(from[3 + s] + i * kLanes).store_unaligned(to[3 + s] + i);
    }
  }
  for (; i < end; ++i) {
    for (int s = 0; s < 3; ++s) {
      to[s][i] = reduce_min(Floats::load(from[s] + i * kLanes));
      to[3 + s][i] = reduce_max(Floats::load(from[3 + s] + i * kLanes));
    }
  }
}

void refit_leaves(const TreeView& tree, std::uint32_t begin, std::uint32_t end) {
  const float* shifted[6];
  for (int c = 0; c < 6; ++c) {
    shifted[c] = tree.rows.column[c] + std::size_t{tree.first_block} * kLanes;
  }
  reduce(shifted, begin, end, tree.node[0]);
}

void refit_nodes(const TreeView& tree, std::uint32_t level, std::uint32_t begin,
                 std::uint32_t end) {
  reduce(tree.node[level - 1], begin, end, tree.node[level]);
}

/// Filter tests between a leaf and nodes that it overlaps, in a tree of one environment.
template <bool Filtered>
class LeafFilter {
 public:
  LeafFilter(const TreeView& tree, std::uint32_t leaf) {
    if constexpr (!Filtered) return;
    own_ = range_of(tree.filters[0], leaf);
    matches_all_ = surely_match(span_of(tree.filters[0], leaf), tree.rows.span);
  }

  /// True if no row of the leaf matches another row of the leaf.
  [[nodiscard]] bool excludes_self_pairs() const { return decides() && !filters_allow(own_, own_); }

  /// True if filters must be tested on hits of the leaf's rows. A test of all hits is cheaper than
  /// a decision for each hit whether it needs the test.
  [[nodiscard]] bool decides() const { return Filtered && !matches_all_; }

  /// Returns the nodes of `candidates` whose filters may match the leaf; their layers and masks are
  /// at `at`.
  [[nodiscard]] Mask16 passing_lanes(const std::uint32_t* layers, const std::uint32_t* mask,
                                     std::uint32_t at, Mask16 candidates) const {
    return decides() ? candidates & matching_lanes(layers, mask, at, own_) : candidates;
  }

 private:
  FilterRange own_{};
  bool matches_all_ = false;
};

/// Returns the nodes among the 16 from `first_node` on that a box overlaps. Force-inlined, because
/// a call would pass the box through memory.
[[gnu::always_inline]] inline Mask16 touched_nodes(const TreeView& tree, PairSink& sink,
                                                   std::uint32_t level, std::uint32_t first_node,
                                                   const float* low, const float* high) {
  ++sink.tests;
  return overlap(load_slabs<3>(tree.node[level], first_node), low, high);
}

/// The groups of leaves that the leaves of one group may overlap, with copies of their boxes and
/// filters in contiguous memory. Each leaf tests these groups instead of traversing the tree,
/// because the steps of a traversal depend on each other.
template <bool Filtered>
class NearGroups {
 public:
  NearGroups(const TreeView& tree, PairSink& sink) : tree_(tree), sink_(sink) {}

  /// Finds the groups, from the group itself on.
  void find(std::uint32_t group) {
    count_ = 0;
    first_ = group;
    if (tree_.levels == 1) return;  // one group
    const QueryBox own(tree_.node[1], group);
    complete_ = traverse_from(
        tree_, 1, group,
        [&](std::uint32_t level, std::uint32_t first_node) {
          return touched_nodes(tree_, sink_, level, first_node, own.low, own.high);
        },
        [&](std::uint32_t node) { return add(node); });
    for (unsigned k = count_; k % kLanes != 0; ++k) {
      for (int c = 0; c < 6; ++c) box_[c][k] = c < 3 ? __builtin_inff() : -__builtin_inff();
    }
  }

  /// Calls visit(group), in order, for groups that overlap a box within the current group and may
  /// match the filter. Stops and returns false if visit returns false.
  template <typename Visit>
  bool for_each(const float* low, const float* high, const LeafFilter<Filtered>& filter,
                Visit&& visit) {
    if (tree_.levels == 1) return visit(0);
    if (!complete_) return search_tree(low, high, filter, visit);
    for (unsigned at = 0; at < count_; at += kLanes) {
      const float* const columns[6] = {box_[0], box_[1], box_[2], box_[3], box_[4], box_[5]};
      ++sink_.tests;
      const Mask16 touched = overlap(load_slabs<3>(columns, at), low, high);
      for (Mask16 passing = filter.passing_lanes(layers_, mask_, at, touched); passing != 0;
           passing &= passing - 1) {
        if (!visit(group_[at + first(passing)])) return false;
      }
    }
    return true;
  }

 private:
  // Groups of very large objects may overlap more groups; then each leaf traverses the tree.
  static constexpr unsigned kRoom = 128;

  bool add(std::uint32_t node) {
    if (count_ == kRoom) return false;
    for (int c = 0; c < 6; ++c) box_[c][count_] = tree_.node[1][c][node];
    if constexpr (Filtered) {
      layers_[count_] = tree_.filters[1].layers[node];
      mask_[count_] = tree_.filters[1].mask[node];
    }
    group_[count_++] = node;
    return true;
  }

  template <typename Visit>
  bool search_tree(const float* low, const float* high, const LeafFilter<Filtered>& filter,
                   Visit& visit) {
    const auto test = [&](std::uint32_t level, std::uint32_t first_node) {
      const Mask16 touched = touched_nodes(tree_, sink_, level, first_node, low, high);
      // Nodes on higher levels are pruned only by position: testing their filters costs more than
      // it saves.
      const NodeFilters& nodes = tree_.filters[1];
      return level > 1 ? touched
                       : filter.passing_lanes(nodes.layers, nodes.mask, first_node, touched);
    };
    return traverse_from(tree_, 1, first_, test, visit);
  }

  const TreeView& tree_;
  PairSink& sink_;
  bool complete_ = true;
  std::uint32_t first_ = 0;
  unsigned count_ = 0;
  std::uint32_t group_[kRoom];
  std::uint32_t layers_[kRoom];  // if filters are in use
  std::uint32_t mask_[kRoom];
  alignas(64) float box_[6][kRoom];
};

/// Finds pairs of rows without filters, or of one environment, leaf by leaf.
template <bool Filtered>
bool find_pairs_of_leaves(const TreeView& tree, std::uint32_t begin, std::uint32_t end,
                          PairSink& sink) {
  BlockPairs<Filtered> pairs(tree.rows, sink);
  NearGroups<Filtered> near(tree, sink);
  const NodeFilters& filters = tree.filters[0];
  const std::uint32_t last = tree.count[0] < end * kLanes ? tree.count[0] : end * kLanes;
  for (std::uint32_t leaf = begin * kLanes; leaf < last; ++leaf) {
    if (leaf % kLanes == 0) near.find(leaf / kLanes);
    const std::uint32_t row = (tree.first_block + leaf) * kLanes;
    const LeafFilter<Filtered> filter(tree, leaf);
    if (!pairs.start(row, row + kLanes, filter.excludes_self_pairs(), filter.decides())) continue;
    const auto visit = [&](std::uint32_t group) {
      const Mask16 touched =
          touched_nodes(tree, sink, 0, group * kLanes, pairs.low(), pairs.high());
      Mask16 leaves = filter.passing_lanes(filters.layers, filters.mask, group * kLanes, touched);
      if (group == leaf / kLanes) leaves &= ~lanes_below(leaf % kLanes + 1);
      return pairs.add_blocks(tree.first_block + group * kLanes, leaves);
    };
    if (!near.for_each(pairs.low(), pairs.high(), filter, visit) || !pairs.finish()) return false;
  }
  return true;
}

bool self_pairs(const TreeView& tree, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  if (!are_filtered(tree.rows)) return find_pairs_of_leaves<false>(tree, begin, end, sink);
  return tree.rows.environments ? find_pairs_of_environments(tree, begin, end, sink)
                                : find_pairs_of_leaves<true>(tree, begin, end, sink);
}

/// Traverses the tree with all boxes of a batch together.
template <bool Filtered>
class BoxQueries {
 public:
  BoxQueries(const TreeView& tree, const QueryBatch& batch, PairSink& sink)
      : tree_(tree),
        batch_(batch),
        sink_(sink),
        filters_(batch),
        environments_(tree.environments),
        hits_(tree.rows, batch, sink) {}

  bool run() {
    const auto row_of = [&](std::uint32_t k) {
      return batch_.rows != nullptr ? batch_.rows[batch_.begin + k] : batch_.begin + k;
    };
    return traversal_.run(tree_, batch_.end - batch_.begin, row_of) && hits_.flush();
  }

 private:
  friend JointTraversal<BoxQueries>;
  struct NoConstants {};

  [[nodiscard]] static NoConstants prepare(const TreeShape&, std::uint32_t, std::uint32_t) {
    return {};
  }

  /// Returns the nodes among the 16 from `first_node` on that box `row` overlaps and may match.
  Mask16 test(NoConstants, std::uint32_t row, std::uint32_t level, std::uint32_t first_node) {
    const QueryBox q(batch_.column, row);
    Mask16 mask = overlap(load_slabs<3>(tree_.node[level], first_node), q.low, q.high);
    if (Filtered && (level <= 1 || environments_)) {
      mask = passing_nodes(tree_, level, first_node, mask, filters_.of(row));
    }
    ++sink_.tests;
    return mask;
  }

  bool visit(const QueryNodeList& blocks) {
    for (unsigned k = 0; k < blocks.size; ++k) {
      const std::uint32_t row = blocks.query[k];
      const std::uint32_t at = (tree_.first_block + blocks.at[k]) * kLanes;
      const QueryBox q(batch_.column, row);
      if (!hits_.make_room()) return false;
      hits_.add(row, at, overlap(load_slabs<3>(tree_.rows.column, at), q.low, q.high));
      ++sink_.tests;
    }
    return true;
  }

  const TreeView& tree_;
  const QueryBatch& batch_;
  PairSink& sink_;
  const QueryFilters filters_;
  // True if there are several environments, which may overlap in space: then filters are tested on
  // all levels. Otherwise higher levels are pruned only by position.
  const bool environments_;
  HitList<Filtered> hits_;
  JointTraversal<BoxQueries> traversal_{*this};
};

struct TreeQuery {
  template <bool Filtered>
  static bool run(const TreeView& tree, const QueryBatch& batch, PairSink& sink) {
    return BoxQueries<Filtered>(tree, batch, sink).run();
  }
};

bool query(const TreeView& tree, const QueryBatch& batch, PairSink& sink) {
  return with_filters<TreeQuery>(tree, batch, sink);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BlockTreeKernels WINNOW_KERNEL_TABLE(block_tree_kernels) = {
    WINNOW_ISA_NAME::refit_leaves, WINNOW_ISA_NAME::refit_nodes, WINNOW_ISA_NAME::self_pairs,
    WINNOW_ISA_NAME::query};

}  // namespace winnow
