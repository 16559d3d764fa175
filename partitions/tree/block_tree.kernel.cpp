// Kernels of BlockTree: refit, self pairs and batch queries. Self pairs run leaf by leaf
// (NearGroups, BlockPairs), or group by group (LeafPairs) if more than one environment is in use.

#include "partitions/tree/block_tree.kernel.h"
#include "partitions/tree/block_pairs.wide.h"
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

/// Returns the nodes among the 16 from `first_node` on, with boxes `nodes`, that box q overlaps and
/// whose filters may match `range`.
Mask16 open_nodes(const TreeShape& tree, std::uint32_t level, std::uint32_t first_node,
                  const Box16& nodes, const QueryBox& q, const FilterRange& range) {
  return passing_nodes(tree, level, first_node, overlap(nodes, q.low, q.high), range);
}

/// Finds pairs between leaves in three long loops, instead of short nested loops whose lengths are
/// unpredictable: pairs of leaves whose boxes overlap; for each, the rows of the first leaf that
/// overlap the second's box; for each such row, its hits among the second leaf's rows. Each loop
/// drops the leaves, rows or hits that filters exclude.
class LeafPairs {
 public:
  LeafPairs(const TreeView& tree, PairSink& sink)
      : tree_(tree), sink_(sink), hits_(tree.rows, sink), sure_(tree.rows, sink) {}

  /// Adds all pairs of leaf i with leaves base + j for each bit j of `js`.
  bool add(std::uint32_t i, std::uint32_t base, Mask16 js) {
    if (leaves_ > kLeafRoom - kLanes && !find_rows()) return false;
    Uints(i).store_unaligned(first_ + leaves_);
    leaves_ += compress_store(js, count_from(base), second_ + leaves_);
    return true;
  }

  /// Adds all pairs within a leaf.
  bool add_self(std::uint32_t leaf) {
    const FilterRange range = range_of(tree_.filters[0], leaf);
    if (!filters_allow(range, range)) return true;
    return add_rows(leaf * kLanes, leaf, 0x7FFFU);
  }

  bool finish() { return find_rows() && test_rows() && hits_.flush() && sure_.flush(); }

 private:
  static constexpr unsigned kLeafRoom = 512;
  static constexpr unsigned kRowRoom = 1024;

  [[nodiscard]] std::size_t row_of(std::uint32_t leaf) const {
    return (std::size_t{tree_.first_block} + leaf) * kLanes;
  }

  bool add_rows(std::uint32_t first_row, std::uint32_t leaf, Mask16 mask) {
    if (rows_ > kRowRoom - kLanes && !test_rows()) return false;
    Uints(leaf).store_unaligned(leaf_ + rows_);
    rows_ += compress_store(mask, count_from(first_row), row_ + rows_);
    return true;
  }

  bool find_rows() {
    for (unsigned k = 0; k < leaves_; ++k) {
      const QueryBox b(tree_.node[0], second_[k]);
      const Box16 a = load_slabs<3>(tree_.rows.column, row_of(first_[k]));
      Mask16 rows = overlap(a, b.low, b.high);
      // If the leaf has one environment, filters are tested only on hits: testing each row first
      // costs more.
      const FilterRange own = range_of(tree_.filters[0], first_[k]);
      if (own.first_environment != own.last_environment) {
        const auto first_row = static_cast<std::uint32_t>(row_of(first_[k]));
        rows = passing_rows(tree_.rows, first_row, rows, range_of(tree_.filters[0], second_[k]));
      }
      if (!add_rows(first_[k] * kLanes, second_[k], rows)) return false;
    }
    sink_.tests += leaves_;
    leaves_ = 0;
    return true;
  }

