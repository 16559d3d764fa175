// Rows about hard cases: counts the right and wrong answers of winnow's tiers and of other
// libraries. check_hard_case() in bench/questions compares single answers.

#include "bench/rows/rows.h"

#include "bench/common/errors.h"
#include "bench/contenders/engines.h"
#include "bench/peers/peers.h"
#include "bench/questions/hard_cases.h"
#include "bench/questions/questions.h"
#include "bench/rows/machine.h"
#include "bench/scenes/pair_set.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <utility>

namespace winnow::bench {
namespace {

/// Largest allowed error of other libraries relative to the size, since some compute in float.
constexpr double kPeersError = 1e-4;

/// Results of one engine for a family of hard cases.
struct HardCaseTally {
  std::string engine;
  std::size_t right = 0;
  std::size_t wrong = 0;
  std::size_t wrong_verdicts = 0;  ///< wrong answers whose overlap or hit is wrong
  std::size_t not_taken = 0;       ///< cases with shapes, or rays, that the engine does not support
  /// Largest error of a distance, relative to sizes and distance, and as a multiple of the allowed
  /// error. NaN if there is none.
  double worst_error = std::numeric_limits<double>::quiet_NaN();
  double worst_over_allowed = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, std::size_t> faults{};  ///< number of wrong answers by fault

  void add(const CaseVerdict& verdict) {
    ++(verdict.fault.empty() ? right : wrong);
    if (!verdict.fault.empty()) ++faults[verdict.fault];
    if (verdict.fault == kContactLost || verdict.fault == kFalseContact) ++wrong_verdicts;
    worst_error = std::fmax(worst_error, verdict.error);
    worst_over_allowed = std::fmax(worst_over_allowed, verdict.over_allowed);
  }
  /// Formats the counts of faults, for example "contact lost 3, distance 2"; "-" for none.
  [[nodiscard]] std::string faults_text() const {
    std::string text;
    for (const auto& [what, count] : faults) {
      text += (text.empty() ? "" : ", ") + what + " " + std::to_string(count);
    }
    return text.empty() ? "-" : text;
  }
};

/// A hard case in a form that other libraries accept.
struct PeerCase {
  PairSet set;
  double sign = 1.0;          ///< -1 if a and b are swapped
  bool around_origin = true;  ///< the bounds of both shapes contain the origin of their frames
};

/// Throws unless the case has all members that are read without a check.
void check_case(const Json& question) {
  const auto fail = [&](const std::string& what) {
    throw ArgumentError("not a hard case, " + what + ": " + question.dump().substr(0, 200));
  };
  if (!question.is_object() || !question.contains("id")) fail("without an id");
  const auto expect = question.find("expect");
  if (expect == question.end() || !expect->is_object()) fail("without \"expect\"");
  if (expect->contains("status")) return;
  const bool is_ray = question.contains("ray");
  if (!is_ray && !(question.contains("a") && question.contains("b"))) fail("without shapes");
  const char* verdict = is_ray ? "hit" : "overlap";
  if (!expect->contains(verdict) || !(*expect)[verdict].is_boolean()) fail("without a verdict");
  const bool is_miss = is_ray && !(*expect)["hit"].get<bool>();
  if (!is_miss && !expect->contains(is_ray ? "t" : "distance")) fail("without a number");
}

/// Returns null if other libraries do not support the case.
std::unique_ptr<PeerCase> peer_case(const Json& question) {
  if (!question.contains("a") || !question.contains("b")) return nullptr;
  if (question["expect"].contains("status")) return nullptr;
  auto made = std::make_unique<PeerCase>();
  PairSet& set = made->set;
  set.shapes.resize(2);
  set.poses.resize(2);
  set.radius.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& shape = question[i == 0 ? "a" : "b"];
    if (read_shape(shape, set.pool, set.shapes[i], set.poses[i]) != Status::ok) return nullptr;
    // Other libraries have no rounding.
    if (shape.contains("rounding")) return nullptr;
    const Aabb bounds = set.pool.bounds(set.shapes[i], Pose{});
    made->around_origin = made->around_origin && bounds.overlaps({{0, 0, 0}, {0, 0, 0}});
  }
  const auto kind_of = [&](std::size_t a, std::size_t b) {
    return std::ranges::find_if(main_pair_kinds(), [&](const PairKind& kind) {
      return kind.a == set.shapes[a].kind() && kind.b == set.shapes[b].kind();
    });
  };
  const bool straight = kind_of(0, 1) != main_pair_kinds().end();
  const auto kind = straight ? kind_of(0, 1) : kind_of(1, 0);
  if (kind == main_pair_kinds().end()) return nullptr;
  made->sign = straight ? 1.0 : -1.0;
  set.kind = *kind;
  set.pairs.push_back(straight ? BodyPair{0, 1} : BodyPair{1, 0});
  return made;
}

Json to_json(const Json& question, const NarrowAnswer& answer, double sign) {
  Json normal = Json::array();
  for (const double n : answer.normal) normal.push_back(number_to_json(sign * n));
  return {{"id", question["id"]},        {"status", "ok"},
          {"overlap", answer.overlap},   {"distance", number_to_json(answer.distance)},
          {"normal", std::move(normal)}, {"error_bound", "inf"}};
}

CaseVerdict query_library(NarrowEngine& engine, const PeerCase& converted, const Json& question) {
  const bool reports_distance = engine.takes(converted.set.kind, ContactLevel::distance);
  try {
    engine.start(converted.set);
    engine.run(reports_distance ? ContactLevel::distance : ContactLevel::manifold,
               converted.set.pairs);
  } catch (const std::exception&) {
    return {.fault = "exception"};
  }
  const NarrowAnswer answer = engine.answer(0);
  // If the shapes are apart and the engine reports no distance, only its overlap flag is checked.
  if (!reports_distance && !question["expect"]["overlap"].get<bool>()) {
    return {.fault = answer.overlap ? kFalseContact : ""};
  }
  return check_hard_case(question, to_json(question, answer, converted.sign), kPeersError);
}

void judge_peers(const Json& questions, std::vector<HardCaseTally>& all) {
  std::vector<HardCaseTally> tallies;
  for (const auto& peer : make_peers<NarrowEngine>()) tallies.push_back({.engine = peer->name()});
  for (const Json& question : questions) {
    const auto converted = peer_case(question);
    // An engine can be started only once.
    const auto fresh = make_peers<NarrowEngine>();
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      const bool needs_origin = tallies[i].engine.starts_with("libccd");
      if (converted == nullptr || !fresh[i]->takes(converted->set.kind, ContactLevel::manifold) ||
          (needs_origin && !converted->around_origin)) {
        ++tallies[i].not_taken;
      } else {
        tallies[i].add(query_library(*fresh[i], *converted, question));
      }
    }
  }
  all.insert(all.end(), tallies.begin(), tallies.end());
}

