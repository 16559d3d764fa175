#pragma once

#include "report/section.h"
#include "tool/html.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>

namespace winnow::bench {

/// A word as a shell takes it for one.
[[nodiscard]] inline std::string shell_word(const std::string& word) {
  const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::strchr("_-./+,:=@%", c) != nullptr;
  });
  return plain && !word.empty() ? word : "'" + replaced(word, "'", "'\\''") + "'";
}

/// How the options of subcommands name a scene of so many objects: " --scene ...".
[[nodiscard]] inline std::string scene_words(const ReportOptions& options, const ReportScene& scene,
                                             std::size_t objects) {
  std::string words = " --scene " + shell_word(scene.argument);
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
