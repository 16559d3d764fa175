// Benchmarks of pairs of shapes, by kind and level: winnow on every instruction set, its tier
// `reference`, calls for a single pair, sets that exceed the caches, and other libraries; and the
// errors of all of them on pairs that nearly touch, against results of 100 digits.

#include "bench/micro/micro.h"

#include "bench/contenders/winnow_engines.h"
#include "bench/measure/accuracy.h"

#include <winnow/simd/isa.h>

#include <algorithm>
#include <cmath>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kPairs = 8192;
/// Does not fit the caches; the bodies are in random order in memory.
constexpr std::size_t kManyPairs = 100'000;

using MakeEngine = std::function<std::unique_ptr<NarrowEngine>()>;

MakeEngine winnow_tier(NarrowTier tier, int threads = 1) {
  return [=] { return make_winnow_narrow(tier, threads); };
}

/// Calls `visit(name, make)` for each other library that supports such pairs.
template <typename Visit>
void each_pair_peer(const PairKind& kind, ContactLevel level, Visit&& visit) {
  each_peer<NarrowEngine>([&](const NarrowEngine& peer, const MakeEngine& make) {
    if (peer.takes(kind, level)) visit(word_of(peer.name()), make);
  });
}

/// The pairs of a benchmark, and where they are computed.
struct PairsOptions {
  std::size_t pairs = kPairs;
  bool upright = false;  ///< see PairSetOptions
  Isa isa = active_isa();
  int threads = 1;

  [[nodiscard]] std::string set_key(const PairKind& kind) const {
    return "pairs " + std::string(kind.name) + " " + std::to_string(pairs) + (upright ? " up" : "");
  }
};

const PairSet& random_pairs(const PairKind& kind, const PairsOptions& options) {
  return prepared_by<const PairSet>(options.set_key(kind), [&] {
    return make_pair_set(
        kind,
        {.pairs = options.pairs, .scattered = options.pairs > kPairs, .upright = options.upright});
  });
}

std::vector<NarrowAnswer> answers_of(NarrowEngine& engine, ContactLevel level,
                                     std::span<const BodyPair> pairs) {
  engine.run(level, pairs);
  std::vector<NarrowAnswer> answers;
  for (std::size_t i = 0; i < pairs.size(); ++i) answers.push_back(engine.answer(i));
  return answers;
}

/// Returns the results of the tier `robust` on the narrowest instruction set.
const std::vector<NarrowAnswer>& expected_answers(const PairKind& kind, ContactLevel level,
                                                  const PairsOptions& options) {
  using Answers = std::vector<NarrowAnswer>;
  const std::string key = options.set_key(kind) + " " + std::string(to_text(level));
  return prepared_by<Answers>(key, [&] {
    const PairSet& set = random_pairs(kind, options);
    const IsaGuard guard;
    IsaGuard::choose(available_isas().front());
    const auto engine = make_winnow_narrow(NarrowTier::robust);
    engine->start(set);
    return std::make_unique<Answers>(answers_of(*engine, level, set.pairs));
  });
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

bool same(const NarrowAnswer& a, const NarrowAnswer& b) {
  return a.overlap == b.overlap && a.contacts == b.contacts && same(a.distance, b.distance) &&
         same(a.error_bound, b.error_bound) && std::ranges::equal(a.normal, b.normal) &&
         std::ranges::equal(a.point, b.point);
}

/// How the answers of an engine differ from the expected ones.
struct Differences {
  std::size_t disagree = 0;  ///< pairs with another verdict
  /// Share of the overlapping pairs whose depth differs by more than 1 % of the sizes.
  double other_depth = 0.0;
  /// Mean number of contacts of the overlapping pairs, and of the expected ones.
  double contacts = 0.0;
  double expected_contacts = 0.0;

  /// Returns false for systematic errors.
  [[nodiscard]] bool right(std::size_t pairs) const {
    return 100 * disagree <= pairs && other_depth <= 0.1 && 2.0 * contacts >= expected_contacts;
  }
};

Differences compare(const PairSet& set, const std::vector<NarrowAnswer>& expected,
                    const std::vector<NarrowAnswer>& got) {
  Differences found;
  double overlapping = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    found.disagree += got[i].overlap == expected[i].overlap ? 0 : 1;
    if (!got[i].overlap || !expected[i].overlap) continue;
    const double sizes = set.radius[set.pairs[i].a] + set.radius[set.pairs[i].b];
    found.other_depth +=
        std::abs(got[i].distance - expected[i].distance) > 0.01 * sizes ? 1.0 : 0.0;
    found.contacts += got[i].contacts;
    found.expected_contacts += expected[i].contacts;
    ++overlapping;
  }
  const double all = std::max(1.0, overlapping);
  found.other_depth /= all;
  found.contacts /= all;
  found.expected_contacts /= all;
  return found;
}

/// Conditions of the answers of an engine, beside the counters that show the differences.
enum class Demand {
  nothing,       ///< other libraries: `right` is a counter
  by_and_large,  ///< they are right
  equal,         ///< they are the expected ones in every bit
};

