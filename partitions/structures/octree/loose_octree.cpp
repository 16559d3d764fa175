// LooseOctree and LooseQuadtree: plan the order of rows by keys (loose_octree_cells.h) and the
// nodes over them. Queries run on the block tree over the regular rows (tree/block_tree.h).

#include <winnow/core/debug_draw.h>
#include "core/sort/parallel_ranges.h"
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/octree/loose_octree_cells.h"

#include <algorithm>
#include <array>
#include <span>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;
constexpr std::size_t kMinNodes = 64;
// Computing the keys takes about as long as two other passes over the rows.
constexpr unsigned kKeyStages = 2;
constexpr std::size_t kRowsOfGroup = 16 * kBlockRows;  // in a node of the tree over the rows
// Longer runs of objects with equal keys go to the rest, because the tree orders them better.
constexpr std::size_t kLongRun = 48;

// An upper bound of the rows in most builds of a moving scene.
constexpr std::size_t usual_row_limit(std::size_t objects) {
  return objects + objects / 8 + 256;
}

constexpr std::uint32_t key_in(std::uint64_t item) {
  return static_cast<std::uint32_t>(item >> 32U);
}

/// Loose octree (Ulrich, "Loose Octrees", Game Programming Gems, 2000) without pointers. An object
/// belongs to one node: on the level of its size, the cell that contains its centre. Nodes are
/// ranges of rows, sorted by level, large objects first, and within a level along the Hilbert curve
/// (blocks of rows then have a third less surface than with Morton codes). Each node has its linear
/// code. The cells of nodes are loose, so an object may move by three quarters of a cell or more
/// without changing its node.
///
/// Nodes overlap their neighbours by design and may be nearly empty, so queries do not test them.
/// Instead every 16 rows in node order have a tight box, and 16 such boxes at a time are tested as
/// in a block tree. A block tree beside it contains objects that are larger than the root, outside
/// of the root or unbounded, and objects that left their loose cells. If the world is at most two
/// cells thick, only two axes are divided. Self pairs: O(n log n + pairs) for boxes of bounded
/// overlap. Exact.
class LooseTree : public CellStructure {
 public:
  LooseTree(const StructureInput& input, std::size_t axes) noexcept;

  /// Levels from the root to the finest nodes; 0 if there are none. Statistics report non-empty
  /// nodes as cells.
  [[nodiscard]] std::size_t levels() const noexcept override {
    return regular_rows() == 0 ? 0 : used_.cells.levels();
  }

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] PlanStatus plan(const RowPlan& plan, unsigned stage) noexcept override;
  [[nodiscard]] std::size_t plan_passes() const noexcept override { return kKeyStages + 3; }
  void finish_build(const RowPlan& plan, bool foreseen) noexcept override;
  [[nodiscard]] bool prunes_rows() const noexcept override { return true; }
  [[nodiscard]] bool fits(std::size_t row, const ObjectBox& place) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override { return used_.node.size(); }
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

  struct LooseNodes {
    explicit LooseNodes(std::pmr::memory_resource* memory) noexcept
        : node(memory), bounds(memory) {}

    void swap(LooseNodes& other) noexcept {
      std::swap(cells, other.cells);
      node.swap(other.node);
      bounds.swap(other.bounds);
    }
    void release() noexcept { release_columns(node, bounds); }
    [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(node, bounds); }

    LooseOctreeCells cells;
    Column<std::uint32_t> node;                   // level and Morton code
    Column<LooseOctreeCells::CellBounds> bounds;  // of each node's loose cell
  };

  [[nodiscard]] PlanStatus choose_cells(const RowPlan& plan) noexcept;
  void find_keys(const RowPlan& plan, std::size_t begin, std::size_t end) const noexcept;
  [[nodiscard]] bool lay_nodes(const RowPlan& plan) noexcept;
  [[nodiscard]] bool lay_node(std::span<const std::uint64_t> cell, const RowPlan& plan) noexcept;

  const std::size_t axes_;
  const float loose_;
  LooseNodes used_;
  LooseNodes planned_;
  const std::uint64_t* sorted_ = nullptr;  // while planning: the items sorted by key
};

