#include "bench/rows/query_rows.h"

#include <winnow/simd/isa.h>
#include "bench/measure/fingerprint.h"
#include "bench/measure/query_costs.h"
#include "bench/rows/machine.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr const char* kReading = "reading all boxes once";

/// Returns the kind of a query set: the first word of its name, but "ray any" as a whole. Sets of
/// one kind differ in how many objects they find.
std::string query_kind_of(const std::string& set) {
  if (set == "ray any") return set;
  return set.substr(0, set.find(' '));
}

Json query_row_of(const QueryRun& run) {
  const auto questions = static_cast<double>(run.questions);
  std::vector<double> ns;
  for (const double ms : run.ms) ns.push_back(1e6 * ms / questions);
  return {{"set", run.set},
          {"engine", run.engine},
          {"asked", run.mode == QueryMode::single ? "single" : "batch"},
          {"threads", run.threads},
          {"ns", to_value(ns)},
          {"found", run.found_a_question()},
          {"kind", query_kind_of(run.set)},
          {"questions", run.questions},
          {"wrong", run.comparison.wrong},
          {"undecided", run.comparison.undecided},
          {"fingerprint", to_hex(run.fingerprint)}};
}

}  // namespace

QueryMeasurement add_queries(Results& results, const NamedScene& scene,
                             QueryMeasureOptions options) {
  options.scene = scene.argument;
  options.recording = scene.recording.get();
  QueryMeasurement measured = measure_queries(options);
  std::string where = "bench/run queries" +
                      std::string(scene.is_recording() ? " --recording " : " --scene ") +
                      shell_word(scene.argument);
  if (!scene.is_recording()) where += " --objects " + std::to_string(options.objects);
  std::string problems;
  for (const QueryRun& run : measured.runs) {
    if (!run.answered()) {
      problems += "; " + run.engine + " refused " + run.set + ": " + run.refusal;
      continue;
    }
    if (!run.comparison.agree()) {
      problems += "; " + run.engine + ", " + run.set + ": " + run.comparison.first;
    }
    Json row = query_row_of(run);
    row.update({{"scene", scene.name},
                {"objects", measured.objects},
                {"command", where + " --set \"" + run.set + "\" --partition " +
                                (is_peer(run.engine) ? "LinearBvh" : run.engine) + " --threads " +
                                std::to_string(options.threads) + " --rays " +
                                std::to_string(options.rays) + " --rounds " +
                                std::to_string(options.rounds) + " --seed " +
                                std::to_string(options.seed) + " --isa " + isa_name()}});
    results.add("queries", std::move(row));
  }
  if (!problems.empty()) throw std::runtime_error(problems.substr(2));
  return measured;
}

void add_frusta(Results& results, std::size_t objects, std::size_t rounds) {
  const std::vector<std::string> partitions{"LinearBvh", "FlatGrid", "BoundsNSquared"};
  for (const char* set : {"frustum 1%", "frustum 50%"}) {
    const FrustumCosts costs = measure_frustum_costs(partitions, set, objects, rounds);
    for (std::size_t i = 0; i < costs.ms.size(); ++i) {
      results.add("frusta", {{"objects", objects},
                             {"set", set},
                             {"engine", i < partitions.size() ? partitions[i] : kReading},
                             {"ms", to_value(costs.ms[i])},
                             {"found", costs.found_a_question},
                             {"command", "bench/run goals --topic queries"}});
    }
  }
}

}  // namespace winnow::bench
