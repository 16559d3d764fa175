#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_accuracy.h"
#include "tool/narrow_options.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <winnow/simd/isa.h>

#include <cmath>
#include <cstdio>
#include <iostream>

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

 private:
  [[nodiscard]] AccuracyOptions options_for(const PairKind& kind, double ratio) const;
};

/// 1.2e-16, or 0.
std::string tiny_number(double value) {
  if (value == 0.0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

std::string plain_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string spread_cell(const ErrorSpread& spread) {
  if (spread.count == 0) return "-";
  return tiny_number(spread.median) + " " + tiny_number(spread.p99) + " " +
         tiny_number(spread.worst);
}

/// `gap` 0: pairs of all gaps.
std::vector<std::string> row_of(const AccuracyOptions& asked, double gap, const Accuracy& one) {
  return {std::string(asked.kind.name),
          plain_number(asked.set.ratio),
          gap == 0.0 ? "all" : plain_number(gap),
          std::string(to_text(one.level)),
          one.engine,
          one.ns.empty() ? "-" : short_number(one.median_ns()),
          grouped(one.pairs),
          std::to_string(one.wrong),
          spread_cell(one.apart),
          spread_cell(one.depth),
          spread_cell(one.degrees),
          std::to_string(one.normals_off),
          std::to_string(one.beyond_bound),
          std::to_string(one.missing),
          percent(one.recomputed)};
}

Json to_json(const AccuracyOptions& asked, double gap, const Accuracy& one) {
  Json row = {{"kind", asked.kind.name}, {"ratio", asked.set.ratio}};
  if (asked.set.offset) row["offset"] = *asked.set.offset;
  if (asked.set.angle) row["angle"] = *asked.set.angle;
  if (asked.set.thinness < 1.0) row["thinness"] = asked.set.thinness;
  if (gap > 0.0) row["gap"] = gap;
  row.update({{"level", to_text(one.level)},
              {"engine", one.engine},
              {"judge", judge_name(asked.judge)},
              {"isa", isa_name()}});
  if (!one.ns.empty()) row["ns"] = one.median_ns();
  row.update(to_json(one));
  return row;
}

AccuracyOptions AccuracyCommand::options_for(const PairKind& kind, double ratio) const {
  AccuracyOptions options{.kind = kind,
                          .set = set,
                          .levels = narrow.chosen_levels(),
                          .tiers = narrow.chosen_tiers(),
                          .peers = peers};
  options.set.seed = choice.seed;
  options.set.ratio = ratio;
  if (judge == "reference") options.judge = TruthSource::reference;
  return options;
}

int AccuracyCommand::run() {
  choose_isa(choice.isa);
  const std::vector<PairKind> kinds = narrow.chosen_kinds();
  Table table({"pair", "ratio", "gap", "level", "by", "ns/pair", "pairs", "wrong",
               "distance: median p99 worst", "depth: median p99 worst", "degrees: median p99 worst",
               "normals off", "beyond bound", "missing", "recomputed"});
  for (const std::size_t column : {3, 4}) table.flush_left(column);
  Json rows = Json::array();
  const auto add = [&](const AccuracyOptions& asked, double gap, const Accuracy& one) {
    table.add(row_of(asked, gap, one));
    rows.push_back(to_json(asked, gap, one));
  };
  {
    Progress progress(kinds.size() * ratios.size());
    for (const PairKind& kind : kinds) {
      for (const double ratio : ratios) {
        progress.step(std::string(kind.name) + ", sizes 1:" + plain_number(ratio));
        const AccuracyOptions asked = options_for(kind, ratio);
        const AccuracyMeasurement measured = measure_accuracy(asked);
        for (const Accuracy& one : measured.engines) add(asked, 0.0, one);
        if (!by_gap) continue;
        for (const AccuracyAtGap& one : measured.by_gap) add(asked, one.gap, one.accuracy);
      }
    }
  }
  std::cout << isa_name() << "; judged by "
            << (judge == "oracle" && has_oracle() ? "arithmetic of 100 digits"
                                                  : "the tier reference")
            << "; errors are relative to sizes + |distance|; normals are off by more than 0.01 "
               "degrees; missing: without a finite distance or a normal\n"
            << table;
  write_json(json, rows);
  return kDone;
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
