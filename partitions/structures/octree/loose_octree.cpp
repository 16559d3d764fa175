#include <winnow/partitions/debug_colours.h>
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/octree/loose_octree_cells.h"

#include <algorithm>
#include <cfloat>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;
constexpr std::size_t kFewestNodes = 64;
constexpr std::size_t kRowsOfGroup = 16 * kBlockRows;  // of a node of the tree over the rows
// Longer runs of objects whose places cannot be told apart are sorted better by the tree.
constexpr std::size_t kLongRun = 48;

// Rows of a scene in motion that mostly all of its builds meet at most.
constexpr std::size_t mostly_all(std::size_t objects) {
  return objects + objects / 8 + 256;
}

constexpr std::uint32_t key_in(std::uint64_t item) {
  return static_cast<std::uint32_t>(item >> 32U);
}

/// Loose octree (Ulrich, "Loose Octrees", Game Programming Gems, 2000) without pointers: an object
/// lives in the one node of its size's level whose cell holds its centre. Nodes are runs of rows in
/// flat arrays, sorted by level, large objects first, and along Hilbert's curve within a level
/// (which leaves blocks of rows a third less surface than Morton's); each has its linear code. A
/// node's cell is loose, so objects may move by a good part of it, and the node stays as it is.
///
/// Nodes overlap their neighbours by design and may be nearly empty, so they are not what is
/// tested: every 16 rows in node order have a tight box, and 16 of these at once are pruned as in a
/// block tree. Objects larger than the root, outside of it or without end, and those that have left
/// their loose cells, are kept in a block tree beside it. In a world two cells thick it divides two
/// axes only. Seldom the fastest and never far from it, whatever the sizes. Self pairs: O(n log n +
/// pairs) for boxes of bounded overlap. Exact.
class LooseTree : public CellStructure {
 public:
  LooseTree(const StructureInput& input, std::size_t axes) noexcept;

  /// From the root to the finest nodes; 0 if there are none. Statistics counts the nodes that hold
  /// objects as cells.
  [[nodiscard]] std::size_t levels() const noexcept override {
    return regular_rows() == 0 ? 0 : cells_.levels();
  }

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] bool plan(const RowPlan& plan) noexcept override;
  [[nodiscard]] bool prunes_rows() const noexcept override { return true; }
  [[nodiscard]] bool fits(std::size_t row) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override { return node_.size(); }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t node) const noexcept override {
    return start_[node];
  }
  std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out) const noexcept override;
  [[nodiscard]] std::size_t pair_units() const noexcept override {
    return (regular_rows() + kRowsOfGroup - 1) / kRowsOfGroup;
  }
  bool find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept override;
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw(DebugDraw& draw) const override;
  void release_memory() noexcept override;
  void add_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cells() const noexcept override;

  void find_keys(std::uint64_t* items) const noexcept;
  [[nodiscard]] bool add_node(std::size_t row, std::uint32_t key, std::size_t start) noexcept;

  const std::size_t axes_;
  const float loose_;
  LooseOctreeCells cells_;
  Column<std::uint32_t> node_;               // level and Morton code
  Column<LooseOctreeCells::Bounds> bounds_;  // of each node's loose cell
};

LooseTree::LooseTree(const StructureInput& input, std::size_t axes) noexcept
    : CellStructure(input),
      axes_(axes),
      // Written so that NaN becomes the least.
      loose_(std::min(8.0F, std::max(1.125F, input.parameter))),
      node_(input.memory),
      bounds_(input.memory) {}

// Every object may have a node to itself.
bool LooseTree::reserve(const BuildRoom& room) noexcept {
  const std::size_t nodes = room.objects + kFewestNodes;
  const std::size_t rows = mostly_all(room.objects);
  return reserve_cells(room, nodes, rows) && room.items.reserve(2 * rows, room.pages) &&
         node_.reserve(nodes, room.pages) && bounds_.reserve(nodes, room.pages);
}

bool LooseTree::plan(const RowPlan& plan) noexcept {
  node_.clear();
  start_.clear();
  bounds_.clear();
  const SceneSample sample(pool());
  if (!cells_.choose(sample, axes_, loose_)) {
    leave_all(plan);
    return true;
  }
  const std::size_t rows = pool().rows();
  // Of a scene in motion builds meet now more rows, now more nodes: this is enough for mostly all.
  const std::size_t most_rows = std::max(rows, mostly_all(objects()));
  const std::size_t nodes = objects() / 8 + kFewestNodes;
  if (!plan.items.reserve(2 * most_rows) || !list_.reserve(most_rows)) return false;
  if (!node_.reserve(nodes) || !start_.reserve(nodes) || !bounds_.reserve(nodes)) return false;
  plan.items.set_size(2 * rows);
  list_.set_size(rows);
  std::uint64_t* const items = plan.items.data();
  find_keys(items);
  const std::uint64_t* const sorted = radix_sort(items, items + rows, rows, 32, execution());
  std::uint32_t cell = LooseOctreeCells::kNone;
  std::size_t run = 0;
  while (run < rows && key_in(sorted[run]) != LooseOctreeCells::kNone) {
    const std::uint32_t key = key_in(sorted[run]);
    std::size_t end = run + 1;
    while (end < rows && key_in(sorted[end]) == key) ++end;
    const bool apart = end - run <= kLongRun;
    if (apart && cells_.cell_of_key(key) != cell) {
      cell = cells_.cell_of_key(key);
      if (!add_node(static_cast<std::uint32_t>(sorted[run]), key, plan.regular.size()))
        return false;
    }
    Column<std::uint32_t>& rows_of_run = apart ? plan.regular : plan.rest;
    for (; run < end; ++run) (void)rows_of_run.push_back(static_cast<std::uint32_t>(sorted[run]));
  }
  for (; run < rows; ++run) {
    const auto row = static_cast<std::uint32_t>(sorted[run]);
    if (pool().ids()[row] != kNoObject) (void)plan.rest.push_back(row);
  }
  return start_.push_back(static_cast<std::uint32_t>(plan.regular.size()));
}

bool LooseTree::add_node(std::size_t row, std::uint32_t key, std::size_t start) noexcept {
  const std::uint32_t code = cells_.code_of(pool(), row, key);
  return node_.push_back(code) && start_.push_back(static_cast<std::uint32_t>(start)) &&
         bounds_.push_back(cells_.loose_bounds(code));
}

void LooseTree::find_keys(std::uint64_t* items) const noexcept {
  const std::size_t rows = pool().rows();
  execution().for_each((rows + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(rows, (task + 1) * kRowsPerTask);
    for (std::size_t row = task * kRowsPerTask; row < end; ++row) {
      const bool live = pool().ids()[row] != kNoObject;
      const std::uint32_t key = live ? cells_.key_of(pool(), row) : LooseOctreeCells::kNone;
      items[row] = std::uint64_t{key} << 32U | row;
    }
  });
}

bool LooseTree::fits(std::size_t row) const noexcept {
  const auto after = std::upper_bound(start_.begin(), start_.end(), row);
  const auto node = static_cast<std::size_t>(after - start_.begin() - 1);
  return cells_.hold(bounds_[node], pool(), row, row + 1);
}

std::size_t LooseTree::write_misfits(std::uint32_t begin, std::uint32_t end,
                                     std::uint32_t* out) const noexcept {
  std::size_t found = 0;
  for (std::uint32_t node = begin; node < end; ++node) {
    const std::uint32_t behind = start_[node + 1];
    if (cells_.hold(bounds_[node], pool(), start_[node], behind)) continue;
    for (std::uint32_t row = start_[node]; row < behind; ++row) {
      out[found] = row;
      found += cells_.hold(bounds_[node], pool(), row, row + 1) ? 0U : 1U;
    }
  }
  return found;
}

bool LooseTree::find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept {
  return block_tree_kernels().self_pairs(regular_tree(), begin, end, sink);
}

bool LooseTree::query(const QueryBatch& batch, PairSink& sink) const noexcept {
  return block_tree_kernels().query(regular_tree(), batch, sink);
}

void LooseTree::draw(DebugDraw& draw) const {
  const RowView rows = row_view();
  for (std::size_t node = 0; node < node_.size(); ++node) {
    Aabb contents;
    for (std::uint32_t row = start_[node]; row < start_[node + 1]; ++row) {
      contents.merge(stored_box(rows.column, row));
    }
    if (!contents.is_valid()) continue;  // holes only
    const LooseOctreeCells::Bounds bounds = cells_.cell_bounds(node_[node]);
    Aabb cell = contents;
    for (std::size_t k = 0; k < cells_.axes(); ++k) {
      cell.min[static_cast<Eigen::Index>(cells_.axis(k))] = bounds.low[k];
      cell.max[static_cast<Eigen::Index>(cells_.axis(k))] = bounds.high[k];
    }
    draw.box(cell, kCellColour);
    draw.box(contents, kContentsColour);
  }
}

void LooseTree::release_memory() noexcept {
  CellStructure::release_memory();
  release_columns(node_, bounds_);
}

void LooseTree::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += bytes_of(node_, bounds_);
}

std::size_t LooseTree::cells() const noexcept {
  return node_.size();
}

class LooseOctree final : public LooseTree {
 public:
  explicit LooseOctree(const StructureInput& input) noexcept : LooseTree(input, 3) {}
};

/// In two dimensions: the two axes with the most room are divided, and edges along the third put no
/// object on a coarser level. Suits flat worlds.
class LooseQuadtree final : public LooseTree {
 public:
  explicit LooseQuadtree(const StructureInput& input) noexcept : LooseTree(input, 2) {}
};

// Never chosen automatically: no scene, flat worlds included, is cheaper by them than by the best
// of the others.
constexpr StructureInfo kOctree = structure_info<LooseOctree>("LooseOctree");
constexpr StructureInfo kQuadtree = structure_info<LooseQuadtree>("LooseQuadtree");

}  // namespace

StructureKind loose_octree(float loose) noexcept {
  return StructureKind(kOctree, loose);
}

StructureKind loose_quadtree(float loose) noexcept {
  return StructureKind(kQuadtree, loose);
}

}  // namespace winnow
