#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_scene.h>
#include "pipeline/cluster/contact_events.h"
#include "pipeline/cluster/rank_scene.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

/// What one rank adds, or kept.
struct RecordBatch {
  std::vector<BodyName> names;
  std::vector<BodyRecord> bodies;
  std::vector<TouchingPair> touching;  // sorted
};

/// Bodies as they are added, with their names for client data, and the other way round.
[[nodiscard]] std::vector<BodyDefinition> definitions_of(std::span<const BodyName> names,
                                                         std::span<const BodyRecord> bodies);
/// New ones.
[[nodiscard]] std::vector<BodyRecord> records_of(std::span<const BodyDefinition> bodies);
/// Tells batches from each other, by every bit of them.
[[nodiscard]] std::uint64_t told_by(const ClusterSceneBatch& batch) noexcept;

/// Appends what one rank keeps: see CONTRACT.md, "Checkpoints of clusters".
[[nodiscard]] Status write_checkpoint(std::span<const BodyName> names,
                                      std::span<const BodyRecord> bodies,
                                      std::span<const TouchingPair> touching,
                                      std::vector<std::byte>& bytes);
/// Reads any number of checkpoints, one after the other. `invalid_argument` for other bytes; shapes
/// and poses are not looked at.
[[nodiscard]] Status read_checkpoints(std::span<const std::byte> bytes, RecordBatch& batch);

}  // namespace winnow
