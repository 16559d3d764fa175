#include "partitions/index/structure_store.h"

#include <algorithm>
#include <utility>

namespace winnow {

Structure* StructureStore::make(StructureKind kind) noexcept {
  const auto spare = std::ranges::find(spares_, kind, &OwnedStructure::kind);
  if (spare != spares_.end()) return std::exchange(*spare, {}).structure;
  return kind.info()->make({memory_, rows_, regular_tree_, kind.parameter()});
}

void StructureStore::destroy(const OwnedStructure& one) noexcept {
  if (one.structure != nullptr) one.kind.info()->destroy(one.structure, memory_);
}

bool StructureStore::keep(const OwnedStructure& one) noexcept {
  OwnedStructure* const place = std::ranges::find(spares_, nullptr, &OwnedStructure::structure);
  if (place == spares_.end()) return spares_.push_back(one);
  *place = one;
  return true;
}

void StructureStore::stash(const OwnedStructure& one, bool spare) noexcept {
  if (one.structure != nullptr && !(spare && keep(one))) destroy(one);
}

bool StructureStore::make_spares(std::span<const StructureKind> kinds,
                                 StructureKind used) noexcept {
  for (const StructureKind kind : kinds) {
    if (kind == used || std::ranges::find(spares_, kind, &OwnedStructure::kind) != spares_.end()) {
      continue;
    }
    const OwnedStructure one{kind, make(kind)};
    if (one.structure == nullptr) return false;
    if (keep(one)) continue;
    destroy(one);
    return false;
  }
  return true;
}

void StructureStore::destroy_spares() noexcept {
  for (const OwnedStructure& one : spares_) destroy(one);
  spares_.release();
}

}  // namespace winnow
