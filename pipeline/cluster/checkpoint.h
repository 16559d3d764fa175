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

/// The bodies that one rank saves or restores, and their touching pairs.
struct RecordBatch {
  std::vector<BodyName> names;
  std::vector<BodyRecord> bodies;
  std::vector<TouchingPair> touching;  // sorted
};

/// Converts records to definitions, with names as client data.
[[nodiscard]] std::vector<BodyDefinition> definitions_of(std::span<const BodyName> names,
                                                         std::span<const BodyRecord> bodies);
/// Converts definitions to records of new bodies.
[[nodiscard]] std::vector<BodyRecord> records_of(std::span<const BodyDefinition> bodies);
/// Returns a digest of the names, poses, shapes, motions and filters of a batch.
[[nodiscard]] std::uint64_t digest_of_batch(const ClusterSceneBatch& batch) noexcept;

/// Appends the checkpoint of one rank: see FORMATS.md, "Checkpoints of clusters".
[[nodiscard]] Status write_checkpoint(std::span<const BodyName> names,
                                      std::span<const BodyRecord> bodies,
                                      std::span<const TouchingPair> touching,
                                      std::vector<std::byte>& bytes);
/// Reads any number of consecutive checkpoints. `invalid_argument` if the bytes are not
/// checkpoints. Does not check shapes and poses.
[[nodiscard]] Status read_checkpoints(std::span<const std::byte> bytes, RecordBatch& batch);

}  // namespace winnow
