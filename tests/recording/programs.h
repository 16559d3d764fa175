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

/// A sink that keeps everything.
[[nodiscard]] inline RecordingSink kept_in(Bytes8& bytes) {
  return {[](void* context, std::span<const std::byte> more) {
            auto& all = *static_cast<Bytes8*>(context);
            all.insert(all.end(), more.begin(), more.end());
            return true;
          },
          &bytes};
}

/// Boxes that come, move and go, and every kind of question to them, for so many frames.
void record_partition(Recorder& recorder, StructureKind structure, std::size_t count, int frames);
/// The same for each kind of volume.
void record_volumes(Recorder& recorder, std::size_t count);
/// Bodies that come, move, fall asleep and go, what touches, and every kind of question to them.
void record_scene(Recorder& recorder, std::size_t count, int frames, const SceneOptions& options);

}  // namespace winnow::test
