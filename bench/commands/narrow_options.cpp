#include "bench/commands/narrow_options.h"

#include <algorithm>
#include <span>

namespace winnow::bench {
namespace {

bool is_chosen(const std::vector<std::string>& names, std::string_view name) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& n) { return n == name || n == "all"; });
}

void add_names(CLI::App& app, const std::string& option, std::vector<std::string>& chosen,
               std::vector<std::string> names, const std::string& what) {
  names.emplace_back("all");
  app.add_option(option, chosen, what)
      ->delimiter(',')
      ->check(CLI::IsMember(names))
      ->capture_default_str();
}

template <typename Names>
std::vector<std::string> strings(const Names& names) {
  return {names.begin(), names.end()};
}

/// Those of `all` whose names are chosen.
template <typename Enum, typename Names>
std::vector<Enum> chosen(const std::vector<std::string>& choice, std::span<const Enum> all,
                         const Names& names) {
  std::vector<Enum> taken;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_chosen(choice, names[i])) taken.push_back(all[i]);
  }
  return taken;
}

}  // namespace

std::vector<PairKind> NarrowChoice::chosen_kinds() const {
  std::vector<PairKind> taken;
  for (const PairKind& kind : pair_kinds()) {
    if (is_chosen(kinds, kind.name)) taken.push_back(kind);
  }
  return taken;
}

std::vector<ContactLevel> NarrowChoice::chosen_levels() const {
  return chosen<ContactLevel>(levels, kLevels, kLevelNames);
}

std::vector<NarrowTier> NarrowChoice::chosen_tiers() const {
  constexpr NarrowTier kTiers[] = {NarrowTier::fast, NarrowTier::robust, NarrowTier::reference};
  return chosen<NarrowTier>(tiers, kTiers, kTierNames);
}

void add_kind_option(CLI::App& app, NarrowChoice& choice) {
  std::vector<std::string> names;
  for (const PairKind& kind : pair_kinds()) names.emplace_back(kind.name);
  add_names(app, "--kind", choice.kinds, names, "Kinds of pairs");
}

void add_level_option(CLI::App& app, NarrowChoice& choice) {
  add_names(app, "--level", choice.levels, strings(kLevelNames), "How much is asked of a pair");
}

void add_tier_option(CLI::App& app, NarrowChoice& choice) {
  add_names(app, "--tier", choice.tiers, strings(kTierNames), "How exact answers must be");
}

}  // namespace winnow::bench
