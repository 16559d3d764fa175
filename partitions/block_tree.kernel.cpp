#include <winnow/partitions/block_tree.kernel.h>
#include <winnow/partitions/hits.kernel.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

void reduce(const float* const* from, std::size_t i, float* const* to) {
  for (int s = 0; s < 3; ++s) {
    to[s][i] = reduce_min(load(from[s] + i * kLanes));
    to[3 + s][i] = reduce_max(load(from[3 + s] + i * kLanes));
  }
}

void refit_leaves(const TreeView& tree, std::uint32_t begin, std::uint32_t end) {
  const float* shifted[6];
  for (int c = 0; c < 6; ++c) {
    shifted[c] = tree.rows.column[c] + std::size_t{tree.first_block} * kLanes;
  }
  for (std::uint32_t i = begin; i < end; ++i) reduce(shifted, i, tree.node[0]);
}

void refit_nodes(const TreeView& tree, std::uint32_t level, std::uint32_t begin,
                 std::uint32_t end) {
  for (std::uint32_t i = begin; i < end; ++i) reduce(tree.node[level - 1], i, tree.node[level]);
}

/// Calls visit(child, box query) for every node of `stop` level that overlaps `q`, in order, from
/// node `from` on. One mask per level is all the state a walk needs: depth is bounded by the number
/// of objects, not by a stack. False as soon as visit says false.
template <typename Visit>
bool walk(const TreeView& tree, const QueryBox& q, std::uint32_t stop, std::uint32_t from,
          PairSink& sink, Visit&& visit) {
  Mask16 open[kMaxTreeLevels];
  std::uint32_t base[kMaxTreeLevels];
  std::uint32_t level = tree.levels - 1;
  const auto enter = [&](std::uint32_t first_node) {
    base[level] = first_node;
    ++sink.tests;
    const Box16 nodes = load_slabs<3>(tree.node[level], first_node);
    Mask16 hits = overlap(nodes, q.low, q.high);
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

/// Rows of block `leaf` that overlap node box b of level 0.
Mask16 rows_touching(const TreeView& tree, std::uint32_t leaf, const QueryBox& b, PairSink& sink) {
  ++sink.tests;
  const Box16 rows =
      load_slabs<3>(tree.rows.column, (std::size_t{tree.first_block} + leaf) * kLanes);
  return overlap(rows, b.low, b.high);
}

/// Pairs of leaf `i` with the leaves `js` of a group that starts at leaf `base`, all after i.
bool leaf_against_group(const TreeView& tree, std::uint32_t i, std::uint32_t base, Mask16 js,
                        PairSink& sink) {
  const std::size_t a = std::size_t{tree.first_block} + i;
  const Box16 a_box = load_slabs<3>(tree.rows.column, a * kLanes);
  for (; js != 0; js &= js - 1) {
    const std::uint32_t j = base + first(js);
    const QueryBox b_bounds(tree.node[0], j);
    ++sink.tests;
    const Mask16 a_rows = overlap(a_box, b_bounds.low, b_bounds.high);
    if (a_rows == 0) continue;
    if (!has_room(sink)) return false;
    const std::size_t b = std::size_t{tree.first_block} + j;
    block_pair(tree.rows, a, a_rows, load_slabs<3>(tree.rows.column, b * kLanes),
               load_unaligned(tree.rows.id + b * kLanes), sink);
  }
  return true;
}

/// All pairs of leaves between group g and group h >= g.
bool group_pair(const TreeView& tree, std::uint32_t g, std::uint32_t h, Mask16 is, PairSink& sink) {
  const Box16 h_leaves = load_slabs<3>(tree.node[0], std::size_t{h} * kLanes);
  for (; is != 0; is &= is - 1) {
    const std::uint32_t i = g * kLanes + first(is);
    const QueryBox a(tree.node[0], i);
    ++sink.tests;
    Mask16 js = overlap(h_leaves, a.low, a.high);
    if (g == h) js &= ~lanes_below(first(is) + 1);
    if (js != 0 && !leaf_against_group(tree, i, h * kLanes, js, sink)) return false;
  }
  return true;
}

bool self_pairs(const TreeView& tree, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  for (std::uint32_t g = begin; g < end; ++g) {
    const std::uint32_t last =
        tree.count[0] - g * kLanes < kLanes ? tree.count[0] - g * kLanes : kLanes;
    for (std::uint32_t i = 0; i < last; ++i) {
      if (!has_room(sink)) return false;
      block_self(tree.rows, std::size_t{tree.first_block} + g * kLanes + i, sink);
    }
    if (!group_pair(tree, g, g, lanes_below(last), sink)) return false;
    if (tree.levels == 1) continue;
    const Box16 g_leaves = load_slabs<3>(tree.node[0], std::size_t{g} * kLanes);
    const QueryBox g_box(tree.node[1], g);
    const bool done = walk(tree, g_box, 1, g + 1, sink, [&](std::uint32_t h) {
      const QueryBox h_box(tree.node[1], h);
      ++sink.tests;
      const Mask16 is = overlap(g_leaves, h_box.low, h_box.high);
      return is == 0 || group_pair(tree, g, h, is, sink);
    });
    if (!done) return false;
  }
  return true;
}

struct Query {
  template <HitMode Mode>
  static bool run(const TreeView& tree, const QueryBatch& batch, PairSink& sink) {
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      const std::uint32_t id = batch.id[row];
      const QueryBox q(batch.column, row);
      const bool done = walk(tree, q, 0, 0, sink, [&](std::uint32_t leaf) {
        const Mask16 hits = rows_touching(tree, leaf, q, sink);
        if (hits == 0) return true;
        if (!has_room(sink)) return false;
        const std::size_t at = (std::size_t{tree.first_block} + leaf) * kLanes;
        report<Mode>(hits, tree.rows.id + at, id, batch.moved, sink);
        return true;
      });
      if (!done) return false;
    }
    return true;
  }
};

bool query(const TreeView& tree, const QueryBatch& batch, PairSink& sink) {
  return with_mode<Query>(tree, batch, sink);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BlockTreeKernels WINNOW_KERNEL_TABLE(block_tree_kernels) = {
    WINNOW_ISA_NAME::refit_leaves, WINNOW_ISA_NAME::refit_nodes, WINNOW_ISA_NAME::self_pairs,
    WINNOW_ISA_NAME::query};

}  // namespace winnow
