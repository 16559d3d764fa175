// SpatialIndex: replaces the structure, and keeps structures with reserved memory for later use.

#include "partitions/index/spatial_index.h"

#include <algorithm>
#include <utility>

namespace winnow {

Structure* SpatialIndex::make(StructureKind kind) noexcept {
  const auto spare = std::ranges::find(spare_structures_, kind, &OwnedStructure::kind);
  if (spare != spare_structures_.end()) return std::exchange(*spare, {}).structure;
  return kind.info()->make({memory_, rows_, regular_tree_, kind.parameter()});
}

void SpatialIndex::destroy(const OwnedStructure& one) noexcept {
  if (one.structure != nullptr) one.kind.info()->destroy(one.structure, memory_);
}

// Keeps a structure with its reserved memory for later use, or destroys it.
void SpatialIndex::stash(const OwnedStructure& one) noexcept {
  if (one.structure == nullptr) return;
  if (!reserved_ || !store_spare(one)) destroy(one);
}

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
  built_edge_ = 0.0F;
  built_holes_ = 0;
  full_base_ = moved_base_ = excess_ = 0;
  rows_.invalidate_order();
}

bool SpatialIndex::set_structure(StructureKind kind) noexcept {
  Structure* const made = make(kind);
  if (made == nullptr) return false;
  destroy_spares();
  destroy({kind_, structure_});
  install(made, kind);
  return true;
}

Status SpatialIndex::refresh_as(StructureKind kind, bool& refused) {
  Structure* const made = make(kind);
  refused = made == nullptr;
  if (refused) return refresh();
  if (plans_ahead() && !structure_->is_flat() && !made->is_flat() && !needs_build()) {
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
    stash(before);
    return Status::ok;
  }
  refused = true;
  stash({kind, made});
  install(before.structure, before.kind);
  return refresh();
}

void SpatialIndex::install_planned_structure() noexcept {
  if (!swap_is_planned()) return;
  stash({kind_, structure_});
  kind_ = next_.kind;
  structure_ = std::exchange(next_, {}).structure;
  if (!structure_->prunes_rows() && !reserved_) regular_tree_.release();
}

// Reservation of memory.

bool SpatialIndex::reserve(std::size_t objects, Pages pages,
                           std::span<const StructureKind> later) noexcept {
  drop_plan();
  if (!make_spares(later)) return false;
  std::size_t holes = 0;
  std::size_t behind = 0;
  bool flat = true;
  bool prunes = false;
  const auto count_in = [&](const Structure& structure) {
    flat = flat && structure.is_flat();
    prunes = prunes || structure.prunes_rows();
    holes = std::max(holes, structure.max_holes());
    behind = std::max(behind, spare_rows(structure, objects));
  };
  count_in(*structure_);
  for (const OwnedStructure& one : spare_structures_) {
    if (one.structure != nullptr) count_in(*one.structure);
  }
  const std::size_t ordered = objects + holes + kBlockRows;
  reserved_ = flat || (reserve_order(ordered, behind, pages) &&
                       (!prunes || regular_tree_.reserve(blocks_of(ordered), pages)));
  const BuildRoom room = plan_.room_for(objects, pages);
  reserved_ = reserved_ && structure_->reserve(room);
  for (const OwnedStructure& one : spare_structures_) {
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

// Stores the structure in a free entry or a new one. Returns false if an allocation fails.
bool SpatialIndex::store_spare(const OwnedStructure& one) noexcept {
  OwnedStructure* const place =
      std::ranges::find(spare_structures_, nullptr, &OwnedStructure::structure);
  if (place == spare_structures_.end()) return spare_structures_.push_back(one);
  *place = one;
  return true;
}

bool SpatialIndex::make_spares(std::span<const StructureKind> kinds) noexcept {
  for (const StructureKind kind : kinds) {
    if (kind == kind_ || std::ranges::find(spare_structures_, kind, &OwnedStructure::kind) !=
                             spare_structures_.end()) {
      continue;
    }
    const OwnedStructure one{kind, make(kind)};
    if (one.structure == nullptr) return false;
    if (store_spare(one)) continue;
    destroy(one);
    return false;
  }
  return true;
}

void SpatialIndex::destroy_spares() noexcept {
  for (const OwnedStructure& one : spare_structures_) destroy(one);
  spare_structures_.release();
}

}  // namespace winnow
