#include "tool/measure_accuracy.h"

#include "narrow/winnow_narrow.h"
#include "tool/measure_narrow.h"

#include <winnow/simd/isa.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>

namespace winnow::bench {
namespace {

/// Shortest of the usual forms: 400, 0.001, 1e-06.
std::string accuracy_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void add_spread(Json& row, const std::string& of, const ErrorSpread& spread) {
  if (spread.count == 0) return;
  row["worst_" + of] = spread.worst;
  if (spread.count >= 100) row["p99_" + of] = spread.p99;
  row["median_" + of] = spread.median;
}

/// Of an engine that gave up.
Accuracy no_answers(const NarrowEngine& engine, ContactLevel level, std::size_t pairs) {
  Accuracy accuracy;
  accuracy.engine = engine.name();
  accuracy.level = level;
  accuracy.pairs = pairs;
  accuracy.missing = pairs;
  return accuracy;
}

std::vector<AccuracyAtGap> split_by_gap(const Accuracy& whole,
                                        const std::vector<PairError>& errors) {
  std::map<int, std::vector<PairError>> by_power;
  for (const PairError& one : errors) {
    if (one.gap > 0.0) by_power[static_cast<int>(std::floor(std::log10(one.gap)))].push_back(one);
  }
  std::vector<AccuracyAtGap> split;
  for (const auto& [power, some] : by_power) {
    Accuracy accuracy = summary_of(some);
    accuracy.engine = whole.engine;
    accuracy.level = whole.level;
    split.push_back({std::pow(10.0, power), std::move(accuracy)});
  }
  return split;
}

}  // namespace

AccuracyMeasurement measure_accuracy(const AccuracyOptions& options) {
  const auto set = make_pair_set(options.kind, options.set);
  const auto truths = truths_of(*set, options.judge);
  std::vector<std::unique_ptr<NarrowEngine>> engines;
  for (const NarrowTier tier : options.tiers) {
    engines.push_back(std::make_unique<WinnowNarrow>(tier, 1));
  }
  if (options.peers) {
    for (auto& peer : narrow_peers()) engines.push_back(std::move(peer));
  }
  AccuracyMeasurement measured;
  for (const auto& engine : engines) engine->start(*set);
  for (const ContactLevel level : options.levels) {
    for (const auto& engine : engines) {
      if (!engine->takes(options.kind, level)) continue;
      try {
        measured.engines.push_back(judge_engine(*engine, level, *set, truths, options.runs));
      } catch (const std::exception&) {
        measured.engines.push_back(no_answers(*engine, level, set->pairs.size()));
        continue;
      }
      const auto errors = errors_of(*engine, level, *set, truths);
      for (AccuracyAtGap& one : split_by_gap(measured.engines.back(), errors)) {
        measured.by_gap.push_back(std::move(one));
      }
    }
  }
  return measured;
}

std::string judge_name(TruthSource judge) {
  return judge == TruthSource::oracle && has_oracle() ? "100 digits" : "reference";
}

std::string accuracy_command(const AccuracyOptions& options) {
  const PairSetOptions& set = options.set;
  std::string text = "bench/run accuracy --kind " + std::string(options.kind.name) + " --ratio " +
                     accuracy_number(set.ratio);
  if (set.offset) text += " --offset " + accuracy_number(*set.offset);
  if (set.angle) text += " --angle " + accuracy_number(*set.angle);
  if (set.thinness < 1.0) text += " --thinness " + accuracy_number(set.thinness);
  for (std::size_t i = 0; i < options.levels.size(); ++i) {
    text += (i == 0 ? " --level " : ",") + std::string(to_text(options.levels[i]));
  }
  text += " --pairs " + std::to_string(set.pairs) + " --isa " + isa_name();
  if (set.seed != 1) text += " --seed " + std::to_string(set.seed);
  if (options.judge == TruthSource::reference) text += " --judge reference";
  return text;
}

Json to_json(const Accuracy& one) {
  Json row{{"pairs", one.pairs}, {"wrong", one.wrong}, {"missing", one.missing}};
  add_spread(row, "error", one.all);
  add_spread(row, "distance", one.apart);
  add_spread(row, "depth", one.depth);
  add_spread(row, "degrees", one.degrees);
  row["measured"] = one.all.count;
  row["beyond_bound"] = one.beyond_bound;
  row["normals"] = one.degrees.count;
  row["normals_off"] = one.normals_off;
  if (!std::isnan(one.recomputed)) row["recomputed"] = one.recomputed;
  return row;
}

}  // namespace winnow::bench
