#pragma once

#include <winnow/c/partition.h>
#include <winnow/partitions/structures.h>

namespace winnow::c {

/// One that names no structure for what is none.
[[nodiscard]] StructureKind structure_of(winnow_structure_kind given) noexcept;
/// A structure of -1 for one that names none.
[[nodiscard]] winnow_structure_kind structure_of(StructureKind kind) noexcept;

}  // namespace winnow::c
