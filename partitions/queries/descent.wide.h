#pragma once

// Traversal of a partition's blocks by a query, in row order or nearest first, and the filter that
// all queries share. A query passes a probe, which tests 16 boxes at once, and a function for the
// blocks of rows that are reached. Used by the kernels of casts, regions and nearest queries.

#include "partitions/index/query_view.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/positive_min_max.h"

namespace winnow::WINNOW_ISA_NAME {

/// Filters the nodes and rows that a query may return.
class CandidateFilter {
 public:
  CandidateFilter(const QueryView& view, const QueryFilter& filter)
      : view_(view), filter_(filter) {}

  [[nodiscard]] Mask16 nodes(const TreeShape& tree, std::uint32_t level, std::uint32_t first_node,
                             Mask16 candidates) const {
    if (!filter_.by_object) return candidates;
    return passing_nodes(tree, level, first_node, candidates, range_of(filter_.object));
  }
  [[nodiscard]] Mask16 rows(std::uint32_t first_row, Mask16 candidates) const {
    if (!filter_.by_object) return candidates;
    return passing_rows(view_.filter, view_.span.environments, first_row, candidates,
                        range_of(filter_.object));
  }
  /// True if the caller has a predicate.
  [[nodiscard]] bool has_predicate() const { return filter_.accept != nullptr; }
  /// Returns the result of the caller's predicate.
  [[nodiscard]] bool accepts(std::uint32_t id) const {
    return filter_.accept == nullptr || filter_.accept(filter_.context, id);
  }

 private:
  const QueryView& view_;
  const QueryFilter& filter_;
};

/// Returns the bits of a float >= 0, which sort like the float. The sign is masked out, because the
/// value may be -0: min_t of a cast may be.
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

/// Returns `order_of` the largest float <= value; requires value >= 0.
inline std::uint32_t order_of_rounded_down(double value) {
  if (value >= static_cast<double>(kLargest<float>)) return order_of(kLargest<float>);
  const auto nearest = static_cast<float>(value);
  return order_of(nearest) - (static_cast<double>(nearest) > value ? 1U : 0U);
}

/// Upper bound of the order of a node; a larger value means that there is no node.
inline constexpr float kMaxOrder = 1e38F;

/// The open nodes of `descend`, depth first and the nearest child first. Each level stores the 16
/// siblings opened last, with a key each; siblings with keys up to done_to_ are done. A key is the
/// node's order with the lane in its low four bits, so that keys of siblings are distinct. Keys are
/// positive, although an order may be -0. Probe: `Mask16 test(columns, at, limit, Floats& order)`,
/// where order is in [0, kMaxOrder], and infinite in lanes that fail.
template <typename Probe>
class OpenNodes {
 public:
  /// `limit` may be lowered between visits.
  OpenNodes(const QueryView& view, const TreeShape& tree, const Probe& probe,
            const CandidateFilter& candidate_filter, const float& limit)
      : view_(view),
        tree_(tree),
        probe_(probe),
        candidate_filter_(candidate_filter),
        limit_(limit) {}

  [[gnu::always_inline]] bool open(std::uint32_t level, std::uint32_t first_node,
                                   std::uint32_t& node) {
    Floats order;
    const Mask16 reached = probe_.test(tree_.node[level], first_node, limit_, order);
    const Mask16 mask = candidate_filter_.nodes(tree_, level, first_node, reached);
    if (mask == 0) return false;
    if (level == 0) fetch_rows(first_node, mask);
    key_of(order).store(key_[level]);
    if (mask != reached) [[unlikely]]
      leave_out(reached & ~mask, key_[level]);
    const std::uint32_t nearest = reduce_min_positive(Floats::load(key_[level]));
    mark_done(nearest, level);
    first_node_[level] = first_node;
    open_ |= ((mask & (mask - 1)) != 0 ? 1U : 0U) << level;
    node = first_node + nearest % kLanes;
    return true;
  }

  /// Returns the nearest remaining sibling of the lowest open level, if it is within the limit.
  [[gnu::always_inline]] bool pop(std::uint32_t& level, std::uint32_t& node) {
    const std::uint32_t last = order_of(last_key());
    while (open_ != 0) {
      level = static_cast<std::uint32_t>(__builtin_ctz(open_));
      const Floats key = Floats::load(key_[level]);
      const Floats left = select(key > Floats(done_to_[level]), key, Floats(kLargest<float>));
      const std::uint32_t nearest = reduce_min_positive(left);
      if (nearest <= last) {
        mark_done(nearest, level);
        const Mask16 others = bits((key > Floats(done_to_[level])) & (key <= Floats(kMaxKey)));
        open_ ^= (others == 0 ? 1U : 0U) << level;
        node = first_node_[level] + nearest % kLanes;
        return true;
      }
      open_ &= open_ - 1;
    }
    return false;
  }

