#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/json.h"
#include "bench/common/progress.h"
#include "bench/common/table.h"
#include "bench/goals/evaluate.h"
#include "bench/goals/goal_entries.h"

#include <algorithm>
#include <iostream>

namespace winnow::bench {
namespace {

struct Goals {
  std::string topic;
  std::string json;
  std::size_t worst_of = MeasurementCache::kWorstOf;

  void add_options(CLI::App& app) {
    one_of(app, "--topic", topic, {kTopics.begin(), kTopics.end()}, "Only this topic");
    number(app, "--worst-of", worst_of, 1, 1e6,
           "Number of frames for requirements about the worst frame");
    add_json_option(app, json);
  }
  [[nodiscard]] int run() const;

 private:
  [[nodiscard]] std::vector<Goal> measure_all(MeasurementCache& measurement_cache) const;
};

std::vector<Goal> Goals::measure_all(MeasurementCache& measurement_cache) const {
  std::vector<Json> entries;
  for (Json& entry : parse_goals(kGoalsJson)) {
    if (topic.empty() || entry["topic"] == topic) entries.push_back(std::move(entry));
  }
  std::vector<Goal> goals;
  Progress progress(entries.size());
  for (const Json& entry : entries) {
    progress.step(entry["topic"].get<std::string>() + ": " + entry["what"].get<std::string>());
    for (Goal& goal : evaluate(entry, measurement_cache)) goals.push_back(std::move(goal));
  }
  return goals;
}

void print(const std::string& topic, const std::vector<Goal>& goals) {
  Table table({"what", "bound", "measured", "unit", "holds", "by"});
  table.flush_left(3);
  table.flush_left(5);
  std::size_t holding = 0;
  for (const Goal& goal : goals) {
    if (goal.topic != topic) continue;
    const char* sense = goal.at_least ? ">= " : "<= ";
    table.add({goal.what, sense + short_number(goal.bound), short_number(goal.measured), goal.unit,
               goal.holds() ? "yes" : "NO", goal.detail});
    holding += goal.holds() ? 1 : 0;
  }
  const auto count = static_cast<std::size_t>(
      std::count_if(goals.begin(), goals.end(), [&](const Goal& g) { return g.topic == topic; }));
  std::cout << topic << '\n';
  if (count == 0) {
    std::cout << "this topic has no requirements\n\n";
    return;
  }
  std::cout << table << holding << " of " << count << " hold\n\n";
}

Json goal_json(const Goal& goal) {
  return {{"topic", goal.topic},
          {"what", goal.what},
          {"unit", goal.unit},
          {"bound", goal.bound},
          {"measured", goal.measured},
          {"holds", goal.holds()},
          {"sense", goal.at_least ? "at_least" : "at_most"},
          {"detail", goal.detail}};
}

int Goals::run() const {
  MeasurementCache measurement_cache(worst_of);
  const std::vector<Goal> goals = measure_all(measurement_cache);
  const Spread machine = measurement_cache.machine_ms();
  if (machine.max > 0.0) {
    std::cout << "reference sweep during the run: " << short_number(machine.min) << " to "
              << short_number(machine.max) << " ms, median " << short_number(machine.median)
              << " (23 ms on the machine where the other libraries were timed; a large range means "
                 "a disturbed run)\n\n";
  }
  for (const std::string_view name : kTopics) {
    if (topic.empty() || name == topic) print(std::string(name), goals);
  }
  Json rows = Json::array();
  for (const Goal& goal : goals) rows.push_back(goal_json(goal));
  write_json(json, rows);
  std::size_t short_of = 0;
  for (const Goal& goal : goals) {
    if (goal.holds()) continue;
    if (short_of++ == 0) std::cout << "missed:\n";
    std::cout << "  " << goal.topic << ": " << goal.what << ": " << short_number(goal.measured)
              << " " << goal.unit << ", bound " << short_number(goal.bound) << '\n';
  }
  return short_of == 0 ? kDone : kFailed;
}

}  // namespace

void add_goals(CLI::App& app) {
  command<Goals>(app, "goals", "Measures winnow and compares each figure with its requirement",
                 "Times of other libraries are scaled by a reference sweep in the same run.");
}

}  // namespace winnow::bench