HardCaseTally judge_tier(const Json& questions, NarrowTier tier) {
  HardCaseTally tally{.engine = std::string(to_text(tier))};
  const Json answers = answer(questions, tier);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    tally.add(check_hard_case(questions[i], answers[i], guaranteed_error(tier)));
  }
  return tally;
}

}  // namespace

void add_hard_cases(Results& results, const std::string& family, const Json& questions,
                    bool peers) {
  for (const Json& question : questions) check_case(question);
  std::vector<HardCaseTally> tallies;
  for (const NarrowTier tier : kTiers) tallies.push_back(judge_tier(questions, tier));
  if (peers) judge_peers(questions, tallies);
  for (const HardCaseTally& one : tallies) {
    results.add("hard_cases",
                {{"family", family},
                 {"engine", one.engine},
                 {"right", one.right},
                 {"wrong", one.wrong},
                 {"wrong_verdicts", one.wrong_verdicts},
                 {"not_taken", one.not_taken},
                 {"worst_error", one.worst_error},
                 {"worst_over_allowed", one.worst_over_allowed},
                 {"faults", one.faults_text()},
                 {"command", command_text(is_peer(one.engine) ? "--with-peers " : "",
                                          "query tests/hard_cases/", family, ".json --judge")}});
  }
}

void add_hard_case_totals(Results& results) {
  constexpr std::pair<const char*, const char*> kAnswers[] = {
      {"right", "right"},
      {"wrong", "wrong"},
      {"wrong_verdicts", "of them verdicts"},
      {"not_taken", "not taken"}};
  for (const Json& engine : distinct(results.rows("hard_cases"), "engine")) {
    for (const auto& [value, name] : kAnswers) {
      double sum = 0.0;
      for (const Json* row : results.rows("hard_cases", {{"engine", engine}})) {
        sum += value_of(*row, value);
      }
      results.add("hard_cases_all", {{"engine", engine}, {"answer", name}, {"cases", sum}});
    }
  }
}

}  // namespace winnow::bench