 private:
  static constexpr float kMinOrder = 0x1p-100F;
  static constexpr float kMaxKey = kMaxOrder * (1.0F + 0x1p-18F);

  static Floats key_of(const Floats& order) {
    alignas(64) static constexpr std::uint32_t kEach[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                8, 9, 10, 11, 12, 13, 14, 15};
    const Floats positive =
        smaller_positive(max(order, Floats(kMinOrder)), Floats(kLargest<float>));
    const Floats without_number(value_of(~(kLanes - 1U)));
    return (positive & without_number) | Floats::load(reinterpret_cast<const float*>(kEach));
  }
  /// Upper bound of the keys of nodes within the limit.
  [[nodiscard]] float last_key() const {
    const float most = limit_ < kMaxOrder ? limit_ : kMaxOrder;
    return value_of(order_of(most > kMinOrder ? most : kMinOrder) | (kLanes - 1U));
  }
  /// Prefetches the rows of blocks that are visited later. Always inline: compilers remove calls of
  /// functions that only prefetch.
  [[gnu::always_inline]] void fetch_rows(std::uint32_t first_block, Mask16 blocks) const {
    for (; blocks != 0; blocks &= blocks - 1) {
      const std::size_t block = tree_.first_block + first_block + first(blocks);
      for (const float* const column : view_.column) __builtin_prefetch(column + block * kLanes);
    }
  }
  static void leave_out(Mask16 lanes, float* key) {
    for (; lanes != 0; lanes &= lanes - 1) key[first(lanes)] = kLargest<float>;
  }
  void mark_done(std::uint32_t key, std::uint32_t level) { done_to_[level] = value_of(key); }

  const QueryView& view_;
  const TreeShape& tree_;
  const Probe& probe_;
  const CandidateFilter& candidate_filter_;
  const float& limit_;
  /// A bit per level that has remaining siblings.
  std::uint32_t open_ = 0;
  std::uint32_t first_node_[kMaxTreeLevels];
  float done_to_[kMaxTreeLevels];
  alignas(64) float key_[kMaxTreeLevels][kLanes];
};

/// Visits all blocks that the probe reaches within a limit, in row order. `visit(first_row)`
/// returns false to end the traversal.
template <typename Probe, typename Visit>
bool visit_in_row_order(const QueryView& view, const Probe& probe,
                        const CandidateFilter& candidate_filter, float limit, Visit&& visit) {
  for (std::uint32_t block = 0; block < view.flat_blocks; ++block) {
    if (!visit(block * kLanes)) return false;
  }
  for (std::uint32_t t = 0; t < view.trees; ++t) {
    const TreeShape& tree = *view.tree[t];
    const bool whole = traverse<kMaxTreeLevels>(
        tree.levels,
        [&](std::uint32_t level, std::uint32_t first_node) {
          const Mask16 reached = probe.test(tree.node[level], first_node, limit);
          return candidate_filter.nodes(tree, level, first_node, reached);
        },
        [&](std::uint32_t level, std::uint32_t node) {
          if (level != 0) return Next::below;
          return visit((tree.first_block + node) * kLanes) ? Next::past : Next::stop;
        });
    if (!whole) return false;
  }
  return true;
}

/// Visits blocks that the probe reaches within `limit`, approximately nearest first in each tree;
/// the second tree starts with the limit that the first one left. A visit may lower the limit.
/// `visit(first_row)` returns false to end the descent.
template <typename Probe, typename Visit>
bool visit_nearest_first(const QueryView& view, const Probe& probe,
                         const CandidateFilter& candidate_filter, const float& limit,
                         Visit&& visit) {
  for (std::uint32_t block = 0; block < view.flat_blocks; ++block) {
    if (!visit(block * kLanes)) return false;
  }
  for (std::uint32_t t = 0; t < view.trees; ++t) {
    const TreeShape& tree = *view.tree[t];
    OpenNodes<Probe> open(view, tree, probe, candidate_filter, limit);
    const bool whole = descend(tree.levels, open, [&](std::uint32_t node) {
      return visit((tree.first_block + node) * kLanes);
    });
    if (!whole) return false;
  }
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME
