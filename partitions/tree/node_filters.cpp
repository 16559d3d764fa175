#include "partitions/tree/node_filters.h"

#include <winnow/core/key.h>

#include <algorithm>

namespace winnow {
namespace {

constexpr std::uint32_t kChildren = 16;
constexpr std::uint32_t kLast = 0xFFFFFFFFU;
constexpr std::size_t kColumns = 7;  // of NodeFilters

/// What some filters have between them; at first of none, which nothing meets.
struct Joined {
  std::uint32_t layers = 0;
  std::uint32_t mask = 0;
  std::uint32_t first = kLast;
  std::uint32_t last = 0;
  std::uint32_t alike = 1;
  std::uint32_t every_layers = kLast;
  std::uint32_t every_mask = kLast;

  void add(const ObjectFilter& f) noexcept {
    // Joined ones that are alike have what the first one has.
    const bool some = first <= last;
    if (some && (layers != f.layers || mask != f.mask || last != f.environment)) alike = 0;
    layers |= f.layers;
    mask |= f.mask;
    const bool mute = f.layers == 0 || f.mask == 0;
    every_layers &= mute ? 0 : f.layers;
    every_mask &= mute ? 0 : f.mask;
    first = std::min(first, f.environment == kEveryEnvironment ? 0 : f.environment);
    last = std::max(last, f.environment);
  }
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
  for (std::uint32_t i = begin; i < end; ++i) Joined{}.store(nodes, i);
}

void refit_leaf_filters(const TreeView& tree, std::uint32_t begin, std::uint32_t end) noexcept {
  for (std::uint32_t leaf = begin; leaf < end; ++leaf) {
    const std::size_t row = (std::size_t{tree.first_block} + leaf) * kChildren;
    const FilterColumns& filter = tree.rows.filter;
    Joined joined;
    for (std::size_t r = row; r < row + kChildren; ++r) {
      if (tree.rows.id[r] == kNoObject) continue;
      joined.add({filter.layers[r], filter.mask[r], filter.environment[r]});
    }
    joined.store(tree.filters[0], leaf);
  }
}

void refit_node_filters(const TreeView& tree, std::uint32_t level, std::uint32_t begin,
                        std::uint32_t end) noexcept {
  for (std::uint32_t node = begin; node < end; ++node) {
    Joined joined;
    for (std::uint32_t i = 0; i < kChildren; ++i) {
      joined.add(tree.filters[level - 1], node * kChildren + i);
    }
    joined.store(tree.filters[level], node);
  }
}

}  // namespace winnow
