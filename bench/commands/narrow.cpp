#include "bench/commands/arguments.h"
#include "bench/commands/narrow_options.h"
#include "bench/commands/rows_run.h"
#include "bench/common/table.h"
#include "bench/rows/accuracy_rows.h"

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
};

int Narrow::run() {
  choose_isa(choice.isa);
  const std::vector<PairKind> kinds = narrow.chosen_kinds();
  RowsRun run(kinds.size() * pairs.size());
  declare_pair_times(run.results(), PairKeys::settings);
  for (const std::size_t count : pairs) {
    for (const PairKind& kind : kinds) {
      run.step(std::string(kind.name) + ", " + grouped(count) + " pairs", [&](Results& results) {
        add_pair_times(results,
                       {.kind = kind,
                        .pairs = count,
                        .levels = narrow.chosen_levels(),
                        .tiers = narrow.chosen_tiers(),
                        .threads = threads,
                        .peers = peers,
                        .seed = choice.seed,
                        .race = {.rounds = rounds}},
                       PairKeys::settings);
      });
    }
  }
  run.print("narrow_speed");
  run.print("narrow_best");
  return run.end(json);
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
