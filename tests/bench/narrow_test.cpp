// Pair sets on which the narrow phase is measured, and the error counts of its answers.

#include "bench/contenders/winnow_engines.h"
#include "bench/measure/accuracy.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>

namespace winnow::bench {
namespace {

constexpr std::size_t kPairs = 100;

std::vector<bool> verdicts(const PairSet& set) {
  const auto engine = make_winnow_narrow(NarrowTier::reference);
  engine->start(set);
  engine->run(ContactLevel::boolean, set.pairs);
  std::vector<bool> overlap;
  for (std::size_t i = 0; i < set.pairs.size(); ++i) overlap.push_back(engine->answer(i).overlap);
  return overlap;
}

class PairSets : public testing::TestWithParam<PairKind> {};

TEST_P(PairSets, half_of_the_pairs_overlap) {
  const std::vector<bool> overlap = verdicts(*make_pair_set(GetParam(), {.pairs = kPairs}));
  EXPECT_EQ(std::count(overlap.begin(), overlap.end(), true), kPairs / 2);
}

TEST_P(PairSets, equal_seeds_make_equal_sets) {
  const auto one = make_pair_set(GetParam(), {.pairs = kPairs, .seed = 5, .scattered = true});
  const auto other = make_pair_set(GetParam(), {.pairs = kPairs, .seed = 5, .scattered = true});
  EXPECT_EQ(one->shapes, other->shapes);
  EXPECT_EQ(one->radius, other->radius);
  EXPECT_EQ(std::memcmp(one->poses.data(), other->poses.data(), 2 * kPairs * sizeof(Pose)), 0);
}

TEST_P(PairSets, every_pair_has_two_bodies_of_its_own) {
  const auto set = make_pair_set(GetParam(), {.pairs = kPairs, .scattered = true});
  std::vector<int> used(set->poses.size());
  for (const BodyPair& pair : set->pairs) {
    ++used[pair.a];
    ++used[pair.b];
    EXPECT_EQ(set->shapes[pair.a].kind(), GetParam().a);
    EXPECT_EQ(set->shapes[pair.b].kind(), GetParam().b);
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 1), 2 * kPairs);
}

TEST(MovedPairs, pairs_at_any_offset_are_equal) {
  const PairKind& kind = *find_pair_kind("box-box");
  const auto here = make_pair_set(kind, {.pairs = kPairs, .offset = 0.0});
  const auto far = make_pair_set(kind, {.pairs = kPairs, .offset = 1e12});
  for (std::size_t i = 0; i < here->poses.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(far->poses[i].position[axis] - 1e12, here->poses[i].position[axis]);
    }
  }
}

TEST(TurnedPairs, orientations_differ_by_the_given_angle) {
  const auto set = make_pair_set(*find_pair_kind("box-box"), {.pairs = kPairs, .angle = 1e-3});
  for (const BodyPair& pair : set->pairs) {
    const Quaternion& a = set->poses[pair.a].orientation;
    const Quaternion& b = set->poses[pair.b].orientation;
    const Eigen::Quaterniond from(a[0], a[1], a[2], a[3]);
    const Eigen::Quaterniond to(b[0], b[1], b[2], b[3]);
    EXPECT_NEAR(from.angularDistance(to), 1e-3, 1e-9);
  }
}

TEST(ThinTriangles, triangle_height_is_scaled_by_the_thinness) {
  const PairKind& kind = *find_pair_kind("sphere-triangle");
  const auto area = [&](double thinness) {
    const auto set = make_pair_set(kind, {.pairs = 1, .thinness = thinness});
    const auto& v = set->pool.tables().triangles[0].vertex;
    const Eigen::Vector3d p(v[0][0], v[0][1], v[0][2]);
    const Eigen::Vector3d q(v[1][0], v[1][1], v[1][2]);
    const Eigen::Vector3d r(v[2][0], v[2][1], v[2][2]);
    return (q - p).cross(r - p).norm();
  };
  EXPECT_NEAR(area(1e-3) / area(1.0), 1e-3, 1e-9);
}

std::vector<PairKind> kinds() {
  return {pair_kinds().begin(), pair_kinds().end()};
}

std::string name_of(const testing::TestParamInfo<PairKind>& kind) {
  std::string name(kind.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Kinds, PairSets, testing::ValuesIn(kinds()), name_of);

/// Returns one given answer for every pair.
class FixedAnswer final : public NarrowEngine {
 public:
  explicit FixedAnswer(NarrowAnswer answer) : answer_(answer) {}
  [[nodiscard]] std::string name() const override { return "fixed"; }
  [[nodiscard]] bool takes(const PairKind&, ContactLevel) const override { return true; }
  void start(const PairSet&) override {}
  void run(ContactLevel, std::span<const BodyPair>) override {}
  [[nodiscard]] NarrowAnswer answer(std::size_t) const override { return answer_; }

 private:
  NarrowAnswer answer_;
};

Accuracy judged(const NarrowAnswer& answer, const oracle::Truth& truth) {
  const auto set = make_pair_set(pair_kinds().front(), {.pairs = 1});
  FixedAnswer fixed(answer);
  return summary_of(errors_of(fixed, ContactLevel::distance, *set, std::span(&truth, 1)));
}

const oracle::Truth kApart{.known = true,
                           .overlap = false,
                           .distance = 1.0L,
                           .normal = {1.0, 0.0, 0.0},
                           .normal_unique = true,
                           .size = 3.0};

TEST(Accuracy, errors_are_relative_to_size_and_distance) {
  const Accuracy accuracy =
      judged({.distance = 1.5, .error_bound = 0.5, .normal = {1.0, 0.0, 0.0}}, kApart);
  EXPECT_EQ(accuracy.all.worst, 0.125);
  EXPECT_EQ(accuracy.all.p99, 0.125);
  EXPECT_EQ(accuracy.beyond_bound, 0U);
  EXPECT_EQ(accuracy.wrong, 0U);
  EXPECT_EQ(accuracy.normals_off, 0U);
  EXPECT_EQ(accuracy.missing, 0U);
}

TEST(Accuracy, every_fault_is_counted) {
  const Accuracy accuracy = judged(
      {.overlap = true, .distance = 1.5, .error_bound = 0.25, .normal = {1.0, 1e-3, 0.0}}, kApart);
  EXPECT_EQ(accuracy.wrong, 1U);
  EXPECT_EQ(accuracy.beyond_bound, 1U);
  EXPECT_EQ(accuracy.normals_off, 1U);
}

TEST(Accuracy, answer_without_a_distance_is_missing) {
  EXPECT_EQ(judged({}, kApart).missing, 1U);
}

TEST(Accuracy, answer_without_a_normal_counts_only_its_distance) {
  const Accuracy accuracy = judged({.distance = 1.5}, kApart);
  EXPECT_EQ(accuracy.missing, 1U);
  EXPECT_EQ(accuracy.apart.count, 1U);
  EXPECT_EQ(accuracy.degrees.count, 0U);
}

TEST(Accuracy, depths_and_distances_are_counted_apart) {
  std::vector<PairError> errors(4);
  for (std::size_t i = 0; i < 3; ++i) errors[i].error = static_cast<double>(i);
  errors[3].overlap = true;
  errors[3].error = 9.0;
  const Accuracy accuracy = summary_of(errors);
  EXPECT_EQ(accuracy.apart.median, 1.0);
  EXPECT_EQ(accuracy.apart.worst, 2.0);
  EXPECT_EQ(accuracy.depth.worst, 9.0);
  EXPECT_EQ(accuracy.all.count, 4U);
}

}  // namespace
}  // namespace winnow::bench
