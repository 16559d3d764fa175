#pragma once

#include <winnow/pipeline/cluster_scene.h>
#include "pipeline/cluster/checkpoint.h"
#include "pipeline/cluster/rank_group.h"
#include "pipeline/cluster/rank_scene.h"

#include <deque>
#include <span>

namespace winnow {

/// State of a ClusterScene: the hosted ranks and their scenes.
struct ClusterSceneState : RankGroup {
  ClusterSceneState(Transport& given, const ShapePool& shapes, const ClusterSceneOptions& options);

  [[nodiscard]] RankScene* find(std::uint32_t rank) noexcept {
    const std::uint32_t place = rank - first;
    return place < scenes.size() ? &scenes[place] : nullptr;
  }

  /// Sends bodies to the ranks that they belong to at their current poses, and copies to the other
  /// ranks whose regions they overlap.
  [[nodiscard]] Status migrate();
  [[nodiscard]] Status add(std::span<const ClusterSceneBatch> batches, std::span<Status> answers);
  /// Adds the bodies of checkpoints. If reading a checkpoint failed, `answers` contains the error,
  /// and nothing of it is added.
  [[nodiscard]] Status restore(std::span<const RecordBatch> batches, std::span<Status> answers);
  /// Sets `refused` to `ok`, or to the reason why nothing was added; the same on all processes.
  [[nodiscard]] Status replicate(const ClusterSceneBatch& batch, Status& refused);
  [[nodiscard]] Status move_replicated(std::span<const BodyName> bodies,
                                       std::span<const Pose> poses, Status& refused);
  [[nodiscard]] Status collide(ContactLevel level);
  [[nodiscard]] Status digest(ClusterDigest& digest);

  std::deque<RankScene> scenes;

 private:
  [[nodiscard]] Status deliver();
  [[nodiscard]] Status deliver_removals();
  [[nodiscard]] Status take_names_of(std::span<const std::span<const BodyName>> requested,
                                     std::span<Status> answers);
  [[nodiscard]] Status agree(std::uint64_t argument_digest, Status& refused);
  [[nodiscard]] Status agree_on_events();
  [[nodiscard]] Status count_found(Status found);
};

}  // namespace winnow
