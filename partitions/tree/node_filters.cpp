// Summaries of filters in the nodes of a BlockTree, by which traversals skip subtrees. BlockTree
// calls the refit functions.

#include "partitions/tree/node_filters.h"

#include <winnow/core/key.h>

#include <algorithm>

namespace winnow {
namespace {

constexpr std::uint32_t kChildren = 16;
constexpr std::uint32_t kLast = 0xFFFFFFFFU;
constexpr std::size_t kColumns = 7;  // of NodeFilters

/// The summary of a set of filters. Initially the set is empty, and its summary matches no filter.
struct FilterUnion {
  std::uint32_t layers = 0;
  std::uint32_t mask = 0;
  std::uint32_t first = kLast;
  std::uint32_t last = 0;
  std::uint32_t alike = 1;
  std::uint32_t every_layers = kLast;
  std::uint32_t every_mask = kLast;

  void add(const NodeFilters& nodes, std::uint32_t i) noexcept {
    if (nodes.first_environment[i] > nodes.last_environment[i]) return;
    const bool some = first <= last;
    if (nodes.alike[i] == 0 || (some && (layers != nodes.layers[i] || mask != nodes.mask[i] ||
                                         last != nodes.last_environment[i]))) {
      alike = 0;
    }
    layers |= nodes.layers[i];
    mask |= nodes.mask[i];
    every_layers &= nodes.every_layers[i];
    every_mask &= nodes.every_mask[i];
    first = std::min(first, nodes.first_environment[i]);
    last = std::max(last, nodes.last_environment[i]);
  }
  void store(const NodeFilters& nodes, std::uint32_t i) const noexcept {
    nodes.layers[i] = layers;
    nodes.mask[i] = mask;
    nodes.first_environment[i] = first;
    nodes.last_environment[i] = last;
    nodes.alike[i] = alike;
    nodes.every_layers[i] = every_layers;
    nodes.every_mask[i] = every_mask;
  }
};

/// Summarizes a block of rows. Branchless, so that compilers vectorize the loop.
FilterUnion join_rows(const RowView& rows, std::size_t begin) noexcept {
  const std::uint32_t* const id = rows.id + begin;
  const std::uint32_t* const layers = rows.filter.layers + begin;
  const std::uint32_t* const mask = rows.filter.mask + begin;
  const std::uint32_t* const environment = rows.filter.environment + begin;
  std::uint32_t lead = 0;
  while (lead < kChildren && id[lead] == kNoObject) ++lead;
  FilterUnion joined;
  if (lead == kChildren) return joined;
  std::uint32_t differ = 0;
  for (std::uint32_t i = 0; i < kChildren; ++i) {
    const std::uint32_t hole = id[i] == kNoObject ? kLast : 0;
    // A hole is in no layer.
    joined.layers |= layers[i];
    joined.mask |= mask[i];
    const std::uint32_t mute = layers[i] == 0 || mask[i] == 0 ? kLast : 0;
    joined.every_layers &= hole | (layers[i] & ~mute);
    joined.every_mask &= hole | (mask[i] & ~mute);
    const std::uint32_t from = environment[i] == kAllEnvironments ? 0 : environment[i];
    joined.first = std::min(joined.first, hole | from);
    joined.last = std::max(joined.last, environment[i] & ~hole);
    differ |= ~hole & ((layers[i] ^ layers[lead]) | (mask[i] ^ mask[lead]) |
                       (environment[i] ^ environment[lead]));
  }
  joined.alike = differ == 0 ? 1 : 0;
  return joined;
}

}  // namespace

bool lay_out_filters(TreeShape& shape, Column<std::uint32_t>& memory) noexcept {
  std::size_t total = 0;
  for (std::uint32_t level = 0; level < shape.levels; ++level) {
    total += kColumns * padded_nodes(shape.count[level]);
  }
  if (!memory.grow(total)) return false;
  memory.set_size(total);
  std::uint32_t* at = memory.data();
  for (std::uint32_t level = 0; level < shape.levels; ++level) {
    const std::size_t stride = padded_nodes(shape.count[level]);
    NodeFilters& nodes = shape.filters[level];
    nodes = {.layers = at,
             .mask = at + stride,
             .first_environment = at + 2 * stride,
             .last_environment = at + 3 * stride,
             .alike = at + 4 * stride,
             .every_layers = at + 5 * stride,
             .every_mask = at + 6 * stride};
    empty_filters(nodes, shape.count[level], static_cast<std::uint32_t>(stride));
    at += kColumns * stride;
  }
  return true;
}

void empty_filters(const NodeFilters& nodes, std::uint32_t begin, std::uint32_t end) noexcept {
  for (std::uint32_t i = begin; i < end; ++i) FilterUnion{}.store(nodes, i);
}

void refit_leaf_filters(const TreeView& tree, std::uint32_t begin, std::uint32_t end) noexcept {
  for (std::uint32_t leaf = begin; leaf < end; ++leaf) {
    const std::size_t row = (std::size_t{tree.first_block} + leaf) * kChildren;
    join_rows(tree.rows, row).store(tree.filters[0], leaf);
  }
}

void refit_node_filters(const TreeView& tree, std::uint32_t level, std::uint32_t begin,
                        std::uint32_t end) noexcept {
  for (std::uint32_t node = begin; node < end; ++node) {
    FilterUnion joined;
    for (std::uint32_t i = 0; i < kChildren; ++i) {
      joined.add(tree.filters[level - 1], node * kChildren + i);
    }
    joined.store(tree.filters[level], node);
  }
}

}  // namespace winnow
