#include "goals/kinds.h"
#include "narrow/accuracy.h"
#include "narrow/winnow_narrow.h"
#include "query/hard_cases.h"
#include "query/questions.h"
#include "tool/measure_accuracy.h"
#include "tool/table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

namespace winnow::bench {
namespace {

/// Streaming keeps this share of what is asked in cache.
constexpr double kStreaming = 0.5;

constexpr std::array kAskedLevels{ContactLevel::boolean, ContactLevel::distance,
                                  ContactLevel::manifold};

std::string on_pairs(const std::string& kind, std::size_t pairs) {
  return kind + ", " + grouped(pairs) + " pairs";
}

Goal speed_of(const NarrowMeasurement& measured, ContactLevel level, double existing_ns,
              double times_faster) {
  const bool streaming = measured.pairs > kMostPairsInCache;
  const double ratio = streaming ? kStreaming * times_faster : times_faster;
  const double scaled = existing_ns * measured.machine_ms / Lab::kReferenceMachineMs;
  const NarrowTiming* peer = measured.best_peer(level);
  // What is known of other libraries is known in cache: streaming is held against this run's alone.
  const bool known = peer == nullptr || !streaming;
  const double here = peer == nullptr ? scaled : peer->median_ns();
  const double best = known ? std::min(scaled, here) : here;
  const NarrowTiming* own = measured.find(NarrowTier::robust, level);
  return {.what = on_pairs(std::string(measured.kind.name), measured.pairs) +
                  (streaming ? " streaming, " : " in cache, ") + std::string(to_text(level)),
          .unit = "ns/pair",
          .asked = best / ratio,
          .measured = own->median_ns(),
          .detail = short_number(ratio) + "x the best existing, " + short_number(scaled) +
                    (peer == nullptr ? " ns; no other is installed"
                                     : " ns, and here " + peer->engine + ", " +
                                           short_number(peer->median_ns()) + " ns") +
                    "; recomputed " + short_number(100.0 * own->recomputed) + " %"};
}

/// The largest over the levels of one time over another.
Goal worst_ratio(Goal goal, const NarrowMeasurement& measured, const auto& over,
                 const auto& under) {
  const bool at_most = goal.sense == Goal::Sense::at_most;
  goal.measured = at_most ? 0.0 : kUnanswered;
  for (const ContactLevel level : kAskedLevels) {
    const NarrowTiming* a = over(measured, level);
    const NarrowTiming* b = under(measured, level);
    if (a == nullptr || b == nullptr) continue;
    const double ratio = a->median_ns() / b->median_ns();
    if (at_most ? ratio <= goal.measured : ratio >= goal.measured) continue;
    goal.measured = ratio;
    goal.detail = std::string(to_text(level)) + ": " + short_number(a->median_ns()) + " over " +
                  short_number(b->median_ns()) + " ns, recomputed " +
                  short_number(100.0 * a->recomputed) + " %";
  }
  return goal;
}

/// One measure of accuracy, summed or the worst over all kinds.
struct Fault {
  const char* what;
  const char* unit;
  double asked;
  double (*of)(const Accuracy&);
  bool is_sum;
  double measured = 0.0;
  std::string detail{};