LooseTree::LooseTree(const StructureInput& input, std::size_t axes) noexcept
    : CellStructure(input),
      axes_(axes),
      // The order of arguments turns NaN into the minimum.
      loose_(std::min(8.0F, std::max(1.125F, input.parameter))),
      used_(input.memory),
      planned_(input.memory) {}

// Every object may have its own node.
bool LooseTree::reserve(const BuildRoom& room) noexcept {
  const std::size_t nodes = room.objects + kMinNodes;
  const std::size_t rows = usual_row_limit(room.objects);
  return reserve_cells(room, nodes, 0) && room.items.reserve(2 * rows, room.pages) &&
         planned_.node.reserve(nodes, room.pages) && planned_.bounds.reserve(nodes, room.pages);
}

PlanStatus LooseTree::plan(const RowPlan& plan, unsigned stage) noexcept {
  std::uint64_t* const items = plan.items.data();
  if (stage == 0) return choose_cells(plan);
  if (stage <= kKeyStages) {
    find_keys(plan, plan.rows * (stage - 1) / kKeyStages, plan.rows * stage / kKeyStages);
    return PlanStatus::unfinished;
  }
  if (stage == kKeyStages + 1) {
    sorted_ = radix_sort(items, items + plan.rows, plan.rows, 32, execution());
    return PlanStatus::unfinished;
  }
  return lay_nodes(plan) ? PlanStatus::done : PlanStatus::out_of_memory;
}

PlanStatus LooseTree::choose_cells(const RowPlan& plan) noexcept {
  planned_.node.clear();
  planned_.bounds.clear();
  planned_start_.clear();
  const SceneSample sample(pool(), plan.objects, execution());
  if (!planned_.cells.choose(sample, axes_, loose_)) {
    append_all_to_rest(plan);
    return PlanStatus::done;
  }
  const std::size_t most_rows = std::max(plan.rows, usual_row_limit(plan.objects));
  const std::size_t nodes = plan.objects / 8 + kMinNodes;
  if (!plan.items.reserve(2 * most_rows) || !planned_.node.reserve(nodes) ||
      !planned_start_.reserve(nodes) || !planned_.bounds.reserve(nodes)) {
    return PlanStatus::out_of_memory;
  }
  plan.items.set_size(2 * plan.rows);
  return PlanStatus::unfinished;
}

void LooseTree::find_keys(const RowPlan& plan, std::size_t first, std::size_t last) const noexcept {
  std::uint64_t* const items = plan.items.data();
  const ObjectId* const ids = pool().ids();
  constexpr std::size_t kTogether = 256;
  for_each_even_range(
      execution(), last - first, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
        std::array<std::uint32_t, kTogether> key;
        for (std::size_t from = first + begin; from < first + end; from += kTogether) {
          const std::size_t to = std::min(first + end, from + kTogether);
          planned_.cells.find_keys(pool(), from, to, key.data());
          for (std::size_t row = from; row < to; ++row) {
            std::uint32_t& own = key[row - from];
            if (ids[row] == kNoObject) {
              const std::size_t now = current_row(plan, row);
              own = LooseOctreeCells::kNone;
              if (ids[now] != kNoObject) planned_.cells.find_keys(pool(), now, now + 1, &own);
            }
            items[row] = std::uint64_t{own} << 32U | row;
          }
        }
      });
}

bool LooseTree::lay_nodes(const RowPlan& plan) noexcept {
  std::size_t first = 0;
  while (first < plan.rows && key_in(sorted_[first]) != LooseOctreeCells::kNone) {
    const std::uint32_t key = key_in(sorted_[first]);
    const unsigned within = planned_.cells.bits_within_cell(key);
    std::size_t last = first + 1;
    while (last < plan.rows && (key_in(sorted_[last]) ^ key) >> within == 0) ++last;
    if (!lay_node({sorted_ + first, last - first}, plan)) return false;
    first = last;
  }
  for (; first < plan.rows; ++first) {
    const auto row = static_cast<std::uint32_t>(sorted_[first]);
    if (pool().ids()[row] != kNoObject) (void)plan.rest.push_back(row);
  }
  return planned_start_.push_back(static_cast<std::uint32_t>(plan.regular.size()));
}

