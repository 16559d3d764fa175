#pragma once

// The way through a partition's blocks in the order in which a query reaches them, and what all
// queries share. A query brings a probe, which tests 16 boxes at once, and what is to be done with
// the rows that pass.

#include "partitions/index/query_view.h"
#include "partitions/tree/hits.wide.h"
#include "partitions/tree/traversal.wide.h"
#include "simd/lanes/positive.h"

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

/// No order of a descent is larger; one that is means that there is none.
inline constexpr float kMostOrder = 1e38F;

/// The open nodes of a descent: of each level the last sixteen, of which those that were gone to
/// come first by their keys. A key is a node's order but for its last four bits, which tell which
/// of the sixteen it is; no two are equal, and none is denormal, which may count as zero. Probe:
/// `Mask16 test(columns, at, limit, Floats& order)` with order in [0, kMostOrder], and infinite in
/// the lanes that fail.
template <typename Probe>
class OpenNodes {
 public:
  /// `limit` may be lowered from visit to visit.
  OpenNodes(const QueryView& view, const TreeShape& tree, const Probe& probe, const Wanted& wanted,
            const float& limit)
      : view_(view), tree_(tree), probe_(probe), wanted_(wanted), limit_(limit) {}

  [[gnu::always_inline]] bool open(std::uint32_t level, std::uint32_t first_node,
                                   std::uint32_t& node) {
    Floats order;
    const Mask16 met = probe_.test(tree_.node[level], first_node, limit_, order);
    const Mask16 mask = wanted_.nodes(tree_, level, first_node, met);
    if (mask == 0) return false;
    if (level == 0) fetch_rows(first_node, mask);
    key_of(order).store(key_[level]);
    if (mask != met) [[unlikely]]
      leave_out(met & ~mask, key_[level]);
    const std::uint32_t nearest = reduce_min_positive(Floats::load(key_[level]));
    go_to(nearest, level);
    first_node_[level] = first_node;
    open_ |= ((mask & (mask - 1)) != 0 ? 1U : 0U) << level;
    node = first_node + nearest % kLanes;
    return true;
  }

  /// The nearest of the last ones that lies within the limit.
  [[gnu::always_inline]] bool take(std::uint32_t& level, std::uint32_t& node) {
    const std::uint32_t last = order_of(last_key());
    while (open_ != 0) {
      level = static_cast<std::uint32_t>(__builtin_ctz(open_));
      const Floats key = Floats::load(key_[level]);
      const Floats left = select(key > Floats(gone_to_[level]), key, Floats(kLargest<float>));
      const std::uint32_t nearest = reduce_min_positive(left);
      if (nearest <= last) {
        go_to(nearest, level);
        const Mask16 others = bits((key > Floats(gone_to_[level])) & (key <= Floats(kMostKey)));
        open_ ^= (others == 0 ? 1U : 0U) << level;
        node = first_node_[level] + nearest % kLanes;
        return true;
      }
      open_ &= open_ - 1;
    }
    return false;
  }

 private:
  static constexpr float kLeastOrder = 0x1p-100F;
  static constexpr float kMostKey = kMostOrder * (1.0F + 0x1p-18F);

  static Floats key_of(const Floats& order) {
    alignas(64) static constexpr std::uint32_t kEach[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                8, 9, 10, 11, 12, 13, 14, 15};
    const Floats positive =
        smaller_positive(max(order, Floats(kLeastOrder)), Floats(kLargest<float>));
    const Floats without_number(value_of(~(kLanes - 1U)));
    return (positive & without_number) | Floats::load(reinterpret_cast<const float*>(kEach));
  }
  /// No key of a node within the limit is larger.
  [[nodiscard]] float last_key() const {
    const float most = limit_ < kMostOrder ? limit_ : kMostOrder;
    return value_of(order_of(most > kLeastOrder ? most : kLeastOrder) | (kLanes - 1U));
  }
  // By force: compilers leave out calls of functions that only ask for memory.
  /// Asks for the rows of blocks that wait.
  [[gnu::always_inline]] void fetch_rows(std::uint32_t first_block, Mask16 blocks) const {
    for (; blocks != 0; blocks &= blocks - 1) {
      const std::size_t block = tree_.first_block + first_block + first(blocks);
      for (const float* const column : view_.column) __builtin_prefetch(column + block * kLanes);
    }
  }
  static void leave_out(Mask16 lanes, float* key) {
    for (; lanes != 0; lanes &= lanes - 1) key[first(lanes)] = kLargest<float>;
  }
  void go_to(std::uint32_t key, std::uint32_t level) { gone_to_[level] = value_of(key); }

  const QueryView& view_;
  const TreeShape& tree_;
  const Probe& probe_;
  const Wanted& wanted_;
  const float& limit_;
  /// A bit for each level of which some wait.
  std::uint32_t open_ = 0;
  std::uint32_t first_node_[kMaxTreeLevels];
  float gone_to_[kMaxTreeLevels];
  alignas(64) float key_[kMaxTreeLevels][kLanes];
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
    OpenNodes<Probe> open(view, tree, probe, wanted, limit);
    const bool whole = descend(tree.levels, open, [&](std::uint32_t node) {
      return visit((tree.first_block + node) * kLanes);
    });
    if (!whole) return false;
  }
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME
