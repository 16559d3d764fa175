#include <winnow/pipeline/recording.h>

#include "pipeline/recording/impact_digest.h"
#include "pipeline/recording/recorder_state.h"

namespace winnow {

RecordedContinuousCollision::RecordedContinuousCollision(RecordedScene& scene,
                                                         std::pmr::memory_resource* memory) noexcept
    : scene_(scene), ccd_(scene.scene_, memory) {}

/// Records a call that returned `status`, if that is `ok`; put(call) writes the motions.
template <typename Put>
Status RecordedContinuousCollision::record(RecordedCall kind, Status status,
                                           std::span<const Key> keys,
                                           const ContinuousOptions& options, Put&& put) {
  if (status != Status::ok) {
    scene_.forget_passed();
    return status;
  }
  scene_.record_passed();
  CallWriter call(scene_.recorder_, kind, scene_.world_);
  call.put_ids(keys);
  put(call);
  call.put(options.pairs).put_array(options.bullets);
  call.put(options.tolerance).put(options.touching).put(options.first_only);
  call.put(digest_of_answers(ccd_).value());
  return status;
}

Status RecordedContinuousCollision::find_impacts(std::span<const Key> keys, const PoseView& ends,
                                                 const ContinuousOptions& options) {
  scene_.record_composite_changes();
  return record(RecordedCall::find_impacts, ccd_.find_impacts(keys, ends, options), keys, options,
                [&](CallWriter& call) { call.put_poses(ends); });
}

Status RecordedContinuousCollision::find_impacts(std::span<const Key> keys,
                                                 std::span<const RigidMotion> motions,
                                                 const ContinuousOptions& options) {
  scene_.record_composite_changes();
  return record(RecordedCall::find_impacts_of_motions, ccd_.find_impacts(keys, motions, options),
                keys, options, [&](CallWriter& call) { call.put_array(motions); });
}

}  // namespace winnow
