// Results of all tiers compared with the oracle (bench/oracle).

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "bench/oracle/oracle.h"
#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/pipeline/reproduction.h"

namespace winnow::test {
namespace {

/// Sine of 0.01 degrees.
constexpr double kNormalError = 1.7453292430883947e-4;

struct Promise {
  NarrowTier tier;
  const char* name;
  /// Largest error of the distance, relative to sizes and distance.
  double error;
};
constexpr Promise kPromises[] = {{NarrowTier::robust, "robust", 4e-7},
                                 {NarrowTier::reference, "reference", 1e-12}};

std::vector<oracle::Truth> truths_of(const PairScene& scene) {
  std::vector<oracle::Truth> truths;
  for (const BodyPair pair : scene.pairs) {
    truths.push_back(oracle::solve(scene.pool.tables(), scene.shapes[pair.a], scene.poses[pair.a],
                                   scene.shapes[pair.b], scene.poses[pair.b]));
  }
  return truths;
}

std::vector<PairResults> answer_of_tier(const PairScene& scene, NarrowTier tier,
                                        ContactLevel level) {
  return compute_results(scene, {.level = level, .tier = tier, .contact_margin = 1e-3});
}

/// Returns the fault of an answer, or an empty string.
std::string fault(const oracle::Truth& truth, const PairResults& answer, const Promise& promise,
                  bool is_distance) {
  if (!truth.known) return {};
  if (answer.overlap != truth.overlap) {
    return truth.overlap ? "contact lost" : "false contact";
  }
  if (!is_distance) return {};
  const double distance = answer.distance;
  const double bound = answer.error_bound;
  const Eigen::Vector3d& n = answer.normal;
  if (!std::isfinite(distance) || !std::isfinite(bound) || !n.allFinite()) return "not finite";
  if (bound < 0.0) return "negative bound";
  const long double error = std::abs(static_cast<long double>(distance) - truth.distance);
  const long double scale = truth.size + std::abs(truth.distance);
  // Square roots limit the precision of the depths of rims.
  const double least = truth.slack > 0.0 ? 1e-10 : 0.0;
  if (error > std::max(promise.error, least) * scale) {
    return "error " + std::to_string(static_cast<double>(std::log10(error / scale)));
  }
  if (error > bound + truth.slack) return "error above its bound";
  if (std::abs(n.norm() - 1.0) > 1e-12) return "normal not unit";
  const Eigen::Vector3d expected(truth.normal[0], truth.normal[1], truth.normal[2]);
  if (truth.normal_unique && (n.cross(expected).norm() > kNormalError || n.dot(expected) < 0.0)) {
    return "normal";
  }
  return {};
}

void expect_faultless(const PairScene& scene, const std::vector<oracle::Truth>& truths,
                      const std::vector<PairResults>& answers, const Promise& promise,
                      ContactLevel level) {
  int faults = 0;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const std::string what = fault(truths[i], answers[i], promise, level == ContactLevel::distance);
    if (what.empty() || ++faults > 2) continue;
    ADD_FAILURE() << promise.name << " level " << static_cast<int>(level) << ": " << what
                  << "\ntruth " << static_cast<double>(truths[i].distance) << " along "
                  << truths[i].normal[0] << ' ' << truths[i].normal[1] << ' ' << truths[i].normal[2]
                  << "\nanswer " << answers[i].distance << " +- " << answers[i].error_bound
                  << " along " << answers[i].normal.transpose() << '\n'
                  << reproduction(scene, scene.pairs[i]);
  }
  EXPECT_EQ(faults, 0) << promise.name << " level " << static_cast<int>(level) << ", of "
                       << scene.pairs.size();
}

using KindPair = std::tuple<ShapeKind, ShapeKind>;

bool is_round(ShapeKind kind) {
  return kind == ShapeKind::cylinder || kind == ShapeKind::cone;
}

std::vector<KindPair> known_pairs() {
  std::vector<KindPair> pairs;
  for (const ShapeKind a : all_kinds()) {
    for (const ShapeKind b : all_kinds()) {
      if (a <= b && a != ShapeKind::half_space) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

class Oracle : public testing::TestWithParam<std::tuple<KindPair, PairStyle>> {};

TEST_P(Oracle, tiers_and_levels_match_oracle) {
  const auto [kinds, style] = GetParam();
  const auto [a, b] = kinds;
  Random random(static_cast<std::uint64_t>(a) * 64 + static_cast<std::uint64_t>(b) * 8 +
                static_cast<std::uint64_t>(style));
  PairScene scene;
  // The oracle is slow for rims, and cannot prove that they touch.
  const bool round = (is_round(a) || is_round(b)) && b != ShapeKind::half_space;
  add_pairs(scene, a, b, style, scaled(round ? 2 : 100), random);
  const std::vector<oracle::Truth> truths = truths_of(scene);
  for (const oracle::Truth& truth : truths) EXPECT_TRUE(truth.known || round);
  for (const Promise& promise : kPromises) {
    for (const ContactLevel level : {ContactLevel::boolean, ContactLevel::distance}) {
      expect_faultless(scene, truths, answer_of_tier(scene, promise.tier, level), promise, level);
    }
  }
}

std::string name_of(const testing::TestParamInfo<std::tuple<KindPair, PairStyle>>& info) {
  const auto [kinds, style] = info.param;
  return std::string(to_string(std::get<0>(kinds))) + "_" + to_string(std::get<1>(kinds)) + "_" +
         to_string(style);
}

INSTANTIATE_TEST_SUITE_P(Pairs, Oracle,
                         testing::Combine(testing::ValuesIn(known_pairs()),
                                          testing::ValuesIn(kPairStyles)),
                         name_of);

}  // namespace
}  // namespace winnow::test
