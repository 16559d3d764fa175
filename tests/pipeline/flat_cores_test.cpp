// Shapes whose cores are flat polygons, segments or points, coplanar, parallel or collinear,
// rounded or not. Their separating direction may be parallel to the plane, where neither shape has
// a normal. Tier robust must agree with the solver. WINNOW_TEST_SCALE=100 tests a million pairs.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "tests/pipeline/flat_pairs.h"
#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/reproduction.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kMargin = 0.25;

/// Returns the result of the single-pair function.
PairResults answer_of_one(const PairScene& scene, BodyPair pair, const NarrowOptions& options) {
  PairAnswer answer;
  EXPECT_EQ(collide(scene.pool, scene.shapes[pair.a], scene.poses[pair.a], scene.shapes[pair.b],
                    scene.poses[pair.b], options, answer),
            Status::ok);
  PairResults all;
  all.overlap = answer.overlap;
  all.distance = answer.distance;
  all.error_bound = answer.error_bound;
  all.normal = as_eigen(answer.normal);
  all.contacts.assign(answer.contacts, answer.contacts + answer.contact_count);
  return all;
}

/// Counts faults by kind and prints the first few.
class Judge {
 public:
  explicit Judge(const PairScene& scene) : scene_(scene) {}

  void judge(std::size_t i, const PairResults& truth, const PairResults& answer,
             const NarrowOptions& options, const std::string& how) {
    if (answer.overlap != truth.overlap) complain(wrong_, "wrong verdict", i, truth, answer, how);
    if (options.level == ContactLevel::boolean) return;
    const double bound = truth.error_bound + answer.error_bound;
    const bool far =
        options.level == ContactLevel::manifold && answer.distance > options.contact_margin;
    const double off = answer.distance - truth.distance;
    const bool within = far ? off <= bound : std::abs(off) <= bound;
    if (!within) complain(beyond_, "beyond its bound", i, truth, answer, how);
    if (!(std::abs(answer.normal.norm() - 1.0) < 1e-12)) {
      complain(beyond_, "normal is not unit", i, truth, answer, how);
    }
    if (options.level == ContactLevel::manifold && answer.contacts.empty() != far) {
      complain(beyond_, "contacts", i, truth, answer, how);
    }
  }
  [[nodiscard]] int wrong() const { return wrong_; }
  [[nodiscard]] int beyond() const { return beyond_; }

 private:
  void complain(int& count, const char* what, std::size_t i, const PairResults& truth,
                const PairResults& answer, const std::string& how) {
    ++count;
    if (wrong_ + beyond_ > 3) return;
    ADD_FAILURE() << what << ", " << how << ": " << answer.overlap << " " << answer.distance
                  << " +- " << answer.error_bound << " instead of " << truth.overlap << " "
                  << truth.distance << " +- " << truth.error_bound << '\n'
                  << reproduction(scene_, scene_.pairs[i]);
  }

  const PairScene& scene_;
  int wrong_ = 0;
  int beyond_ = 0;
};

using KindPair = std::tuple<ShapeKind, ShapeKind>;

std::vector<KindPair> flat_kind_pairs() {
  std::vector<KindPair> pairs;
  for (const ShapeKind a : kConvexKinds) {
    for (const ShapeKind b : kConvexKinds) {
      if (a <= b && !(a == ShapeKind::half_space && b == a)) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

class FlatCores : public testing::TestWithParam<KindPair> {};

TEST_P(FlatCores, all_levels_match_solver) {
  const auto [a, b] = GetParam();
  Random random(static_cast<std::uint64_t>(a) * 16 + static_cast<std::uint64_t>(b));
  PairScene scene;
  add_flat_pairs(scene, a, b, scaled(160), random);
  const auto truths =
      compute_results(scene, {.level = ContactLevel::distance, .tier = NarrowTier::reference});
  Judge judge(scene);
  const NarrowOptions all_options[] = {
      {.level = ContactLevel::boolean},
      {.level = ContactLevel::distance},
      {.level = ContactLevel::manifold},
      {.level = ContactLevel::manifold, .contact_margin = kMargin}};
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const NarrowOptions& options : all_options) {
      const std::string how = std::string(to_string(isa)) + ", level " +
                              std::to_string(static_cast<int>(options.level));
      const auto answers = compute_results(scene, options);
      for (std::size_t i = 0; i < truths.size(); ++i) {
        judge.judge(i, truths[i], answers[i], options, how);
        judge.judge(i, truths[i], answer_of_one(scene, scene.pairs[i], options), options,
                    how + ", alone");
      }
    }
  }
  EXPECT_EQ(judge.wrong(), 0);
  EXPECT_EQ(judge.beyond(), 0);
  RecordProperty("pairs", static_cast<int>(scene.pairs.size()));
  RecordProperty("overlapping",
                 static_cast<int>(std::count_if(truths.begin(), truths.end(),
                                                [](const PairResults& t) { return t.overlap; })));
  RecordProperty("wrong", judge.wrong());
  RecordProperty("beyond", judge.beyond());
}

std::string name_of(const testing::TestParamInfo<KindPair>& info) {
  return std::string(to_string(std::get<0>(info.param))) + "_" + to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Pairs, FlatCores, testing::ValuesIn(flat_kind_pairs()), name_of);

}  // namespace
}  // namespace winnow::test