void count_differences(benchmark::State& state, const Differences& found, std::size_t pairs,
                       ContactLevel level) {
  count(state, "right", found.right(pairs) ? 1.0 : 0.0);
  count(state, "disagree", found.disagree);
  if (level != ContactLevel::boolean) count(state, "other_depth", found.other_depth);
  if (level == ContactLevel::manifold) count(state, "contacts", found.contacts);
}

void time_pairs(benchmark::State& state, NarrowEngine& engine, const PairKind& kind,
                ContactLevel level, const PairsOptions& options, Demand demand) {
  const PairSet& set = random_pairs(kind, options);
  const auto& expected = expected_answers(kind, level, options);
  const auto got = answers_of(engine, level, set.pairs);
  const Differences found = compare(set, expected, got);
  if (demand == Demand::equal) {
    check(std::ranges::equal(expected, got, [](auto& a, auto& b) { return same(a, b); }),
          "the answers differ from those on " + std::string(to_string(available_isas().front())));
  }
  if (demand != Demand::nothing) check(found.right(set.pairs.size()), "the answers are wrong");
  run(state, options.threads, [&] { engine.run(level, set.pairs); });
  count_ns(state, "ns_per_pair", set.pairs.size());
  count_differences(state, found, set.pairs.size(), level);
  if (const double share = engine.recomputed(); !std::isnan(share)) {
    count(state, "recomputed", share);
  }
}

/// Registers an engine on random pairs of a kind. Each benchmark has an engine of its own.
void add_engine(const std::string& name, const PairKind& kind, ContactLevel level,
                const MakeEngine& make, Demand demand, const PairsOptions& options = {}) {
  add(name, options.threads, [=](benchmark::State& state) {
    auto& engine = started<NarrowEngine>(name, make, random_pairs(kind, options));
    IsaGuard::choose(options.isa);
    time_pairs(state, engine, kind, level, options, demand);
  });
}

/// Registers the benchmarks that only the main kinds have: sets that exceed the caches, and upright
/// bodies, whose edges and faces are parallel.
void add_main_kind(const std::string& path, const PairKind& kind, ContactLevel level) {
  for (const int threads : {1, 2}) {
    add_engine(
        path + "/pairs:" + std::to_string(kManyPairs) + "/threads:" + std::to_string(threads), kind,
        level, winnow_tier(NarrowTier::robust, threads), Demand::by_and_large,
        {.pairs = kManyPairs, .threads = threads});
  }
  add_engine(path + "/upright", kind, level, winnow_tier(NarrowTier::robust), Demand::by_and_large,
             {.upright = true});
}

void add_kind(const PairKind& kind, ContactLevel level) {
  const std::string path = "pair/" + std::string(kind.name) + "/" + std::string(to_text(level));
  for (const Isa isa : available_isas()) {
    const bool is_reference = isa == available_isas().front();
    add_engine(path + "/isa:" + to_string(isa), kind, level, winnow_tier(NarrowTier::robust),
               is_reference ? Demand::by_and_large : Demand::equal, {.isa = isa});
  }
  add_engine(path + "/reference", kind, level, winnow_tier(NarrowTier::reference),
             Demand::by_and_large);
  add_engine(
      path + "/collide", kind, level, [] { return make_winnow_one_pair(NarrowTier::robust); },
      Demand::by_and_large);
  each_pair_peer(kind, level, [&](const std::string& name, const MakeEngine& make) {
    add_engine(path + "/" + name, kind, level, make, Demand::nothing);
  });
}

/// Pairs with their true results.
struct JudgedPairs {
  std::unique_ptr<PairSet> set;
  std::vector<oracle::Truth> truths;

  JudgedPairs(const PairKind& kind, const PairSetOptions& options)
      : set(make_pair_set(kind, options)), truths(truths_of(*set)) {}
};

void count_spread(benchmark::State& state, const std::string& of, const ErrorSpread& spread) {
  if (spread.count == 0) return;
  count(state, "worst_" + of, spread.worst);
  if (spread.count >= 100) count(state, "p99_" + of, spread.p99);
  count(state, "median_" + of, spread.median);
}

void count_errors(benchmark::State& state, const Accuracy& errors) {
  count(state, "pairs", errors.pairs);
  count(state, "wrong", errors.wrong);
  count(state, "missing", errors.missing);
  count_spread(state, "error", errors.all);
  count_spread(state, "distance", errors.apart);
  count_spread(state, "depth", errors.depth);
  count_spread(state, "degrees", errors.degrees);
  count(state, "measured", errors.all.count);
  count(state, "beyond_bound", errors.beyond_bound);
  count(state, "normals", errors.degrees.count);
  count(state, "normals_off", errors.normals_off);
}

/// Selects the pairs whose |distance| over size is in one decade; 0 selects all pairs.
std::vector<PairError> errors_at(std::vector<PairError> errors, double gap) {
  std::erase_if(errors, [&](const PairError& one) {
    return gap > 0.0 && !(one.gap >= gap && one.gap < 10.0 * gap);
  });
  return errors;
}

