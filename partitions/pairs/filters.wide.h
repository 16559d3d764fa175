#pragma once

// Which rows and nodes a filter lets pass.

#include "partitions/tree/block_tree.kernel.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// A filter, or what the filters below a node have between them. An object of every environment
/// spans them all, so that one test of intervals serves objects and nodes.
struct FilterRange {
  std::uint32_t layers;
  std::uint32_t mask;
  std::uint32_t first_environment;
  std::uint32_t last_environment;
};

static inline FilterRange range_of(const ObjectFilter& f) {
  const std::uint32_t first = f.environment == kEveryEnvironment ? 0U : f.environment;
  return {f.layers, f.mask, first, f.environment};
}

/// The range of node i; that of the default filter if no filters are kept.
static inline FilterRange range_of(const NodeFilters& nodes, std::uint32_t i) {
  if (nodes.layers == nullptr) return range_of(ObjectFilter{});
  return {nodes.layers[i], nodes.mask[i], nodes.first_environment[i], nodes.last_environment[i]};
}

/// True if something in one range may meet something in the other; exact for two objects.
static inline bool may_meet(const FilterRange& a, const FilterRange& b) {
  // Without branches: layers are coin tosses.
  return static_cast<bool>(static_cast<unsigned>((a.layers & b.mask) != 0) &
                           static_cast<unsigned>((b.layers & a.mask) != 0) &
                           static_cast<unsigned>(a.first_environment <= b.last_environment) &
                           static_cast<unsigned>(b.first_environment <= a.last_environment));
}

/// Those of the candidate rows from `first_row` on that `q` may meet. Empty rows never pass.
static inline Mask16 passing_rows(const RowView& rows, std::uint32_t first_row, Mask16 candidates,
                                  const FilterRange& q) {
  Mask16 passed = 0;
  for (Mask16 left = candidates; left != 0; left &= left - 1) {
    const std::uint32_t id = rows.id[first_row + first(left)];
    if (id == ~0U) continue;
    const ObjectFilter own = rows.filter != nullptr ? rows.filter[id] : ObjectFilter{};
    passed |= static_cast<Mask16>(may_meet(range_of(own), q)) << first(left);
  }
  return passed;
}
static inline Mask16 passing_rows(const RowView& rows, std::uint32_t first_row, Mask16 candidates,
                                  const ObjectFilter& q) {
  return passing_rows(rows, first_row, candidates, range_of(q));
}

/// Those of the candidate nodes from `first_node` on that may hold something that `q` may meet.
static inline Mask16 passing_nodes(const NodeFilters& nodes, std::uint32_t first_node,
                                   Mask16 candidates, const FilterRange& q) {
  Mask16 passed = 0;
  for (Mask16 left = candidates; left != 0; left &= left - 1) {
    const bool met = may_meet(range_of(nodes, first_node + first(left)), q);
    passed |= static_cast<Mask16>(met) << first(left);
  }
  return passed;
}
static inline Mask16 passing_nodes(const NodeFilters& nodes, std::uint32_t first_node,
                                   Mask16 candidates, const ObjectFilter& q) {
  return passing_nodes(nodes, first_node, candidates, range_of(q));
}

}  // namespace winnow::WINNOW_ISA_NAME
