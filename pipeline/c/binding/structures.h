#pragma once

#include <winnow/c/partition.h>
#include <winnow/partitions/structures.h>

namespace winnow::c {

/// Returns a kind without a structure if `given` is invalid.
[[nodiscard]] StructureKind structure_of(winnow_structure_kind given) noexcept;
/// Returns structure -1 for a kind without a structure.
[[nodiscard]] winnow_structure_kind structure_of(StructureKind kind) noexcept;

}  // namespace winnow::c
