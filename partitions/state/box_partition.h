#pragma once

#include <winnow/partitions/partition.h>

namespace winnow {

/// Returns an empty partition of boxes without a margin; volume and margin of the options are
/// ignored. Links only the code for boxes, unlike the public constructor with options.
[[nodiscard]] Partition make_box_partition(StructureKind structure,
                                           const PartitionOptions& options) noexcept;

}  // namespace winnow
