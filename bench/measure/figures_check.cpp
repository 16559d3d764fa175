#include "bench/measure/figures_check.h"

#include <winnow/partitions/structures.h>

#include "bench/common/errors.h"
#include "bench/measure/advice.h"
#include "bench/scenes/scene.h"
#include "partitions/choice/predicted_costs.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

namespace winnow::bench {
namespace {

/// Median frame times by candidate, for each scene and number of objects.
using Figures = std::map<std::pair<std::string, std::size_t>, std::map<std::string, double>>;

constexpr std::array<const char*, 5> kColumns{"scene", "objects", "threads", "kind", "median_ms"};

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

/// Returns the index of each column in a line.
std::array<std::size_t, kColumns.size()> columns_of(const std::string& path,
                                                    const std::string& line) {
  const std::vector<std::string> names = fields_of(line);
  std::array<std::size_t, kColumns.size()> at{};
  for (std::size_t c = 0; c < at.size(); ++c) {
    const auto found = std::find(names.begin(), names.end(), kColumns[c]);
    if (found == names.end()) {
      throw ArgumentError(path + " has no column " + kColumns[c] + " in its first line");
    }
    at[c] = static_cast<std::size_t>(found - names.begin());
  }
  return at;
}

bool is_candidate(const std::string& kind) {
  return std::ranges::any_of(candidates(), [&](StructureKind k) { return k.name() == kind; });
}

Figures read_figures(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) throw ArgumentError("cannot read " + path);
  const auto at = columns_of(path, line);
  Figures figures;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> fields = fields_of(line);
    try {
      const auto field = [&](std::size_t column) { return fields.at(at[column]); };
      if (field(2) != "1" || !is_candidate(field(3))) continue;
      figures[{field(0), std::stoul(field(1))}][field(3)] = std::stod(field(4));
    } catch (const std::logic_error&) {
      throw ArgumentError(path + ", line " + std::to_string(number) + ": not a row of figures");
    }
  }
  return figures;
}

}  // namespace

std::vector<FigureCheck> check_figures(const std::string& path, std::size_t frames) {
  std::vector<FigureCheck> checks;
  for (const auto& [where, times] : read_figures(path)) {
    const auto& [name, objects] = where;
    const auto scene = scene_or_error(name, objects, 1);
    const std::string other{linear_bvh().name()};
    const std::string chosen = advise(*scene, {other, "AutoPartition"}, frames, 1).chosen;
    const auto best = std::ranges::min_element(times, {}, [](const auto& t) { return t.second; });
    const auto own = times.find(chosen);
    if (own == times.end()) continue;
    checks.push_back({name, objects, chosen, best->first, own->second / best->second});
  }
  return checks;
}

}  // namespace winnow::bench
