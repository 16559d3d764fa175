#include "report/section.h"
#include "report/sections/accuracy_rows.h"
#include "report/sections/narrow_show.h"
#include "tool/measure_narrow.h"
#include "tool/table.h"

#include <winnow/simd/isa.h>

#include <array>
#include <map>

namespace winnow::bench {
namespace {

constexpr std::size_t kNarrowRacePairs = 8192;
constexpr std::array<double, 5> kNarrowRatios{1.0, 1e2, 1e4, 1e6, 1e8};
constexpr std::array<double, 4> kNarrowOffsets{1.0, 1e3, 1e6, 1e9};

/// Kinds of which curves are drawn: something round, something flat, something large.
bool has_curves(const PairKind& kind) {
  return kind.name == "sphere-box" || kind.name == "box-box" || kind.name == "hull16-hull16";
}

/// False where the library was built without qhull.
bool narrow_has_hulls() {
  ShapePool pool;
  ShapeId id;
  const Eigen::Vector3d point = Eigen::Vector3d::Zero();
  return pool.add_hull(std::span(&point, 1), 0.0, id) == Status::ok;
}

std::vector<PairKind> narrow_kinds(bool quick) {
  const bool hulls = narrow_has_hulls();
  std::vector<PairKind> kinds;
  for (const PairKind& kind : pair_kinds()) {
    const bool is_quick = kind.name == "sphere-box" || kind.name == "box-box";
    if ((is_quick || !quick) && (hulls || kind.hull_vertices == 0)) kinds.push_back(kind);
  }
  return kinds;
}

void declare_narrow(Results& results) {
  results.declare({"narrow_speed",
                   "narrow",
                   "random pairs of shapes, every second one overlaps; one thread",
                   {"kind", "level", "engine"},
                   {{"ns", "a pair", "ns", Better::less},
                    {"right", "right by and large", "", Better::neither, Format::text},
                    {"pairs", "pairs", "", Better::neither, Format::count},
                    {"compared", "compared with robust", "", Better::neither, Format::count},
                    {"disagree", "other verdicts", "", Better::less, Format::count},
                    {"other_depth", "other depths", "", Better::less, Format::percent},
                    {"contacts", "contacts an overlapping pair", "", Better::more},
                    {"recomputed", "recomputed", "", Better::neither, Format::percent}}});
  results.declare({"narrow_best",
                   "narrow",
                   "the tier robust against the fastest other library that is right",
                   {"kind", "level"},
                   {{"best_peer", "fastest that is right", "", Better::neither, Format::text},
                    {"speedup", "its time over that of robust", "times", Better::more}}});
  std::vector<ValueColumn> columns = accuracy_columns();
  columns.insert(columns.begin(), {"ns", "a pair", "ns", Better::less});
  results.declare({"narrow_error",
                   "narrow",
                   "errors of pairs, half of which are nearly touching, sizes 1:1",
                   {"kind", "level", "engine"},
                   columns});
  const std::string of = "errors of such pairs by ";
  results.declare({"narrow_gap",
                   "narrow",
                   of + "|distance| over their size",
                   {"kind", "engine", "gap"},
                   accuracy_curve_columns()});
  results.declare({"narrow_ratio",
                   "narrow",
                   of + "the size of the second shape over that of the first",
                   {"kind", "engine", "ratio"},
                   accuracy_curve_columns()});
  results.declare({"narrow_offset",
                   "narrow",
                   of + "the offset from the origin along each axis",
                   {"kind", "engine", "offset"},
                   accuracy_curve_columns()});
}

std::string narrow_command(const NarrowMeasurement& measured, std::size_t rounds,
                           std::uint64_t seed) {
  return "bench/run narrow --kind " + std::string(measured.kind.name) + " --tier all --pairs " +
         std::to_string(measured.pairs) + " --rounds " + std::to_string(rounds) + " --isa " +
         isa_name() + (seed == 1 ? "" : " --seed " + std::to_string(seed));
}

/// Adds the row of one engine; its id.
std::string add_timing(Results& results, const NarrowMeasurement& measured,
                       const NarrowTiming& timing, const std::string& command) {
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
           {"command", measured.is_peer(timing) ? with_peers(command) : command}};
  if (timing.level != ContactLevel::boolean) row["other_depth"] = timing.other_depth;
  if (manifold) row["contacts"] = timing.contacts;
  return results.add("narrow_speed", std::move(row));
}

void measure_narrow_times(Results& results, const ReportOptions& options, const PairKind& kind) {
  NarrowMeasureOptions asked{.kind = kind,
                             .pairs = options.quick ? 512 : kNarrowRacePairs,
                             .tiers = {NarrowTier::robust, NarrowTier::fast, NarrowTier::reference},
                             .peers = options.peers,
                             .seed = options.seed};
  asked.race.rounds = options.quick ? 3 : 5;
  if (options.quick) asked.race.turn_ms = 0.5;
  if (options.quick) asked.race.smallest_part = 128;
  const NarrowMeasurement measured = measure_narrow(asked);
  const std::string command = narrow_command(measured, asked.race.rounds, asked.seed);
  std::map<const NarrowTiming*, std::string> ids;
  for (const NarrowTiming& timing : measured.timings) {
    ids[&timing] = add_timing(results, measured, timing, command);
  }
  for (const ContactLevel level : asked.levels) {
    const NarrowTiming* best = measured.best_peer(level);
    if (best == nullptr) continue;
    const NarrowTiming* own = measured.find(NarrowTier::robust, level);
    results.add("narrow_best",
                {{"kind", kind.name},
                 {"level", to_text(level)},
                 {"best_peer", best->engine},
                 {"speedup", best->median_ns() / own->median_ns()},
                 {"command", with_peers(command)},
                 {"from", derived("speedup", "ratio", "ns", {ids[best], ids[own]})}});
  }
}

/// The oracle takes milliseconds a pair of hulls.
std::size_t judged_pairs(const PairKind& kind, bool quick) {
  if (kind.hull_vertices > 16) return quick ? 4 : 60;
  if (kind.hull_vertices > 0) return quick ? 10 : 500;
  return quick ? 60 : 2000;
}

AccuracyOptions narrow_accuracy_of(const ReportOptions& options, const PairKind& kind) {
  AccuracyOptions asked{.kind = kind, .peers = options.peers, .runs = 5};
  asked.set.pairs = judged_pairs(kind, options.quick);
  asked.set.seed = options.seed;
  return asked;
}

void measure_narrow_errors(Results& results, const ReportOptions& options, const PairKind& kind,
                           bool by_gap) {
  AccuracyOptions asked = narrow_accuracy_of(options, kind);
  asked.levels = {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold};
  const AccuracyMeasurement measured = measure_accuracy(asked);
  for (const Accuracy& one : measured.engines) {
    add_accuracy_row(results, "narrow_error",
                     {{"kind", kind.name},
                      {"level", to_text(one.level)},
                      {"engine", one.engine},
                      {"ns", to_value(one.ns)}},
                     one, asked);
  }
  if (!by_gap) return;
  for (const AccuracyAtGap& one : measured.by_gap) {
    if (one.accuracy.level != ContactLevel::distance) continue;
    add_accuracy_row(results, "narrow_gap",
                     {{"kind", kind.name},
                      {"engine", one.accuracy.engine},
                      {"gap", one.gap},
                      {"command", accuracy_command(asked) + " --by-gap"}},
                     one.accuracy, asked);
  }
}

void measure_narrow_curve(Results& results, const ReportOptions& options, const PairKind& kind,
                          const std::string& parameter, double value) {
  AccuracyOptions asked = narrow_accuracy_of(options, kind);
  asked.set.pairs = options.quick ? asked.set.pairs / 2 : kind.hull_vertices > 0 ? 100 : 400;
  if (parameter == "ratio") {
    asked.set.ratio = value;
  } else {
    asked.set.offset = value;
  }
  asked.runs = 1;
  for (const Accuracy& one : measure_accuracy(asked).engines) {
    add_accuracy_row(results, "narrow_" + parameter,
                     {{"kind", kind.name}, {"engine", one.engine}, {parameter, value}}, one, asked);
  }
}

void add_curve_steps(std::vector<ReportStep>& steps, const ReportOptions& options,
                     const PairKind& kind) {
  const auto add = [&](const std::string& parameter, double value) {
    steps.push_back({std::string(kind.name) + ", " + parameter + " " + power_text(value),
                     options.quick ? 0.02 : 0.3, [=](Results& results) {
                       measure_narrow_curve(results, options, kind, parameter, value);
                     }});
  };
  for (const double ratio : kNarrowRatios) add("ratio", ratio);
  for (const double offset : kNarrowOffsets) add("offset", offset);
}

std::vector<ReportStep> plan_narrow(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  const std::vector<PairKind> kinds = narrow_kinds(options.quick);
  for (const PairKind& kind : kinds) {
    const std::string name(kind.name);
    const double hull = kind.hull_vertices;
    steps.push_back({"time of " + name, options.quick ? 0.1 : hull * 0.07 + 0.8,
                     [=](Results& results) { measure_narrow_times(results, options, kind); }});
  }
  for (const PairKind& kind : kinds) {
    const std::string name(kind.name);
    const double hull = kind.hull_vertices;
    steps.push_back(
        {"errors of " + name, options.quick ? 0.05 : hull * 0.02 + 0.5, [=](Results& results) {
           measure_narrow_errors(results, options, kind, has_curves(kind));
         }});
  }
  for (const PairKind& kind : kinds) {
    if (has_curves(kind)) add_curve_steps(steps, options, kind);
  }
  return steps;
}

}  // namespace

const ReportSection kNarrowSection{"narrow", "Speed against error: narrow phase", declare_narrow,
                                   plan_narrow, show_narrow};

}  // namespace winnow::bench