  bool test_rows() {
    const std::size_t base = row_of(0);
    for (unsigned k = 0; k < rows_; ++k) {
      const std::size_t r = base + row_[k];
      const std::size_t at = base + std::size_t{leaf_[k]} * kLanes;
      const Box16 b = load_slabs<3>(tree_.rows.column, at);
      const QueryBox q(tree_.rows.column, r);
      // Within a leaf tests only rows behind r, so that each pair is found once.
      const bool self = row_[k] / kLanes == leaf_[k];
      const Mask16 lanes = self ? ~lanes_below(row_[k] % kLanes + 1) : ~0U;
      if (!hits_.make_room() || !sure_.make_room()) return false;
      const Mask16 overlapping = overlap(b, q.low, q.high) & lanes;
      // If all rows of each leaf have the same filter, the test of the leaves decides for all hits.
      const bool sure = is_alike(row_[k] / kLanes) && is_alike(leaf_[k]);
      const auto at_row = static_cast<std::uint32_t>(at);
      sure_.add(static_cast<std::uint32_t>(r), at_row, sure ? overlapping : 0);
      hits_.add(static_cast<std::uint32_t>(r), at_row, sure ? 0 : overlapping);
    }
    sink_.tests += rows_;
    rows_ = 0;
    return true;
  }

  [[nodiscard]] bool is_alike(std::uint32_t leaf) const {
    return tree_.filters[0].alike[leaf] != 0;
  }

  const TreeView& tree_;
  PairSink& sink_;
  HitList<true> hits_;
  HitList<false> sure_;
  unsigned leaves_ = 0;
  unsigned rows_ = 0;
  std::uint32_t first_[kLeafRoom + kLanes];
  std::uint32_t second_[kLeafRoom + kLanes];
  std::uint32_t row_[kRowRoom + kLanes];  // relative to the tree's first row
  std::uint32_t leaf_[kRowRoom + kLanes];
};

/// Adds all pairs of leaves `is` of group g with leaves of group h >= g.
bool group_pair(const TreeView& tree, std::uint32_t g, std::uint32_t h, Mask16 is, LeafPairs& pairs,
                PairSink& sink) {
  const Box16 h_leaves = load_slabs<3>(tree.node[0], std::size_t{h} * kLanes);
  sink.tests += count(is);
  for (; is != 0; is &= is - 1) {
    const std::uint32_t i = g * kLanes + first(is);
    const QueryBox a(tree.node[0], i);
    Mask16 js = open_nodes(tree, 0, h * kLanes, h_leaves, a, range_of(tree.filters[0], i));
    if (g == h) js &= ~lanes_below(first(is) + 1);
    if (!pairs.add(i, h * kLanes, js)) return false;
  }
  return true;
}

/// Finds pairs of rows of several environments, group by group, and skips nodes that filters
/// exclude.
bool find_pairs_of_environments(const TreeView& tree, std::uint32_t begin, std::uint32_t end,
                                PairSink& sink) {
  LeafPairs pairs(tree, sink);
  for (std::uint32_t g = begin; g < end; ++g) {
    const std::uint32_t last =
        tree.count[0] - g * kLanes < kLanes ? tree.count[0] - g * kLanes : kLanes;
    for (std::uint32_t i = 0; i < last; ++i) {
      if (!pairs.add_self(g * kLanes + i)) return false;
    }
    if (!group_pair(tree, g, g, lanes_below(last), pairs, sink)) return false;
    if (tree.levels == 1) continue;
    const Box16 g_leaves = load_slabs<3>(tree.node[0], std::size_t{g} * kLanes);
    const QueryBox g_box(tree.node[1], g);
    const FilterRange g_range = range_of(tree.filters[1], g);
    const auto test = [&](std::uint32_t level, std::uint32_t first_node) {
      ++sink.tests;
      const Box16 nodes = load_slabs<3>(tree.node[level], first_node);
      return open_nodes(tree, level, first_node, nodes, g_box, g_range);
    };
    const auto visit = [&](std::uint32_t h) {
      ++sink.tests;
      const QueryBox h_box(tree.node[1], h);
      const Mask16 is =
          open_nodes(tree, 0, g * kLanes, g_leaves, h_box, range_of(tree.filters[1], h));
      return group_pair(tree, g, h, is, pairs, sink);
    };
    if (!traverse_from(tree, 1, g + 1, test, visit)) return false;
  }
  return pairs.finish();
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

/// Returns the 16 nodes from `first_node` on that a box overlaps. Force-inlined, because a call
/// would pass the box through memory.
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
    if (tree_.levels == 1) return;
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

  /// Calls visit(group), in order, for groups that overlap a box of the current group and may match
  /// the filter. Stops and returns false if visit returns false.
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
