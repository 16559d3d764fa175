#pragma once

#include "report/section.h"

#include <string>

namespace winnow::bench {

/// How the options of subcommands name a scene of so many objects: " --scene ...".
[[nodiscard]] inline std::string scene_words(const ReportOptions& options, const ReportScene& scene,
                                             std::size_t objects) {
  std::string words = " --scene " + scene.argument;
  if (scene.recording) return words;
  words += " --objects " + std::to_string(objects);
  if (options.seed != 1) words += " --seed " + std::to_string(options.seed);
  return words;
}

/// Its own number if it is a recording.
[[nodiscard]] inline std::size_t objects_of(const ReportScene& scene, std::size_t asked) {
  return scene.recording ? scene.recording->objects() : asked;
}

}  // namespace winnow::bench
