// SpatialIndex: exchanges of the structure, and the memory that is reserved for the structures that
// may follow.

#include "core/memory/columns.h"
#include "partitions/index/spatial_index.h"

#include <algorithm>
#include <utility>

namespace winnow {

// Exchange of the structure.

void SpatialIndex::install(Structure* structure, StructureKind kind) noexcept {
  drop_plan();
  structure_ = structure;
  kind_ = kind;
  if (reserved_) {
    (void)tree_.cover(0, 0);
    (void)regular_tree_.cover(0, 0);
  } else {
    tree_.release();
    regular_tree_.release();
    release_scratch();
    rows_.selection().release();
  }
  planner_.note_new_structure();
  rows_.invalidate_order();
}

bool SpatialIndex::set_structure(StructureKind kind) noexcept {
  Structure* const made = structures_.make(kind);
  if (made == nullptr) return false;
  structures_.destroy_spares();
  structures_.destroy({kind_, structure_});
  install(made, kind);
  return true;
}

Status SpatialIndex::refresh_as(StructureKind kind, bool& refused) {
  Structure* const made = structures_.make(kind);
  refused = made == nullptr;
  if (refused) return refresh();
  const RowNumbers n = numbers();
  if (planner_.plans_ahead(n) && !n.flat && !made->is_flat() && !planner_.needs_build(n)) {
    drop_plan();
    // The scratch of the current structure's plan is of no use to the next structure.
    if (!reserved_) plan_.release();
    if (start_plan(*made)) {
      next_ = {kind, made};
      return refresh();
    }
  }
  const OwnedStructure before{kind_, structure_};
  install(made, kind);
  if (refresh() == Status::ok) {
    structures_.stash(before, reserved_);
    return Status::ok;
  }
  refused = true;
  structures_.stash({kind, made}, reserved_);
  install(before.structure, before.kind);
  return refresh();
}

void SpatialIndex::install_planned_structure() noexcept {
  if (!swap_is_planned()) return;
  structures_.stash({kind_, structure_}, reserved_);
  kind_ = next_.kind;
  structure_ = std::exchange(next_, {}).structure;
  if (!structure_->prunes_rows() && !reserved_) regular_tree_.release();
}

// Reservation of memory.

bool SpatialIndex::reserve(std::size_t objects, Pages pages,
                           std::span<const StructureKind> later) noexcept {
  drop_plan();
  if (!structures_.make_spares(later, kind_)) return false;
  std::size_t holes = 0;
  std::size_t behind = 0;
  bool flat = true;
  bool prunes = false;
  const auto count_in = [&](const Structure& structure) {
    flat = flat && structure.is_flat();
    prunes = prunes || structure.prunes_rows();
    holes = std::max(holes, structure.max_holes());
    behind = std::max(behind, RebuildPlanner::tail_room(structure.prunes_rows(), objects));
  };
  count_in(*structure_);
  for (const OwnedStructure& one : structures_.spares()) {
    if (one.structure != nullptr) count_in(*one.structure);
  }
  const std::size_t ordered = objects + holes + kBlockRows;
  reserved_ = flat || (reserve_order(ordered, behind, pages) &&
                       (!prunes || regular_tree_.reserve(blocks_of(ordered), pages)));
  const BuildRoom room = plan_.room_for(objects, pages);
  reserved_ = reserved_ && structure_->reserve(room);
  for (const OwnedStructure& one : structures_.spares()) {
    if (one.structure != nullptr) reserved_ = reserved_ && one.structure->reserve(room);
  }
  return reserved_;
}

// Makes room for `rows` rows in order and for `behind` rows in the tail.
bool SpatialIndex::reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept {
  return rows_.reserve_rows(rows + behind) &&
         spare_.reserve(rows_.pool().capacity() + 2 * kBlockRows, pages) &&
         plan_.reserve(rows + behind, behind, pages) && tree_.reserve(blocks_of(rows), pages) &&
         departures_.reserve(rows);
}

void SpatialIndex::release_scratch() noexcept {
  drop_plan();
  release_columns(spare_, tail_order_);
  plan_.release();
}

void SpatialIndex::release_memory() noexcept {
  reserved_ = false;
  structures_.destroy_spares();
  release_scratch();
  structure_->release_scratch();
  if (rows_.size() != 0) return;
  tree_.release();
  regular_tree_.release();
  departures_.release();
  structure_->release_memory();
}

}  // namespace winnow
