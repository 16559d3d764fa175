#pragma once

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
void add_targets_option(CLI::App& app, Choice& choice);
void add_objects_option(CLI::App& app, Choice& choice);
void add_threads_option(CLI::App& app, Choice& choice);
void add_partitions_option(CLI::App& app, Choice& choice);
void add_isa_option(CLI::App& app, Choice& choice);
void add_seed_option(CLI::App& app, Choice& choice);
void add_frames_option(CLI::App& app, std::size_t& frames);
void add_json_option(CLI::App& app, std::string& path);

/// 1, and all cores if there are more.
[[nodiscard]] std::vector<int> usual_threads();

/// Makes the named instruction set the active one; an empty name changes nothing. Throws
/// ArgumentError, with the names there are.
void choose_isa(const std::string& name);

}  // namespace winnow::bench
