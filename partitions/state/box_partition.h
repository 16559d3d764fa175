#pragma once

#include <winnow/partitions/partition.h>

namespace winnow {

/// An empty partition of boxes without a margin, whatever the options say of these. Links what
/// boxes need alone, as the public constructor with options cannot.
[[nodiscard]] Partition make_box_partition(StructureKind structure,
                                           const PartitionOptions& options) noexcept;

}  // namespace winnow
