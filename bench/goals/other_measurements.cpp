#include "bench/common/counting_resource.h"
#include "bench/contenders/partitions.h"
#include "bench/goals/measurements.h"
#include "bench/measure/query_costs.h"
#include "bench/measure/upkeep.h"
#include "bench/questions/hard_cases.h"
#include "bench/questions/questions.h"
#include "bench/rows/accuracy_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/query_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/simulation/flow_check.h"
#include "bench/simulation/flow_phases.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace winnow::bench {
namespace {

NarrowTier tier_named(const std::string& name) {
  const auto at = std::find(kTierNames.begin(), kTierNames.end(), name);
  if (at == kTierNames.end()) throw std::runtime_error("no tier " + name);
  return static_cast<NarrowTier>(at - kTierNames.begin());
}

const PairKind& kind_named(const std::string& name) {
  const PairKind* kind = find_pair_kind(name);
  if (kind == nullptr) throw std::runtime_error("no kind of pairs " + name);
  return *kind;
}

/// Of cases whose answers are wrong as they stand or with a and b exchanged.
std::size_t count_wrong(const Json& questions, NarrowTier tier) {
  Json exchanged = questions;
  for (Json& question : exchanged) {
    if (question.contains("a") && question.contains("b")) std::swap(question["a"], question["b"]);
  }
  const Json straight = answer(questions, tier);
  const Json turned = answer(exchanged, tier);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const bool right = fault(questions[i], straight[i], tier).empty() &&
                       fault(exchanged[i], turned[i], tier, -1.0).empty();
    wrong += right ? 0 : 1;
  }
  return wrong;
}

FlowOptions flow_options(const Json& options, Execution execution) {
  FlowOptions flow;
  flow.objects = options.at("objects");
  flow.shape = flow_shape_named(options.at("shape"));
  flow.execution = execution;
  return flow;
}

}  // namespace

/// One partition and the other libraries that answer questions, one thread.
void measure_queries_of(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_queries(measured.results);
  const NamedScene scene = named_scenes({options.at("scene")}).front();
  measured.machine_ms =
      add_queries(measured.results, scene,
                  {.objects = options.at("objects"),
                   .partitions = {options.at("partition")},
                   .rays = 50'000,
                   .rounds = 7,
                   .sets = {"ray closest", "ray all", "ray all near", "box 1", "box 5", "box 20"},
                   .peers = true})
          .machine_ms;
}

void measure_frusta(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_queries(measured.results);
  add_frusta(measured.results, options.at("objects"), 15);
}

/// Allocations of every partition when the same questions are asked again.
void measure_second_rounds_of(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"second_rounds",
                            "queries",
                            "allocations when asked again",
                            {"partition", "set"},
                            {{"allocations", "allocations", "", Better::less}}});
  for (const std::string& partition : testing_partitions()) {
    for (const SecondRound& round : measure_second_rounds(partition, options.at("objects"))) {
      measured.results.add(
          "second_rounds",
          {{"partition", partition}, {"set", round.set}, {"allocations", round.allocations}});
    }
  }
}

/// Partitions after many removals and insertions against fresh ones.
void measure_churn_of(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"churn",
                            "queries",
                            "a worn partition over a fresh one",
                            {"partition", "of"},
                            {{"ratio", "ratio", "times", Better::less}}});
  for (const std::string partition : options.at("partitions")) {
    const ChurnCosts costs =
        measure_churn(partition, options.at("objects"), options.at("operations"));
    for (const auto& [of, ratio] :
         {std::pair{"self pairs", costs.self_pairs}, std::pair{"rays", costs.rays},
          std::pair{"bytes", costs.bytes}}) {
      measured.results.add("churn", {{"partition", partition}, {"of", of}, {"ratio", ratio}});
    }
  }
}

/// Frames with pair events in which a share of the objects moves.
void measure_pair_events(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"pair_events",
                            "queries",
                            "frames with pair events",
                            {"partition", "share"},
                            {{"ms", "a frame", "ms", Better::less}}});
  const auto shares = options.at("shares").get<std::vector<double>>();
  const std::string partition = options.at("partition");
  const auto ms = measure_event_frames(partition, options.at("objects"), shares);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    measured.results.add("pair_events",
                         {{"partition", partition}, {"share", shares[i]}, {"ms", ms[i]}});
  }
}

/// One partition of many environments against a partition for each.
void measure_worlds_of(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"worlds",
                            "queries",
                            "many small worlds",
                            {"partition", "how"},
                            {{"ms", "a frame", "ms", Better::less}}});
  const std::string partition = options.at("partition");
  const WorldCosts costs = measure_worlds(partition, options.at("worlds"), options.at("objects"));
  if (!costs.same_pairs) throw std::runtime_error("other pairs were found");
  for (const auto& [how, ms] :
       {std::pair{"together", costs.together_ms}, std::pair{"apart", costs.apart_ms}}) {
    measured.results.add("worlds", {{"partition", partition}, {"how", how}, {"ms", ms}});
  }
}

