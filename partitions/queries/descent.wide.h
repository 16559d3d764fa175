#pragma once

// The way through a partition's blocks in the order in which a query reaches them, and what all
// queries share. A query brings a probe, which tests 16 boxes at once, and what is to be done with
// the rows that pass.

#include "partitions/index/query_view.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Which candidates a query wants of nodes and rows.
class Wanted {
 public:
  Wanted(const QueryView& view, const QueryFilter& filter) : view_(view), filter_(filter) {}

  [[nodiscard]] Mask16 nodes(const TreeShape& tree, std::uint32_t level, std::uint32_t first_node,
                             Mask16 candidates) const {
    if (!filter_.by_object) return candidates;
    return passing_nodes(tree, level, first_node, candidates, range_of(filter_.object));
  }
  [[nodiscard]] Mask16 rows(std::uint32_t first_row, Mask16 candidates) const {
    if (!filter_.by_object) return candidates;
    return passing_rows(view_.filter, view_.span.apart, first_row, candidates,
                        range_of(filter_.object));
  }
  /// True if the caller has the last word.
  [[nodiscard]] bool asks_caller() const { return filter_.accept != nullptr; }
  /// The caller's last word.
  [[nodiscard]] bool accepts(std::uint32_t id) const {
    return filter_.accept == nullptr || filter_.accept(filter_.context, id);
  }

 private:
  const QueryView& view_;
  const QueryFilter& filter_;
};

/// The bits of a float >= 0, which sort as it does. Zero may have a sign: compilers take 0 + -0 for
/// 0, which it is not where the host rounds down.
inline std::uint32_t order_of(float value) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  return bits & 0x7FFFFFFFU;
}
inline float value_of(std::uint32_t bits) {
  float value;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

/// The order of the largest float <= value; value >= 0.
inline std::uint32_t order_of_rounded_down(double value) {
  if (value >= static_cast<double>(kLargest<float>)) return order_of(kLargest<float>);
  const auto nearest = static_cast<float>(value);
  return order_of(nearest) - (static_cast<double>(nearest) > value ? 1U : 0U);
}

/// The open nodes of a descent, each with the least order that lies below it. What it holds is
/// bounded by the depth of the tree, 16 per level. Probe: `Mask16 test(columns, at, limit, Floats&
/// order)` with order >= 0, and infinite in the lanes that fail.
template <typename Probe>
class OpenNodes {
 public:
  /// `limit` may be lowered from visit to visit.
  OpenNodes(const TreeShape& tree, const Probe& probe, const Wanted& wanted, const float& limit)
      : tree_(tree), probe_(probe), wanted_(wanted), limit_(limit) {}

  /// Only the nearest child is looked for; its siblings wait in no order, so that neither sorting
  /// nor its branches are paid for nodes that the limit will rule out.
  bool open(std::uint32_t level, std::uint32_t first_node, std::uint32_t& node) {
    Floats order;
    Mask16 mask = probe_.test(tree_.node[level], first_node, limit_, order);
    mask = wanted_.nodes(tree_, level, first_node, mask);
    if (mask == 0) return false;
    // The filter may have ruled the nearest out: then any will do.
    const Mask16 least = bits(order <= reduce_min(order)) & mask;
    const unsigned next = first(least != 0 ? least : mask);
    add(mask & ~(1U << next), order, level, first_node);
    node = first_node + next;
    return true;
  }

  /// The last one added that lies within the limit.
  bool take(std::uint32_t& level, std::uint32_t& node) {
    while (size_ != 0) {
      --size_;
      if (order_[size_] > limit_) continue;
      level = node_[size_] >> 28U;
      node = node_[size_] & 0x0FFFFFFFU;
      return true;
    }
    return false;
  }

 private:
  static constexpr unsigned kRoom = kLanes * (kMaxTreeLevels + 1);

  void add(Mask16 mask, const Floats& order, std::uint32_t level, std::uint32_t first_node) {
    compress_store(mask, order, order_ + size_);
    size_ += compress_store(mask, count_from(level << 28U | first_node), node_ + size_);
  }

  const TreeShape& tree_;
  const Probe& probe_;
  const Wanted& wanted_;
  const float& limit_;
  unsigned size_ = 0;
  float order_[kRoom];
  std::uint32_t node_[kRoom];
};

/// Visits all blocks that the probe reaches within a limit, in the order of rows.
/// `visit(first_row)` returns false to end it.
template <typename Probe, typename Visit>
bool visit_in_row_order(const QueryView& view, const Probe& probe, const Wanted& wanted,
                        float limit, Visit&& visit) {
  for (std::uint32_t block = 0; block < view.flat_blocks; ++block) {
    if (!visit(block * kLanes)) return false;
  }
  for (std::uint32_t t = 0; t < view.trees; ++t) {
    const TreeShape& tree = *view.tree[t];
    const bool whole = traverse<kMaxTreeLevels>(
        tree.levels,
        [&](std::uint32_t level, std::uint32_t first_node) {
          const Mask16 reached = probe.test(tree.node[level], first_node, limit);
          return wanted.nodes(tree, level, first_node, reached);
        },
        [&](std::uint32_t level, std::uint32_t node) {
          if (level != 0) return Next::below;
          return visit((tree.first_block + node) * kLanes) ? Next::past : Next::stop;
        });
    if (!whole) return false;
  }
  return true;
}

/// Visits blocks about in the order in which the probe reaches their nodes, as far as `limit` says,
/// which visiting may lower. `visit(first_row)` returns false to end the descent.
template <typename Probe, typename Visit>
bool visit_in_order(const QueryView& view, const Probe& probe, const Wanted& wanted,
                    const float& limit, Visit&& visit) {
  for (std::uint32_t block = 0; block < view.flat_blocks; ++block) {
    if (!visit(block * kLanes)) return false;
  }
  for (std::uint32_t t = 0; t < view.trees; ++t) {
    const TreeShape& tree = *view.tree[t];
    OpenNodes<Probe> open(tree, probe, wanted, limit);
    const bool whole = descend(tree.levels, open, [&](std::uint32_t node) {
      return visit((tree.first_block + node) * kLanes);
    });
    if (!whole) return false;
  }
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME
