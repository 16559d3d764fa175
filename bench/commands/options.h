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

// Options that several subcommands share, so that names and help texts agree.

template <typename T>
inline constexpr bool kIsList = false;
template <typename T>
inline constexpr bool kIsList<std::vector<T>> = true;

/// Adds an option and shows its default if it has one. A list is comma-separated or repeated.
template <typename T>
CLI::Option* option(CLI::App& app, const char* name, T& value, const std::string& what) {
  CLI::Option* added = app.add_option(name, value, what);
  if constexpr (kIsList<T>) added->delimiter(',');
  if (!(value == T{})) added->capture_default_str();
  return added;
}

/// Adds an option whose number, or each number of a list, is in [least, most].
template <typename T>
CLI::Option* number(CLI::App& app, const char* name, T& value, double least, double most,
                    const std::string& what) {
  const auto one = [] {
    if constexpr (requires { typename T::value_type; }) {
      return typename T::value_type{};
    } else {
      return T{};
    }
  };
  using Each = decltype(one());
  return option(app, name, value, what)
      ->check(CLI::Range(static_cast<Each>(least), static_cast<Each>(most)));
}

/// Adds an option whose text, or each text of a list, is one of `names`.
template <typename T>
CLI::Option* one_of(CLI::App& app, const char* name, T& value,
                    const std::vector<std::string>& names, const std::string& what) {
  return option(app, name, value, what)->check(CLI::IsMember(names));
}

/// Takes one number of objects, or a list if T is one.
template <typename T>
void add_objects_option(CLI::App& app, T& objects, const char* what = "Number of objects") {
  number(app, "--objects", objects, 1, 1e8, what);
}
/// Takes one number of threads, or a list if T is one.
template <typename T>
void add_threads_option(CLI::App& app, T& threads, const char* what = "Number of threads") {
  number(app, "--threads", threads, 1, 1024, what);
}
template <typename T>
void add_frames_option(CLI::App& app, T& frames,
                       const char* what = "Number of frames, including the first one") {
  number(app, "--frames", frames, 1, 1e6, what);
}
void add_partitions_option(CLI::App& app, std::vector<std::string>& partitions);
void add_isa_option(CLI::App& app, std::string& isa);
void add_seed_option(CLI::App& app, std::uint64_t& seed);
void add_json_option(CLI::App& app, std::string& path);

/// Returns 1, and the number of cores if it is greater.
[[nodiscard]] std::vector<int> usual_threads();

/// Makes the named instruction set the active one; an empty name changes nothing. Throws
/// ArgumentError, which lists the available names, if the name is unknown.
void choose_isa(const std::string& name);

/// Default number of objects of a built-in scene.
inline constexpr std::size_t kSceneObjects = 10'000;
inline constexpr std::size_t kSceneFrames = 30;

/// The scene that a command runs on: a built-in one by name, or a recording.
struct Target {
  std::string name;
  std::optional<std::size_t> objects;  ///< for a built-in scene
  std::optional<std::uint64_t> seed;   ///< for a built-in scene; unset: 1

  /// Adds the argument and its two options.
  void add_to(CLI::App& app);
  /// Finds the scene or reads the recording. Throws ArgumentError or RecordingError.
  [[nodiscard]] NamedScene named() const;
  /// Returns the frames from the first on. `scene` must outlive the source.
  [[nodiscard]] std::unique_ptr<FrameSource> source(const NamedScene& scene) const {
    return scene.source(objects.value_or(kSceneObjects), seed.value_or(1));
  }
  /// Returns `requested`, or for 0 the frames of a recording, and kSceneFrames of a scene.
  [[nodiscard]] static std::size_t frames(const NamedScene& scene, std::size_t requested) {
    if (requested != 0) return requested;
    return scene.is_recording() ? scene.recording->frames.size() : kSceneFrames;
  }
};

}  // namespace winnow::bench
