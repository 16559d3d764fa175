#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_narrow.h"
#include "tool/narrow_options.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <cmath>
#include <iostream>

namespace winnow::bench {
namespace {

struct Narrow {
  Choice choice;
  NarrowChoice narrow{.tiers = {"fast", "robust"}};
  std::vector<std::size_t> pairs{8192, 100'000};
  std::vector<int> threads{1};
  std::size_t rounds = 7;
  bool peers = true;
  std::string json;

  int run();

 private:
  [[nodiscard]] NarrowMeasureOptions options_for(const PairKind& kind, std::size_t count) const;
};

std::vector<std::string> row_of(const NarrowMeasurement& measured, const NarrowTiming& timing) {
  const NarrowTiming* peer = measured.best_peer(timing.level);
  const double ns = timing.median_ns();
  const bool compared = peer != nullptr && !measured.is_peer(timing);
  return {std::string(measured.kind.name),
          grouped(measured.pairs),
          std::string(to_text(timing.level)),
          timing.engine,
          std::to_string(timing.threads),
          short_number(ns),
          compared ? short_number(peer->median_ns() / ns) + "x" : "-",
          percent(timing.recomputed),
          std::to_string(timing.disagree),
          timing.level == ContactLevel::boolean ? "-" : percent(timing.other_depth),
          timing.level == ContactLevel::manifold ? short_number(timing.contacts) : "-"};
}

Json to_json(const NarrowMeasurement& measured, const NarrowTiming& timing) {
  Json row = {{"kind", measured.kind.name},      {"pairs", measured.pairs},
              {"level", to_text(timing.level)},  {"engine", timing.engine},
              {"threads", timing.threads},       {"isa", isa_name()},
              {"median_ns", timing.median_ns()}, {"ns", timing.ns},
              {"pairs_a_turn", timing.pairs},    {"disagree", timing.disagree},
              {"compared", timing.compared},     {"other_depth", timing.other_depth},
              {"contacts", timing.contacts}};
  if (!std::isnan(timing.recomputed)) row["recomputed"] = timing.recomputed;
  return row;
}

NarrowMeasureOptions Narrow::options_for(const PairKind& kind, std::size_t count) const {
  return {.kind = kind,
          .pairs = count,
          .levels = narrow.chosen_levels(),
          .tiers = narrow.chosen_tiers(),
          .threads = threads,
          .peers = peers,
          .seed = choice.seed,
          .race = {.rounds = rounds}};
}

int Narrow::run() {
  choose_isa(choice.isa);
  const std::vector<PairKind> kinds = narrow.chosen_kinds();
  Table table({"pair", "pairs", "level", "by", "threads", "ns/pair", "best peer / this",
               "recomputed", "disagree", "other depth", "contacts"});
  for (const std::size_t column : {2, 3}) table.flush_left(column);
  Json rows = Json::array();
  {
    Progress progress(kinds.size() * pairs.size());
    for (const std::size_t count : pairs) {
      for (const PairKind& kind : kinds) {
        progress.step(std::string(kind.name) + ", " + grouped(count) + " pairs");
        const NarrowMeasurement measured = measure_narrow(options_for(kind, count));
        for (const NarrowTiming& timing : measured.timings) {
          table.add(row_of(measured, timing));
          rows.push_back(to_json(measured, timing));
        }
      }
    }
  }
  std::cout
      << isa_name() << ", medians of " << rounds
      << " rounds; every second pair overlaps; recomputed: pairs that left the lanes; "
         "disagree: verdicts of the first 8,192 that are not those of the first row; other depth: "
         "of the overlapping ones, those more than 1 % of the sizes off the first row\n"
      << table;
  write_json(json, rows);
  return kDone;
}

}  // namespace

Command add_narrow(CLI::App& app) {
  auto narrow = std::make_shared<Narrow>();
  CLI::App* sub = app.add_subcommand(
      "narrow",
      "Nanoseconds a pair of shapes: winnow's tiers and other libraries in turns on the same "
      "random pairs. Other libraries start cold, without what they may remember of a pair.");
  add_kind_option(*sub, narrow->narrow);
  add_level_option(*sub, narrow->narrow);
  add_tier_option(*sub, narrow->narrow);
  sub->add_option("--pairs", narrow->pairs,
                  "Numbers of pairs; those of more than 16,384 lie scattered in memory")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}))
      ->capture_default_str();
  sub->add_option("--threads", narrow->threads, "Numbers of threads that winnow takes")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  sub->add_option("--rounds", narrow->rounds, "Rounds in which all take turns")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  sub->add_flag("!--no-peers", narrow->peers, "Without other libraries");
  add_isa_option(*sub, narrow->choice);
  add_seed_option(*sub, narrow->choice);
  add_json_option(*sub, narrow->json);
  return {sub, [narrow] { return narrow->run(); }};
}

}  // namespace winnow::bench