/// Pairs of one kind: fast and robust on one thread, robust on two if there are too many pairs for
/// the caches, and the other libraries.
void measure_pairs(const Json& options, Lab& /*lab*/, Measured& measured) {
  const std::size_t pairs = options.at("pairs");
  declare_pair_times(measured.results, PairKeys::settings);
  measured.machine_ms =
      add_pair_times(
          measured.results,
          {.kind = kind_named(options.at("kind")),
           .pairs = pairs,
           .tiers = {NarrowTier::fast, NarrowTier::robust},
           .threads = pairs > kMostPairsInCache ? std::vector<int>{1, 2} : std::vector<int>{1},
           .peers = true},
          PairKeys::settings)
          .machine_ms;
}

/// One tier on all kinds of pairs.
void measure_errors(const Json& options, Lab& /*lab*/, Measured& measured) {
  const auto pairs = options.at("pairs").get<std::map<std::string, std::size_t>>();
  declare_pair_errors(measured.results);
  for (const PairKind& kind : pair_kinds()) {
    const auto own = pairs.find(std::string(kind.name));
    AccuracyOptions asked{
        .kind = kind,
        .levels = {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold},
        .tiers = {tier_named(options.at("tier"))},
        .peers = false};
    asked.set.pairs = own != pairs.end() ? own->second : pairs.at("others");
    asked.set.ratio = options.at("ratio");
    if (options.at("judge") == "reference") asked.judge = TruthSource::reference;
    add_pair_errors(measured.results, asked, false);
  }
}

/// Questions with reasoned answers in the files of a folder, either way round.
void measure_turned_cases(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare(
      {"turned_cases",
       "narrow",
       "hard cases, either way round",
       {"family"},
       {{"wrong", "wrong", "cases", Better::less}, {"cases", "cases", "", Better::neither}}});
  const NarrowTier tier = tier_named(options.at("tier"));
  const std::string folder = options.at("folder");
  std::error_code absent;
  for (const auto& file : std::filesystem::directory_iterator(folder, absent)) {
    if (file.path().extension() != ".json") continue;
    std::ifstream in(file.path());
    const Json questions = Json::parse(in);
    measured.results.add("turned_cases", {{"family", file.path().stem().string()},
                                          {"wrong", count_wrong(questions, tier)},
                                          {"cases", questions.size()}});
  }
  measured.absent = measured.results.rows("turned_cases").empty();
}

void measure_scenes(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_scenes(measured.results);
  measured.machine_ms = add_scene_race(measured.results, {.scene = options.at("scene"),
                                                          .resting = options.at("resting")})
                            .machine_ms;
}

void measure_tori(const Json& /*options*/, Lab& /*lab*/, Measured& measured) {
  declare_scenes(measured.results);
  measured.machine_ms = add_tori(measured.results, 11, true, true).machine_ms;
}

/// A frame of the granular flow against its phases, each by itself.
void measure_flow_frames(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"flow_frames",
                            "pipeline",
                            "a frame of a flow, and its phases alone",
                            {"how"},
                            {{"ms", "time", "ms", Better::less}}});
  GranularFlow flow(flow_options(options, Execution::serial()));
  flow.keep_contact_poses();
  for (std::size_t i = 0; i < options.at("steps").get<std::size_t>(); ++i) flow.step();
  FlowPhases phases(flow, Execution::serial());
  std::vector<double> frame;
  std::vector<double> alone;
  for (std::size_t i = 0; i < options.at("rounds").get<std::size_t>(); ++i) {
    flow.step();
    frame.push_back(flow.times().move + flow.times().narrow);
    alone.push_back(phases.run().total());
  }
  measured.results.add("flow_frames", {{"how", "frame"}, {"ms", to_value(frame)}});
  measured.results.add("flow_frames", {{"how", "phases"}, {"ms", to_value(alone)}});
}

/// A long granular flow: allocations, energy, and contacts against brute force.
void measure_flow_soak(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare(
      {"flow_soak", "pipeline", "a long flow", {"what"}, {{"value", "value", "", Better::less}}});
  CountingResource memory;
  FlowOptions flow_with = flow_options(options, Execution::parallel());
  flow_with.memory = &memory;
  GranularFlow flow(flow_with);
  flow.keep_contact_poses();
  FlowHistory history;
  FlowFaults faults;
  SteadyAllocations steady;
  std::size_t warm = 0;
  const std::size_t steps = options.at("steps");
  for (std::size_t i = 0; i < steps; ++i) {
    if (i == options.at("warm_up").get<std::size_t>()) warm = steady.count();
    flow.step();
    history.add(flow);
    steady.note(flow, memory.allocations());
    if (i % options.at("check").get<std::size_t>() == 0) faults += check_contacts(flow);
  }
  const std::pair<const char*, double> found[] = {
      {"allocations", static_cast<double>(steady.count() - warm)},
      {"energy", history.greatest_rise()},
      {"faults", static_cast<double>(faults.total())}};
  for (const auto& [what, value] : found) {
    measured.results.add("flow_soak", {{"what", what}, {"value", value}});
  }
}

}  // namespace winnow::bench
