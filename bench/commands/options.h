#pragma once

#include "bench/rows/named_scene.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace winnow::bench {

// Options in the same words for all subcommands.

template <typename T>
struct OptionValue {
  static constexpr bool is_list = false;
  using Each = T;
};
template <typename T>
struct OptionValue<std::vector<T>> {
  static constexpr bool is_list = true;
  using Each = T;
};
template <typename T>
struct OptionValue<std::optional<T>> {
  static constexpr bool is_list = false;
  using Each = T;
};

/// Shows its default if it has one. A list is comma-separated or repeated.
template <typename T>
CLI::Option* option(CLI::App& app, const char* name, T& value, const std::string& what) {
  CLI::Option* added = app.add_option(name, value, what);
  if constexpr (OptionValue<T>::is_list) added->delimiter(',');
  if (!(value == T{})) added->capture_default_str();
  return added;
}

/// A number, or each number of a list, lies between these.
template <typename T>
CLI::Option* number(CLI::App& app, const char* name, T& value, double least, double most,
                    const std::string& what) {
  using Each = typename OptionValue<T>::Each;
  return option(app, name, value, what)
      ->check(CLI::Range(static_cast<Each>(least), static_cast<Each>(most)));
}

/// A text, or each text of a list, is one of these.
template <typename T>
CLI::Option* one_of(CLI::App& app, const char* name, T& value,
                    const std::vector<std::string>& names, const std::string& what) {
  return option(app, name, value, what)->check(CLI::IsMember(names));
}

/// One number of objects, or several.
template <typename T>
void add_objects_option(CLI::App& app, T& objects, const char* what = "Number of objects") {
  number(app, "--objects", objects, 1, 1e8, what);
}
/// One number of threads, or several.
template <typename T>
void add_threads_option(CLI::App& app, T& threads, const char* what = "Number of threads") {
  number(app, "--threads", threads, 1, 1024, what);
}
template <typename T>
void add_frames_option(CLI::App& app, T& frames, const char* what = "Frames, the first included") {
  number(app, "--frames", frames, 1, 1e6, what);
}
void add_partitions_option(CLI::App& app, std::vector<std::string>& partitions);
void add_isa_option(CLI::App& app, std::string& isa);
void add_seed_option(CLI::App& app, std::uint64_t& seed);
void add_json_option(CLI::App& app, std::string& path);

/// 1, and all cores if there are more.
[[nodiscard]] std::vector<int> usual_threads();

/// Makes the named instruction set the active one; an empty name changes nothing. Throws
/// ArgumentError, with the names there are.
void choose_isa(const std::string& name);

/// Of a built-in scene, unless asked otherwise.
inline constexpr std::size_t kSceneObjects = 10'000;

/// What a command shows that takes one scene: a built-in one by name, or a recording.
struct Target {
  std::string name;
  std::optional<std::size_t> objects;  ///< of a built-in scene
  std::optional<std::uint64_t> seed;   ///< of a built-in scene; unset: 1

  /// The argument and its two options.
  void add_to(CLI::App& app);
  /// Throws ArgumentError or RecordingError.
  [[nodiscard]] NamedScene named() const;
  /// From the first frame on.
  [[nodiscard]] std::unique_ptr<FrameSource> source(const NamedScene& scene) const {
    return scene.source(objects.value_or(kSceneObjects), seed.value_or(1));
  }
};

}  // namespace winnow::bench
