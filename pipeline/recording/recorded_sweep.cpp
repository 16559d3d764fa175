#include <winnow/pipeline/recording.h>

#include "pipeline/recording/recorder_state.h"
#include "pipeline/recording/sweep_digest.h"

namespace winnow {

RecordedSweep::RecordedSweep(RecordedScene& scene, std::pmr::memory_resource* memory) noexcept
    : scene_(scene), sweep_(scene.scene_, memory) {}

/// Records a sweep with this status: put(call) writes the motions.
template <typename Put>
Status RecordedSweep::record(RecordedCall question, Status status, std::span<const Key> keys,
                             const SweepOptions& options, Put&& put) {
  if (status != Status::ok) {
    scene_.forget_passed();
    return status;
  }
  scene_.record_passed();
  CallWriter call(scene_.recorder_, question, scene_.world_);
  call.put_ids(keys);
  put(call);
  call.put(options.pairs).put_array(options.bullets);
  call.put(options.tolerance).put(options.touching).put(options.first_only);
  call.put(digest_of_answers(sweep_).value());
  return status;
}

Status RecordedSweep::sweep(std::span<const Key> keys, const PoseView& ends,
                            const SweepOptions& options) {
  scene_.follow_composites();
  return record(RecordedCall::sweep, sweep_.sweep(keys, ends, options), keys, options,
                [&](CallWriter& call) { call.put_poses(ends); });
}

Status RecordedSweep::sweep(std::span<const Key> keys, std::span<const RigidMotion> motions,
                            const SweepOptions& options) {
  scene_.follow_composites();
  return record(RecordedCall::sweep_motions, sweep_.sweep(keys, motions, options), keys, options,
                [&](CallWriter& call) { call.put_array(motions); });
}

}  // namespace winnow
