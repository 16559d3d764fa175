#pragma once

#include "bench/scenes/pair_kind.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace winnow::bench {

/// What subcommands about pairs of shapes ask for in the same words.
struct NarrowChoice {
  std::vector<std::string> kinds{"all"};
  std::vector<std::string> levels{"all"};
  std::vector<std::string> tiers;

  [[nodiscard]] std::vector<PairKind> chosen_kinds() const;
  [[nodiscard]] std::vector<ContactLevel> chosen_levels() const;
  [[nodiscard]] std::vector<NarrowTier> chosen_tiers() const;
};

// Each adds one option; lists are comma-separated or repeated, and "all" is all there are.
void add_kind_option(CLI::App& app, NarrowChoice& choice);
void add_level_option(CLI::App& app, NarrowChoice& choice);
void add_tier_option(CLI::App& app, NarrowChoice& choice);

}  // namespace winnow::bench
