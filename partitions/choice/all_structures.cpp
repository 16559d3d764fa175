#include <winnow/partitions/structures.h>

#include <algorithm>

namespace winnow {

std::span<const StructureKind> all_structures() noexcept {
#define WINNOW_LIST_STRUCTURE(function, ...) function(),
  static const StructureKind kinds[] = {WINNOW_STRUCTURES(WINNOW_LIST_STRUCTURE)};
#undef WINNOW_LIST_STRUCTURE
  return kinds;
}

StructureKind structure_named(std::string_view name) noexcept {
  const auto all = all_structures();
  const auto found = std::ranges::find(all, name, &StructureKind::name);
  return found == all.end() ? StructureKind{} : *found;
}

}  // namespace winnow
