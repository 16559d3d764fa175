#include "bench/rows/named_scene.h"

#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

namespace winnow::bench {

std::size_t NamedScene::objects(std::size_t requested) const {
  return recording ? recording->objects() : requested;
}

std::unique_ptr<FrameSource> NamedScene::source(std::size_t objects, std::uint64_t seed) const {
  return recording ? play(*recording) : scene_or_error(argument, objects, seed);
}

std::string NamedScene::words(std::size_t objects, std::uint64_t seed) const {
  std::string words = " --scene " + shell_word(argument);
  if (recording) return words;
  words += " --objects " + std::to_string(objects);
  if (seed != 1) words += " --seed " + std::to_string(seed);
  return words;
}

std::vector<NamedScene> named_scenes(const std::vector<std::string>& arguments) {
  std::vector<NamedScene> scenes;
  const auto is_taken = [&](const std::string& text, std::string NamedScene::*member) {
    return std::any_of(scenes.begin(), scenes.end(),
                       [&](const NamedScene& scene) { return scene.*member == text; });
  };
  for (const std::string& argument : arguments) {
    if (is_taken(argument, &NamedScene::argument)) continue;
    if (is_built_in(argument)) {
      scenes.push_back({argument, argument});
      continue;
    }
    if (!std::filesystem::exists(argument)) {
      throw ArgumentError(argument +
                          " is neither a file nor the name of a scene (see: winnow scenes)");
    }
    auto recording = std::make_shared<const Recording>(read_recording(argument));
    std::string name = recording->scene.empty() ? argument : recording->scene;
    if (is_built_in(name) || is_taken(name, &NamedScene::name)) name += " (" + argument + ")";
    scenes.push_back({std::move(name), argument, std::move(recording)});
  }
  return scenes;
}

std::string shell_word(const std::string& word) {
  const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::strchr("_-./+,:=@%", c) != nullptr;
  });
  if (plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string settings_text(int threads, Isa isa) {
  return " --threads " + std::to_string(threads) + " --isa " + to_string(isa);
}

}  // namespace winnow::bench
