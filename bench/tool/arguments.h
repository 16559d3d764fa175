#pragma once

#include "engine/race.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// What several subcommands ask for in the same words.
struct Choice {
  std::vector<std::string> scenes;
  std::vector<std::size_t> objects;
  std::vector<int> threads;
  std::vector<std::string> partitions{"all"};
  std::string isa;
  std::uint64_t seed = 1;
};

// Each adds one option; lists are comma-separated or repeated.
void add_scenes_option(CLI::App& app, Choice& choice);
/// Of recordings, too.
void add_targets_option(CLI::App& app, Choice& choice);
void add_objects_option(CLI::App& app, Choice& choice);
void add_threads_option(CLI::App& app, Choice& choice);
void add_partitions_option(CLI::App& app, Choice& choice);
void add_isa_option(CLI::App& app, Choice& choice);
void add_seed_option(CLI::App& app, Choice& choice);
void add_frames_option(CLI::App& app, std::size_t& frames);
void add_json_option(CLI::App& app, std::string& path);

/// Names of the main scenes.
[[nodiscard]] std::vector<std::string> main_scenes();
/// 1, and all cores if there are more.
[[nodiscard]] std::vector<int> usual_threads();

/// Makes the named instruction set the active one; an empty name changes nothing. Throws
/// ArgumentError, with the names there are.
void choose_isa(const std::string& name);

/// The scene, or ArgumentError with the names there are.
[[nodiscard]] std::unique_ptr<FrameSource> scene_or_error(const std::string& name,
                                                          std::size_t objects, std::uint64_t seed);

struct Partitions {
  std::vector<std::string> taken;
  std::vector<std::string> skipped;  ///< "NSquared (more than 2,000 objects)"
};

/// The partitions asked for: each one named is taken; "all" takes those that suit so many objects.
[[nodiscard]] Partitions partitions_for(const std::vector<std::string>& names, std::size_t objects);

/// One contender for each partition.
[[nodiscard]] std::vector<Contender> make_contenders(const std::vector<std::string>& partitions,
                                                     int threads);

/// "skipped: a, b" and a line end, or nothing.
[[nodiscard]] std::string skipped_line(const std::vector<std::string>& skipped);

}  // namespace winnow::bench