/// Registers the errors and the time of an engine. The answers are right only by and large, but an
/// error beyond the engine's own bound is a failure.
void add_judged(const std::string& path, const PairKind& kind, ContactLevel level,
                const PairSetOptions& options, const std::string& name, const MakeEngine& make,
                double gap = 0.0) {
  const std::string of_set = path + " " + std::string(kind.name);
  add(path + (gap > 0.0 ? "/gap:" + key_text(gap) : "") + "/" + name, [=](benchmark::State& state) {
    const auto& judged = prepared<const JudgedPairs>(of_set, kind, options);
    auto& engine = started<NarrowEngine>(of_set + name, make, *judged.set);
    state.SetLabel(judge_name());
    engine.run(level, judged.set->pairs);
    const Accuracy errors =
        summary_of(errors_at(errors_of(engine, level, *judged.set, judged.truths), gap));
    check(errors.beyond_bound == 0, "an error exceeds its bound");
    run(state, 1, [&] { engine.run(level, judged.set->pairs); });
    count_ns(state, "ns_per_pair", judged.set->pairs.size());
    count_errors(state, errors);
    if (const double share = engine.recomputed(); !std::isnan(share)) {
      count(state, "recomputed", share);
    }
  });
}

/// Registers both tiers and, if `peers`, other libraries.
void add_judged_engines(const std::string& path, const PairKind& kind, ContactLevel level,
                        const PairSetOptions& options, bool peers, double gap = 0.0) {
  for (const NarrowTier tier : kTiers) {
    add_judged(path, kind, level, options, std::string(to_text(tier)), winnow_tier(tier), gap);
  }
  if (!peers) return;
  each_pair_peer(kind, level, [&](const std::string& name, const MakeEngine& make) {
    add_judged(path, kind, level, options, name, make, gap);
  });
}

/// Returns how many pairs are compared with the oracle, which takes milliseconds for two hulls.
std::size_t judged_pairs(const PairKind& kind, double ratio) {
  const std::size_t pairs = kind.hull_vertices > 16 ? 60 : kind.hull_vertices > 0 ? 500 : 2000;
  return ratio == 1.0 ? pairs : pairs / 5;
}

void add_errors_of(const PairKind& kind) {
  for (const double ratio : {1.0, 1e4}) {
    const PairSetOptions options{
        .pairs = judged_pairs(kind, ratio), .ratio = ratio, .nearest = kNearestPairs};
    for (const ContactLevel level : kLevels) {
      const std::string path = "error/" + std::string(kind.name) + "/" +
                               std::string(to_text(level)) + "/ratio:" + key_text(ratio);
      add_judged_engines(path, kind, level, options, ratio == 1.0);
      const bool by_gap =
          ratio == 1.0 && level == ContactLevel::distance &&
          (kind.name == "sphere-box" || kind.name == "box-box" || kind.name == "hull16-hull16");
      for (const double gap : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
        if (by_gap) add_judged_engines(path, kind, level, options, true, gap);
      }
    }
  }
}

/// A parameter that makes queries harder, from 1 to 10^last, and the kinds of pairs it applies to.
struct StabilityCurve {
  const char* name;
  std::vector<const char*> kinds;
  int last;
  void (*set)(PairSetOptions&, double);
};

std::vector<StabilityCurve> stability_curves() {
  return {{"angle",
           {"capsule-capsule", "box-box"},
           -15,
           [](PairSetOptions& set, double value) { set.angle = value; }},
          {"ratio",
           {"sphere-box", "box-box", "hull16-hull16"},
           12,
           [](PairSetOptions& set, double value) { set.ratio = value; }},
          {"offset",
           {"sphere-box", "box-box", "hull16-hull16"},
           12,
           [](PairSetOptions& set, double value) { set.offset = value; }},
          {"thinness",
           {"sphere-triangle", "triangle-triangle"},
           -12,
           [](PairSetOptions& set, double value) { set.thinness = value; }}};
}

void add_curve(const StabilityCurve& curve, const PairKind& kind) {
  const int sign = curve.last < 0 ? -1 : 1;
  for (int power = 0; power <= std::abs(curve.last); ++power) {
    const double value = std::stod("1e" + std::to_string(sign * power));
    PairSetOptions options{.pairs = kind.hull_vertices > 0 ? std::size_t{60} : std::size_t{200},
                           .nearest = kNearestPairs};
    curve.set(options, value);
    add_judged_engines("stability/" + std::string(curve.name) + ":" + key_text(value) + "/" +
                           std::string(kind.name),
                       kind, ContactLevel::distance, options, true);
  }
}

}  // namespace

void add_pairs() {
  for (const PairKind& kind : pair_kinds()) {
    for (const ContactLevel level : kLevels) {
      add_kind(kind, level);
    }
  }
  for (const PairKind& kind : main_pair_kinds()) {
    for (const ContactLevel level : kLevels) {
      add_main_kind("pair/" + std::string(kind.name) + "/" + std::string(to_text(level)), kind,
                    level);
    }
  }
}

void add_errors() {
  for (const PairKind& kind : main_pair_kinds()) add_errors_of(kind);
  for (const StabilityCurve& curve : stability_curves()) {
    for (const char* kind : curve.kinds) add_curve(curve, *find_pair_kind(kind));
  }
}

}  // namespace winnow::bench::micro
