// Rows about pairs of shapes: the time and the error of the narrow phase for each kind of pair,
// level and engine. bench/commands, bench/goals and bench/report call these functions;
// bench/measure takes the times.

#include "bench/rows/accuracy_rows.h"

#include <winnow/simd/isa.h>
#include "bench/rows/machine.h"
#include "bench/rows/named_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

namespace winnow::bench {
namespace {

void add_spread(Json& row, const std::string& of, const ErrorSpread& spread) {
  if (spread.count == 0) return;
  row["worst_" + of] = spread.worst;
  if (spread.count >= 100) row["p99_" + of] = spread.p99;
  row["median_" + of] = spread.median;
}

Json figures_of(const Accuracy& one) {
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

void add_shown(Json& row, const std::string& of) {
  const auto at = row.find("worst_" + of);
  if (at == row.end()) return;
  row["worst_" + of + "_or_floor"] = std::max(at->get<double>(), kMinErrorShown);
}

std::string accuracy_command(const AccuracyOptions& options) {
  const PairSetOptions& set = options.set;
  std::string text = "bench/run accuracy --kind " + std::string(options.kind.name) + " --ratio " +
                     key_text(set.ratio);
  if (set.offset) text += " --offset " + key_text(*set.offset);
  if (set.angle) text += " --angle " + key_text(*set.angle);
  if (set.thinness < 1.0) text += " --thinness " + key_text(set.thinness);
  for (std::size_t i = 0; i < options.levels.size(); ++i) {
    text += (i == 0 ? " --level " : ",") + std::string(to_text(options.levels[i]));
  }
  text += " --pairs " + std::to_string(set.pairs) + " --isa " + isa_name();
  if (set.seed != 1) text += " --seed " + std::to_string(set.seed);
  if (options.judge == TruthSource::reference) text += " --judge reference";
  return text;
}

void add_accuracy_row(Results& results, const std::string& table, Json row,
                      const Accuracy& accuracy, const AccuracyOptions& options) {
  Json figures = figures_of(accuracy);
  for (const char* of : {"error", "distance", "depth", "degrees"}) add_shown(figures, of);
  figures["judge"] = judge_name(options.judge);
  for (const auto& [name, value] : figures.items()) {
    row[name] = value;
  }
  if (!row.contains("command")) row["command"] = accuracy_command(options);
  if (is_peer(accuracy.engine)) row["command"] = with_peers(row["command"]);
  results.add(table, std::move(row));
}

std::string narrow_command(const NarrowMeasurement& measured, const NarrowMeasureOptions& options) {
  return "bench/run narrow --kind " + std::string(measured.kind.name) + " --tier all --pairs " +
         std::to_string(measured.pairs) + " --rounds " + std::to_string(options.race.rounds) +
         " --isa " + isa_name() +
         (options.seed == 1 ? "" : " --seed " + std::to_string(options.seed));
}

/// Returns the fastest of the other libraries whose answers are right; null if there is none.
const NarrowTiming* best_peer(const NarrowMeasurement& measured, ContactLevel level) {
  const NarrowTiming* best = nullptr;
  for (const NarrowTiming& timing : measured.timings) {
    if (timing.level != level || !is_peer(timing.engine) || !measured.is_right(timing)) continue;
    if (best == nullptr || timing.median_ns() < best->median_ns()) best = &timing;
  }
  return best;
}

/// Adds the row of one engine.
void add_timing(Results& results, const NarrowMeasurement& measured, const NarrowTiming& timing,
                const std::string& command, PairKeys keys) {
  const bool manifold = timing.level == ContactLevel::manifold;
  Json row{{"kind", measured.kind.name},
           {"level", to_text(timing.level)},
           {"engine", timing.engine},
           {"ns", to_value(timing.ns)},
           {"right", measured.is_right(timing) ? "yes" : "no"},
           {"pairs", measured.pairs},
           {"compared", timing.compared},
           {"disagree", timing.disagree},
           {"recomputed", timing.recomputed},
           {"command", is_peer(timing.engine) ? with_peers(command) : command}};
  if (timing.level != ContactLevel::boolean) row["other_depth"] = timing.other_depth;
  if (manifold) row["contacts"] = timing.contacts;
  if (keys == PairKeys::settings) row["threads"] = timing.threads;
  results.add("narrow_speed", std::move(row));
}

}  // namespace

NarrowMeasurement add_pair_times(Results& results, const NarrowMeasureOptions& options,
                                 PairKeys keys) {
  NarrowMeasurement measured = measure_narrow(options);
  const std::string command = narrow_command(measured, options);
  for (const NarrowTiming& timing : measured.timings) {
    add_timing(results, measured, timing, command, keys);
  }
  for (const ContactLevel level : options.levels) {
    const NarrowTiming* peer = best_peer(measured, level);
    const NarrowTiming* own = measured.find(NarrowTier::robust, level);
    if (peer == nullptr || own == nullptr) continue;
    Json row{{"kind", options.kind.name},
             {"level", to_text(level)},
             {"best_peer", peer->engine},
             {"speedup", peer->median_ns() / own->median_ns()},
             {"command", with_peers(command)}};
    if (keys == PairKeys::settings) row["pairs"] = measured.pairs;
    results.add("narrow_best", std::move(row));
  }
  return measured;
}

void add_pair_errors(Results& results, const AccuracyOptions& options, bool by_gap, PairKeys keys) {
  const AccuracyMeasurement measured = measure_accuracy(options);
  const auto row_of = [&](const Accuracy& one, const Json& gap) {
    Json row{{"kind", options.kind.name}, {"level", to_text(one.level)}, {"engine", one.engine}};
    if (keys == PairKeys::settings) row.update({{"ratio", options.set.ratio}, {"gap", gap}});
    return row;
  };
  for (const Accuracy& one : measured.engines) {
    Json row = row_of(one, nullptr);
    row["ns"] = to_value(one.ns);
    add_accuracy_row(results, "narrow_error", std::move(row), one, options);
  }
  for (const AccuracyAtGap& one : measured.by_gap) {
    if (!by_gap) break;
    if (keys == PairKeys::settings) {
      add_accuracy_row(results, "narrow_error", row_of(one.accuracy, one.gap), one.accuracy,
                       options);
    } else if (one.accuracy.level == ContactLevel::distance) {
      add_accuracy_row(results, "narrow_gap",
                       {{"kind", options.kind.name},
                        {"engine", one.accuracy.engine},
                        {"gap", one.gap},
                        {"command", accuracy_command(options) + " --by-gap"}},
                       one.accuracy, options);
    }
  }
}

void add_error_curve(Results& results, const std::string& table, const Json& keys,
                     const AccuracyOptions& options) {
  for (const Accuracy& one : measure_accuracy(options).engines) {
    Json row = keys;
    row["engine"] = one.engine;
    add_accuracy_row(results, table, std::move(row), one, options);
  }
}

}  // namespace winnow::bench
