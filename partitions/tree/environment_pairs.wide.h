#pragma once

// Self pairs of a block tree whose objects are in several environments. Nodes are tested group by
// group, and filters on every level, because the environments may overlap in space.
// block_tree.kernel.cpp calls find_pairs_of_environments.

#include "partitions/tree/block_tree.kernel.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// Returns the nodes among the 16 from `first_node` on, with boxes `nodes`, that box q overlaps and
/// whose filters may match `range`.
inline Mask16 matching_nodes(const TreeShape& tree, std::uint32_t level, std::uint32_t first_node,
                             const Box16& nodes, const QueryBox& q, const FilterRange& range) {
  return passing_nodes(tree, level, first_node, overlap(nodes, q.low, q.high), range);
}

/// Finds pairs between leaves of several environments in three long loops, instead of short nested
/// loops whose lengths are unpredictable: pairs of leaves whose boxes overlap; for each, the rows
/// of the first leaf that overlap the second's box; for each such row, its hits among the second
/// leaf's rows. Each loop drops the leaves, rows or hits that filters exclude.
class EnvironmentPairs {
 public:
  EnvironmentPairs(const TreeView& tree, PairSink& sink)
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
inline bool group_pair(const TreeView& tree, std::uint32_t g, std::uint32_t h, Mask16 is,
                       EnvironmentPairs& pairs, PairSink& sink) {
  const Box16 h_leaves = load_slabs<3>(tree.node[0], std::size_t{h} * kLanes);
  sink.tests += count(is);
  for (; is != 0; is &= is - 1) {
    const std::uint32_t i = g * kLanes + first(is);
    const QueryBox a(tree.node[0], i);
    Mask16 js = matching_nodes(tree, 0, h * kLanes, h_leaves, a, range_of(tree.filters[0], i));
    if (g == h) js &= ~lanes_below(first(is) + 1);
    if (!pairs.add(i, h * kLanes, js)) return false;
  }
  return true;
}

/// Finds pairs of rows of several environments, group by group, and skips nodes that filters
/// exclude.
inline bool find_pairs_of_environments(const TreeView& tree, std::uint32_t begin, std::uint32_t end,
                                       PairSink& sink) {
  EnvironmentPairs pairs(tree, sink);
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
      return matching_nodes(tree, level, first_node, nodes, g_box, g_range);
    };
    const auto visit = [&](std::uint32_t h) {
      ++sink.tests;
      const QueryBox h_box(tree.node[1], h);
      const Mask16 is =
          matching_nodes(tree, 0, g * kLanes, g_leaves, h_box, range_of(tree.filters[1], h));
      return group_pair(tree, g, h, is, pairs, sink);
    };
    if (!traverse_from(tree, 1, g + 1, test, visit)) return false;
  }
  return pairs.finish();
}

}  // namespace winnow::WINNOW_ISA_NAME
