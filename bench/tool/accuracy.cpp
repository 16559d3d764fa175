#include "narrow/accuracy.h"
#include "narrow/winnow_narrow.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_narrow.h"
#include "tool/narrow_options.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <cmath>
#include <cstdio>
#include <iostream>

namespace winnow::bench {
namespace {

/// The nearest to touching that pairs are brought, in radii of the smaller body.
constexpr double kNearest = 1e-6;

struct AccuracyCommand {
  Choice choice;
  NarrowChoice narrow{.levels = {"distance"}, .tiers = {"all"}};
  std::vector<double> ratios{1.0, 1e2, 1e4};
  std::size_t pairs = 400;
  std::string judge = "oracle";
  bool peers = true;
  std::string json;

  int run();

 private:
  [[nodiscard]] std::vector<Accuracy> measure(const PairKind& kind, double ratio) const;
};

/// 1.2e-16, or 0.
std::string tiny_number(double value) {
  if (value == 0.0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

std::string ratio_text(double ratio) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", ratio);
  return text;
}

std::vector<std::string> row_of(const PairKind& kind, double ratio, const Accuracy& one) {
  const bool measured = one.measured > 0;
  return {std::string(kind.name),
          ratio_text(ratio),
          std::string(to_text(one.level)),
          one.engine,
          short_number(one.ns),
          grouped(one.pairs),
          std::to_string(one.wrong),
          measured ? tiny_number(one.p99_error) : "-",
          measured ? tiny_number(one.worst_error) : "-",
          std::to_string(one.beyond_bound),
          one.normals > 0 ? std::to_string(one.normals_off) : "-",
          one.normals > 0 ? tiny_number(one.worst_degrees) : "-",
          std::to_string(one.missing),
          std::isnan(one.recomputed) ? "-" : short_number(100.0 * one.recomputed) + " %"};
}

Json to_json(const PairKind& kind, double ratio, const Accuracy& one) {
  Json row = {{"kind", kind.name},
              {"ratio", ratio},
              {"level", to_text(one.level)},
              {"engine", one.engine},
              {"ns", one.ns},
              {"pairs", one.pairs},
              {"wrong", one.wrong},
              {"measured", one.measured},
              {"p99_error", one.p99_error},
              {"worst_error", one.worst_error},
              {"beyond_bound", one.beyond_bound},
              {"normals", one.normals},
              {"normals_off", one.normals_off},
              {"worst_degrees", one.worst_degrees},
              {"missing", one.missing}};
  if (!std::isnan(one.recomputed)) row["recomputed"] = one.recomputed;
  return row;
}

std::vector<Accuracy> AccuracyCommand::measure(const PairKind& kind, double ratio) const {
  const auto set = make_pair_set(
      kind, {.pairs = pairs, .seed = choice.seed, .ratio = ratio, .nearest = kNearest});
  const auto truths =
      truths_of(*set, judge == "oracle" ? TruthSource::oracle : TruthSource::reference);
  std::vector<std::unique_ptr<NarrowEngine>> engines;
  for (const NarrowTier tier : narrow.chosen_tiers()) {
    engines.push_back(std::make_unique<WinnowNarrow>(tier, 1));
  }
  if (peers) {
    for (auto& peer : narrow_peers()) engines.push_back(std::move(peer));
  }
  std::vector<Accuracy> rows;
  for (const auto& engine : engines) engine->start(*set);
  for (const NarrowLevel level : narrow.chosen_levels()) {
    for (const auto& engine : engines) {
      if (engine->takes(kind, level)) rows.push_back(judge_engine(*engine, level, *set, truths));
    }
  }
  return rows;
}

int AccuracyCommand::run() {
  choose_isa(choice.isa);
  const std::vector<PairKind> kinds = narrow.chosen_kinds();
  Table table({"pair", "ratio", "level", "by", "ns/pair", "pairs", "wrong", "p99 error",
               "worst error", "beyond bound", "normals off", "worst degrees", "missing",
               "recomputed"});
  for (const std::size_t column : {2, 3}) table.flush_left(column);
  Json rows = Json::array();
  {
    Progress progress(kinds.size() * ratios.size());
    for (const PairKind& kind : kinds) {
      for (const double ratio : ratios) {
        progress.step(std::string(kind.name) + ", sizes 1:" + ratio_text(ratio));
        for (const Accuracy& one : measure(kind, ratio)) {
          table.add(row_of(kind, ratio, one));
          rows.push_back(to_json(kind, ratio, one));
        }
      }
    }
  }
  std::cout << isa_name() << "; judged by "
            << (judge == "oracle" && has_oracle() ? "arithmetic of 100 digits"
                                                  : "the tier reference")
            << "; errors are relative to sizes + |distance|; normals are off by more than 0.01 "
               "degrees; missing: without a finite distance\n"
            << table;
  write_json(json, rows);
  return kDone;
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
  sub->add_option("--ratio", accuracy->ratios, "Size of the second shape over that of the first")
      ->delimiter(',')
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  sub->add_option("--pairs", accuracy->pairs, "Pairs of each kind and ratio")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000'000}))
      ->capture_default_str();
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
