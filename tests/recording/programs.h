#pragma once

#include <winnow/winnow.h>

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "tests/pipeline/scene_world.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace winnow::test {

using Bytes8 = std::vector<std::byte>;

/// Returns a sink that stores everything in `bytes`.
[[nodiscard]] inline RecordingSink kept_in(Bytes8& bytes) {
  return {[](void* context, std::span<const std::byte> more) {
            auto& all = *static_cast<Bytes8*>(context);
            all.insert(all.end(), more.begin(), more.end());
            return true;
          },
          &bytes};
}

/// Returns the options of a scene with a recorder.
[[nodiscard]] inline SceneOptions recorded_by(Recorder& recorder, SceneOptions options) {
  options.recorder = &recorder;
  return options;
}

/// Inserts, moves and removes boxes, and makes every kind of query, for this number of frames.
void record_partition(Recorder& recorder, StructureKind structure, std::size_t count, int frames);
/// As above, for each kind of volume.
void record_volumes(Recorder& recorder, std::size_t count);
/// Adds, moves, deactivates and removes bodies, computes contacts, and makes every kind of query.
void record_scene(Recorder& recorder, std::size_t count, int frames, const SceneOptions& options);

}  // namespace winnow::test