// Adds the node of rows whose keys are in one cell. Long ranges of equal keys go to the rest.
bool LooseTree::lay_node(std::span<const std::uint64_t> cell, const RowPlan& plan) noexcept {
  const auto begin = static_cast<std::uint32_t>(plan.regular.size());
  const auto append = [&](Column<std::uint32_t>& rows, std::size_t from, std::size_t to) {
    std::uint32_t* const row = rows.end();
    for (std::size_t i = from; i < to; ++i) row[i - from] = static_cast<std::uint32_t>(cell[i]);
    rows.set_size(rows.size() + (to - from));
  };
  for (std::size_t run = 0; run < cell.size();) {
    std::size_t end = cell.size();
    if (end > kLongRun) {
      end = run + 1;
      while (end < cell.size() && key_in(cell[end]) == key_in(cell[run])) ++end;
    }
    append(end - run <= kLongRun ? plan.regular : plan.rest, run, end);
    run = end;
  }
  if (plan.regular.size() == begin) return true;
  const std::uint32_t code = planned_.cells.code_of(key_in(cell[0]));
  return planned_.node.push_back(code) && planned_start_.push_back(begin) &&
         planned_.bounds.push_back(planned_.cells.loose_bounds(code));
}

void LooseTree::finish_build(const RowPlan&, bool) noexcept {
  used_.swap(planned_);
  start_.swap(planned_start_);
}

bool LooseTree::fits(std::size_t row, const ObjectBox& place) const noexcept {
  const auto after = std::upper_bound(start_.begin(), start_.end(), row);
  const auto node = static_cast<std::size_t>(after - start_.begin() - 1);
  return used_.cells.contains_box(used_.bounds[node], place);
}

std::size_t LooseTree::write_misfits(std::uint32_t begin, std::uint32_t end,
                                     std::uint32_t* out) const noexcept {
  std::size_t found = 0;
  for (std::uint32_t node = begin; node < end; ++node) {
    const std::uint32_t behind = start_[node + 1];
    if (used_.cells.contains_rows(used_.bounds[node], pool(), start_[node], behind)) continue;
    for (std::uint32_t row = start_[node]; row < behind; ++row) {
      out[found] = row;
      found += used_.cells.contains_rows(used_.bounds[node], pool(), row, row + 1) ? 0U : 1U;
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
  for (std::size_t node = 0; node < used_.node.size(); ++node) {
    Aabb contents;
    for (std::uint32_t row = start_[node]; row < start_[node + 1]; ++row) {
      contents.merge(stored_box(rows.column, row));
    }
    if (!contents.is_valid()) continue;  // only holes
    const LooseOctreeCells::CellBounds bounds = used_.cells.cell_bounds(used_.node[node]);
    Aabb cell = contents;
    for (std::size_t k = 0; k < used_.cells.axes(); ++k) {
      cell.min[used_.cells.axis(k)] = bounds.low[k];
      cell.max[used_.cells.axis(k)] = bounds.high[k];
    }
    draw.box(cell, kCellColour);
    draw.box(contents, kContentsColour);
  }
}

void LooseTree::release_memory() noexcept {
  CellStructure::release_memory();
  used_.release();
  planned_.release();
}

void LooseTree::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += used_.bytes();
  footprint.structure += planned_.bytes();
}

std::size_t LooseTree::cells() const noexcept {
  return used_.node.size();
}

class LooseOctree final : public LooseTree {
 public:
  explicit LooseOctree(const StructureInput& input) noexcept : LooseTree(input, 3) {}
};

/// The loose octree in two dimensions: it divides the two axes with the most room, and edges along
/// the third axis do not affect the level. Suits flat worlds.
class LooseQuadtree final : public LooseTree {
 public:
  explicit LooseQuadtree(const StructureInput& input) noexcept : LooseTree(input, 2) {}
};

// These structures have no costs, so the automatic choice never takes them: neither was the
// cheapest structure in any measured scene, including flat worlds.
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
