#include "bench/commands/arguments.h"
#include "bench/commands/narrow_options.h"
#include "bench/commands/rows_run.h"
#include "bench/rows/accuracy_rows.h"

namespace winnow::bench {
namespace {

struct AccuracyCommand {
  Choice choice;
  NarrowChoice narrow{.levels = {"distance"}, .tiers = {"all"}};
  std::vector<double> ratios{1.0, 1e2, 1e4};
  PairSetOptions set{.pairs = 400, .nearest = kNearestPairs};
  bool by_gap = false;
  std::string judge = "oracle";
  bool peers = true;
  std::string json;

  int run();
};

int AccuracyCommand::run() {
  choose_isa(choice.isa);
  const std::vector<PairKind> kinds = narrow.chosen_kinds();
  RowsRun run(kinds.size() * ratios.size());
  declare_pair_errors(run.results(), PairKeys::settings);
  for (const PairKind& kind : kinds) {
    for (const double ratio : ratios) {
      AccuracyOptions asked{.kind = kind,
                            .set = set,
                            .levels = narrow.chosen_levels(),
                            .tiers = narrow.chosen_tiers(),
                            .peers = peers};
      asked.set.seed = choice.seed;
      asked.set.ratio = ratio;
      if (judge == "reference") asked.judge = TruthSource::reference;
      run.step(std::string(kind.name) + ", sizes 1:" + key_text(ratio), [&](Results& results) {
        add_pair_errors(results, asked, by_gap, PairKeys::settings);
      });
    }
  }
  run.print("narrow_error",
            {"ns", "pairs", "wrong", "missing", "median_distance", "worst_distance", "median_depth",
             "worst_depth", "worst_degrees", "normals_off", "beyond_bound", "recomputed", "judge"});
  return run.end(json);
}

void add_set_options(CLI::App& sub, AccuracyCommand& accuracy) {
  PairSetOptions& set = accuracy.set;
  sub.add_option("--ratio", accuracy.ratios, "Size of the second shape over that of the first")
      ->delimiter(',')
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub.add_option("--pairs", set.pairs, "Pairs of each kind and ratio")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}))
      ->capture_default_str();
  sub.add_option("--offset", set.offset,
                 "Moves all pairs so far along each axis, at positions that are multiples of 2^-12")
      ->check(CLI::Range(0.0, 1e12));
  sub.add_option("--angle", set.angle,
                 "The second body stands as the first, turned by so many radians")
      ->check(CLI::NonNegativeNumber);
  sub.add_option("--thinness", set.thinness, "Triangles keep so much of their height")
      ->check(CLI::Range(0.0, 1.0));
  sub.add_flag("--by-gap", accuracy.by_gap,
               "Also the errors of the pairs of each power of ten of |distance| over size");
}

}  // namespace

Command add_accuracy(CLI::App& app) {
  auto accuracy = std::make_shared<AccuracyCommand>();
  CLI::App* sub = app.add_subcommand(
      "accuracy",
      "Errors of answers about pairs of shapes against the time they take, by kind, tier and size "
      "ratio, other libraries beside. Every second pair overlaps, and half of the pairs are nearly "
      "touching.");
  add_kind_option(*sub, accuracy->narrow);
  add_level_option(*sub, accuracy->narrow);
  add_tier_option(*sub, accuracy->narrow);
  add_set_options(*sub, *accuracy);
  sub->add_option("--judge", accuracy->judge,
                  "Who knows the truth: 100 digits, or for many pairs winnow's slowest tier")
      ->check(CLI::IsMember(std::vector<std::string>{"oracle", "reference"}))
      ->capture_default_str();
  sub->add_flag("!--no-peers", accuracy->peers, "Without other libraries");
  add_isa_option(*sub, accuracy->choice);
  add_seed_option(*sub, accuracy->choice);
  add_json_option(*sub, accuracy->json);
  return {sub, [accuracy] { return accuracy->run(); }};
}

}  // namespace winnow::bench
