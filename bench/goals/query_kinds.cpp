#include "engine/upkeep.h"
#include "goals/kinds.h"
#include "queries/query_costs.h"
#include "tool/table.h"

#include <algorithm>

namespace winnow::bench {
namespace {

/// Measures; a refused question makes a goal that does not hold.
template <typename Measure>
Goal with_refusal(Goal goal, Measure&& measure) {
  try {
    measure(goal);
  } catch (const Refusal& refusal) {
    goal.measured = goal.sense == Goal::Sense::at_most ? kUnanswered : 0.0;
    goal.detail = std::string("refused: ") + refusal.what();
  }
  return goal;
}

}  // namespace

std::vector<Goal> query_speed(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string partition = ask.text("partition");
  const std::string set = ask.text("set");
  const Asking asking = ask.text("asking") == "batch" ? Asking::batch : Asking::single;
  const QueryMeasurement& measured =
      lab.queries(partition, ask.text("scene"), ask.count("objects"));
  Goal goal{.what = ask.text("scene") + ", " + on_size(ask.count("objects"), 1) + ": " + set +
                    ", " + ask.text("asking") + ": " + partition + " against " +
                    ask.text("existing"),
            .unit = "times faster",
            .sense = Goal::Sense::at_least,
            .asked = ask.number("asked")};
  const QueryRun* own = find_run(measured.runs, partition, set, asking);
  if (own == nullptr) {
    goal.detail = "refused";
    return {goal};
  }
  const QueryRun* peer = find_run(measured.runs, ask.text("existing"), set, Asking::single);
  const double scale = measured.machine_ms / Lab::kReferenceMachineMs;
  const double existing =
      peer != nullptr ? peer->ns_a_question() : ask.number("existing_ns") * scale;
  goal.measured = existing / own->ns_a_question();
  goal.detail =
      short_number(own->ns_a_question()) + " ns a question, " + ask.text("existing") +
      (peer != nullptr ? " here " + short_number(existing)
                       : " is not installed, elsewhere " + short_number(ask.number("existing_ns")) +
                             " x " + short_number(scale));
  return {goal};
}

std::vector<Goal> frustum_speed(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const std::string partition = ask.text("partition");
  const Goal goal{.what = on_size(ask.count("objects"), 1) + ": " + ask.text("set") + ": " +
                          partition + " over reading all boxes once",
                  .unit = "ratio",
                  .asked = ask.number("asked")};
  return {with_refusal(goal, [&](Goal& row) {
    const FrustumCosts& costs = lab.frustum(ask.text("set"), ask.count("objects"));
    const auto names = Lab::frustum_partitions();
    const auto at = std::find(names.begin(), names.end(), partition);
    if (at == names.end()) ask.fail("partition: " + partition + " is not measured");
    const double ms = median_of(costs.asked[static_cast<std::size_t>(at - names.begin())]);
    const double read_ms = median_of(costs.read);
    row.measured = ms / read_ms;
    row.detail = short_number(1e3 * ms) + " us, reading " + short_number(1e3 * read_ms) + " us; " +
                 short_number(costs.found_a_question) + " objects found";
  })};
}

std::vector<Goal> query_allocations(const Ask& ask, const std::vector<Ask>& /*all*/, Lab&) {
  std::vector<Goal> goals;
  for (const std::string& partition : Lab::testing_partitions()) {
    const Goal goal{
        .what = on_size(ask.count("objects"), 1) + ": allocations when asked again: " + partition,
        .unit = "allocations",
        .asked = ask.number("asked")};
    goals.push_back(with_refusal(goal, [&](Goal& row) {
      const std::vector<SecondRound> rounds =
          measure_second_rounds(partition, ask.count("objects"));
      for (const SecondRound& round : rounds) {
        if (round.allocations == 0) continue;
        row.measured += static_cast<double>(round.allocations);
        row.detail += (row.detail.empty() ? "" : "; ") + round.set;
      }
      if (row.detail.empty()) row.detail = std::to_string(rounds.size()) + " kinds of questions";
    }));
  }
  return goals;
}

std::vector<Goal> churn(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  std::vector<Goal> goals;
  for (const std::string& partition : ask.get<std::vector<std::string>>("partitions")) {
    const std::size_t objects = ask.count("objects");
    const std::size_t operations = ask.count("operations");
    const ChurnCosts costs = measure_churn(partition, objects, operations);
    const auto add = [&](const char* what, double ratio) {
      goals.push_back({.what = on_size(objects, 1) + ", " + grouped(operations) +
                               " removals and insertions: " + partition + ": " + what +
                               " over a fresh build",
                       .unit = "ratio",
                       .asked = ask.number("asked"),
                       .measured = ratio});
    };
    add("self pairs", costs.self_pairs);
    add("rays", costs.rays);
    add("bytes", costs.bytes);
    goals.back().detail = short_number(costs.bytes_an_object) + " bytes an object";
  }
  return goals;
}

std::vector<Goal> pair_events(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  const std::string partition = ask.text("partition");
  const auto asked = ask.get<std::vector<double>>("asked");
  const auto parts = ask.get<std::vector<double>>("shares");
  if (asked.size() != parts.size()) ask.fail("asked: not as many as shares");
  std::vector<double> shares{1.0};
  shares.insert(shares.end(), parts.begin(), parts.end());
  std::vector<double> ms;
  std::vector<Goal> goals;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Goal goal{.what = on_size(ask.count("objects"), 1) + ": " + partition +
                            ": pair events with " + percent(parts[i]) + " moving over all moving",
                    .unit = "ratio",
                    .asked = asked[i]};
    goals.push_back(with_refusal(goal, [&](Goal& row) {
      if (ms.empty()) ms = measure_event_frames(partition, ask.count("objects"), shares);
      row.measured = ms[i + 1] / ms[0];
      row.detail = short_number(ms[i + 1]) + " of " + short_number(ms[0]) + " ms";
    }));
  }
  return goals;
}

std::vector<Goal> many_worlds(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& /*lab*/) {
  const std::string partition = ask.text("partition");
  const std::size_t worlds = ask.count("worlds");
  const std::size_t objects = ask.count("objects");
  const Goal goal{.what = grouped(worlds) + " worlds of " + grouped(objects) +
                          " objects: " + partition + ": all as environments of one over one each",
                  .unit = "ratio",
                  .asked = ask.number("asked")};
  return {with_refusal(goal, [&](Goal& row) {
    const WorldCosts costs = measure_worlds(partition, worlds, objects);
    row.measured = costs.same_pairs ? costs.together_ms / costs.apart_ms : kUnanswered;
    row.detail = short_number(costs.together_ms) + " ms, apart " + short_number(costs.apart_ms) +
                 " ms" + (costs.same_pairs ? "" : "; OTHER PAIRS");
  })};
}

}  // namespace winnow::bench