  void add(const std::string& kind, const Accuracy& accuracy, double scale) {
    const double one = of(accuracy) / scale;
    if (one <= 0.0 || (!is_sum && one <= measured)) return;
    measured = is_sum ? measured + one : one;
    const std::string where = kind + ", " + std::string(to_text(accuracy.level));
    detail =
        is_sum ? detail + (detail.empty() ? "" : "; ") + where + ": " + short_number(one) : where;
  }
};

std::array<Fault, 5> faults() {
  return {
      {{"wrong verdicts", "pairs", 0.0,
        [](const Accuracy& a) { return static_cast<double>(a.wrong); }, true},
       {"worst error", "of the most", 1.0, [](const Accuracy& a) { return a.all.worst; }, false},
       {"errors beyond their bound", "pairs", 0.0,
        [](const Accuracy& a) { return static_cast<double>(a.beyond_bound); }, true},
       {"normals more than 0.01 degrees off", "pairs", 0.0,
        [](const Accuracy& a) { return static_cast<double>(a.normals_off); }, true},
       {"without a finite answer", "pairs", 0.0,
        [](const Accuracy& a) { return static_cast<double>(a.missing); }, true}}};
}

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0e", value);
  return text;
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

NarrowTier tier_of(const Ask& ask) {
  const auto at = std::find(kTierNames.begin(), kTierNames.end(), ask.text("tier"));
  if (at == kTierNames.end()) ask.fail("tier: unknown");
  return static_cast<NarrowTier>(at - kTierNames.begin());
}

}  // namespace

std::vector<Goal> narrow_speed(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  const auto existing = ask.get<std::array<double, 3>>("existing_ns");
  const auto faster = ask.get<std::array<double, 3>>("times_faster");
  if (find_pair_kind(ask.text("pair")) == nullptr) ask.fail("pair: unknown");
  std::vector<Goal> goals;
  for (const std::size_t pairs : ask.get<std::vector<std::size_t>>("pairs")) {
    const NarrowMeasurement& measured = lab.narrow(ask.text("pair"), pairs);
    for (std::size_t i = 0; i < kAskedLevels.size(); ++i) {
      goals.push_back(speed_of(measured, kAskedLevels[i], existing[i], faster[i]));
    }
  }
  return goals;
}

std::vector<Goal> narrow_tiers(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  std::vector<Goal> goals;
  for (const PairKind& kind : pair_kinds()) {
    const std::string name(kind.name);
    const Goal goal{.what = on_pairs(name, ask.count("pairs")) + ": robust over fast, worst level",
                    .unit = "ratio",
                    .asked = ask.number("asked")};
    goals.push_back(worst_ratio(
        goal, lab.narrow(name, ask.count("pairs")),
        [](const NarrowMeasurement& m, ContactLevel l) { return m.find(NarrowTier::robust, l); },
        [](const NarrowMeasurement& m, ContactLevel l) { return m.find(NarrowTier::fast, l); }));
  }
  return goals;
}

std::vector<Goal> narrow_threads(const Ask& ask, const std::vector<Ask>& /*all*/, Lab& lab) {
  std::vector<Goal> goals;
  for (const PairKind& kind : pair_kinds()) {
    const std::string name(kind.name);
    const Goal goal{.what = on_pairs(name, ask.count("pairs")) + ": " +
                            std::to_string(ask.threads()) + " threads, worst level",
                    .unit = "times one thread",
                    .sense = Goal::Sense::at_least,
                    .asked = ask.number("asked")};
    goals.push_back(worst_ratio(
        goal, lab.narrow(name, ask.count("pairs")),
        [](const NarrowMeasurement& m, ContactLevel l) { return m.find(NarrowTier::robust, l); },
        [&](const NarrowMeasurement& m, ContactLevel l) {
          return m.find(NarrowTier::robust, l, ask.threads());
        }));
  }
  return goals;
}

std::vector<Goal> narrow_accuracy(const Ask& ask, const std::vector<Ask>& /*all*/, Lab&) {
  const auto pairs = ask.get<std::map<std::string, std::size_t>>("pairs");
  const double most = ask.number("most_error");
  const TruthSource judge =
      ask.text("judge") == "oracle" ? TruthSource::oracle : TruthSource::reference;
  std::array<Fault, 5> found = faults();
  std::size_t judged = 0;
  for (const PairKind& kind : pair_kinds()) {
    const auto own = pairs.find(std::string(kind.name));
    const std::size_t count = own != pairs.end() ? own->second : pairs.at("others");
    const auto set = make_pair_set(
        kind, {.pairs = count, .ratio = ask.number("ratio"), .nearest = kNearestPairs});
    const auto truths = truths_of(*set, judge);
    WinnowNarrow engine(tier_of(ask), 1);
    engine.start(*set);
    for (const ContactLevel level : kAskedLevels) {
      const Accuracy accuracy = judge_engine(engine, level, *set, truths);
      if (level == ContactLevel::boolean) judged += accuracy.pairs;
      for (Fault& fault : found) {
        fault.add(std::string(kind.name), accuracy, fault.is_sum ? 1.0 : most);
      }
    }
  }
  std::vector<Goal> goals;
  for (const Fault& fault : found) {
    goals.push_back(
        {.what = ask.text("tier") + ", sizes 1:" + short_number(ask.number("ratio")) + ", " +
                 grouped(judged) + " pairs of all kinds judged by " +
                 (judge == TruthSource::oracle && has_oracle() ? "100 digits" : "reference") +
                 ": " + fault.what,
         .unit = fault.is_sum ? fault.unit : scientific(most) + " x (sizes + distance)",
         .asked = fault.asked,
         .measured = fault.measured,
         .detail = fault.detail});
  }
  return goals;
}

std::vector<Goal> narrow_hard_cases(const Ask& ask, const std::vector<Ask>& /*all*/, Lab&) {
  const NarrowTier tier = tier_of(ask);
  Goal goal{.what = ask.text("tier") + ": hard cases that are wrong, either way round",
            .unit = "cases",
            .asked = ask.number("asked")};
  std::size_t cases = 0;
  std::error_code absent;
  for (const auto& file : std::filesystem::directory_iterator(ask.text("folder"), absent)) {
    if (file.path().extension() != ".json") continue;
    std::ifstream in(file.path());
    const Json questions = Json::parse(in);
    cases += questions.size();
    const std::size_t wrong = count_wrong(questions, tier);
    if (wrong == 0) continue;
    goal.measured += static_cast<double>(wrong);
    goal.detail += file.path().stem().string() + " " + std::to_string(wrong) + "; ";
  }
  // Without the cases nothing is shown.
  if (cases == 0) return {};
  goal.detail += "of " + std::to_string(cases);
  return {goal};
}

}  // namespace winnow::bench
