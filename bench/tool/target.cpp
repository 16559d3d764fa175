#include "tool/target.h"

#include "scenes/scene.h"
#include "tool/command.h"

#include <algorithm>
#include <filesystem>

namespace winnow::bench {

void Target::open() {
  const auto infos = scene_infos();
  const bool is_scene = std::any_of(infos.begin(), infos.end(),
                                    [&](const SceneInfo& info) { return info.name == name; });
  if (is_scene && !std::filesystem::exists(name)) return;
  if (objects || seed) {
    throw ArgumentError("--objects and --seed go with the name of a scene, and " + name +
                        " is not one (see: winnow scenes)");
  }
  if (!std::filesystem::exists(name)) {
    throw ArgumentError(name + " is neither a file nor the name of a scene (see: winnow scenes)");
  }
  recording_ = read_recording(name);
}

std::vector<Target> open_targets(const std::vector<std::string>& names) {
  std::vector<Target> targets;
  for (const std::string& name : names) {
    Target& target = targets.emplace_back();
    target.name = name;
    target.open();
  }
  return targets;
}

std::unique_ptr<FrameSource> Target::source() const {
  if (recording_) return play(*recording_);
  return make_scene(name, objects.value_or(10'000), seed.value_or(1));
}

}  // namespace winnow::bench
