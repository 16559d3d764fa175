// The kernels of boxes and triangles compared with a plain reference implementation in long double
// (flat_reference.h).

#include <winnow/pipeline/shape_pool.h>
#include <winnow/simd/isa.h>
#include "pipeline/kernels/kernels.h"
#include "pipeline/solver/solver.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/pipeline/flat_reference.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

// Pairs of two kinds: body 2 i with body 2 i + 1.
struct Scene {
  ShapeKind kind[2];
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  std::vector<BodyPair> pairs;

  template <typename Shape>
  std::uint32_t add(const Shape& shape, const Pose& pose) {
    ShapeId id = expect_ok(pool.add(shape));
    shapes.push_back(id);
    poses.push_back(pose);
    return static_cast<std::uint32_t>(shapes.size() - 1);
  }
  [[nodiscard]] FlatReference reference(std::uint32_t body, const double origin[3]) const {
    const ShapeId id = shapes[body];
    if (id.kind() == ShapeKind::box) {
      return {pool.tables().boxes[id.index()], poses[body], origin};
    }
    return {pool.tables().triangles[id.index()], poses[body], origin};
  }
};

struct Answers {
  std::vector<std::uint8_t> overlap;
  std::vector<double> distance, bound, normal[3], point[3];
  std::vector<std::uint32_t> first, count;
  std::vector<float> position[3], depth;
  std::vector<std::uint64_t> feature;
  std::vector<bool> certified;

  [[nodiscard]] LongVector normal_of(std::size_t i) const {
    return {normal[0][i], normal[1][i], normal[2][i]};
  }
  [[nodiscard]] LongVector point_of(std::size_t i) const {
    return {point[0][i], point[1][i], point[2][i]};
  }
};

Answers run(const Scene& scene, ContactLevel level, double margin = 0.0) {
  const std::size_t n = scene.pairs.size();
  Answers r;
  const std::size_t room = 4 * n + 16;
  for (auto* column : {&r.distance, &r.bound}) column->assign(n, 7e77);
  for (int k = 0; k < 3; ++k) {
    r.normal[k].assign(n, 7e77);
    r.point[k].assign(n, 7e77);
    r.position[k].assign(room, 0.0F);
  }
  r.overlap.assign(n, 9);
  r.first.assign(n, 0);
  r.count.assign(n, 0);
  r.depth.assign(room, 0.0F);
  r.feature.assign(room, 0);
  r.certified.assign(n, true);
  std::vector<std::uint32_t> uncertified(n);
  NarrowJob job{};
  job.pairs = scene.pairs.data();
  job.count = static_cast<std::uint32_t>(n);
  job.shapes = scene.shapes.data();
  job.poses = scene.poses.data();
  job.tables = &scene.pool.tables();
  job.margin = margin;
  job.overlap = r.overlap.data();
  job.distance = r.distance.data();
  job.error_bound = r.bound.data();
  for (int k = 0; k < 3; ++k) {
    job.normal[k] = r.normal[k].data();
    job.point[k] = r.point[k].data();
    job.contacts.position[k] = r.position[k].data();
  }
  job.contact_first = r.first.data();
  job.contact_count = r.count.data();
  job.contacts.depth = r.depth.data();
  job.contacts.feature = r.feature.data();
  job.uncertified = uncertified.data();
  const NarrowKernels* kernels = narrow_kernels(scene.kind[0], scene.kind[1]);
  const std::uint32_t index = kernel_index(level);
  const std::uint32_t left = kernels->of_level[index](job);
  EXPECT_LE(left, n);
  for (std::uint32_t i = 0; i < left; ++i) r.certified[uncertified[i]] = false;
  return r;
}

Pose random_pose(Random& random, double reach) {
  Pose pose;
  for (double& x : pose.position) x = random.uniform(-reach, reach);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

// Returns an orientation with axes parallel to the world's, or off by at most `turn`.
Pose aligned_pose(Random& random, double turn) {
  Pose pose;
  for (double& x : pose.position) x = static_cast<double>(random.below(7)) * 0.5 - 1.5;
  for (double& q : pose.orientation) q = random.chance(0.5) ? 0.0 : 1.0;
  pose.orientation[random.below(4)] = 1.0;
  for (double& q : pose.orientation) q += random.uniform(-turn, turn);
  return pose;
}

// Adds a shape of the kind. If `wild`, it may be flat, thin, a point, or of a size from 1e-6 to
// 1e4.
std::uint32_t add_shape(Random& random, Scene& scene, ShapeKind kind, const Pose& pose, bool wild) {
  const double rounding = random.chance(0.25) ? random.uniform(0.0, 0.3) : 0.0;
  const double size = wild && random.chance(0.3) ? random.log_uniform(1e-6, 1e4) : 1.0;
  if (kind == ShapeKind::box) {
    BoxShape box;
    box.rounding = rounding;
    for (double& h : box.half) {
      h = size * (wild ? 0.5 * static_cast<double>(random.below(3)) : random.uniform(0.2, 1.0));
    }
    return scene.add(box, pose);
  }
  TriangleShape triangle;
  triangle.rounding = rounding;
  for (auto& v : triangle.vertex) {
    for (double& x : v) {
      x = size * (wild ? static_cast<double>(random.below(3)) - 1.0 : random.uniform(-1.0, 1.0));
    }
  }
  return scene.add(triangle, pose);
}

Scene random_scene(ShapeKind a, ShapeKind b, std::size_t count) {
  Scene scene{{a, b}, ShapePool(), {}, {}, {}};
  Random random(11);
  for (std::size_t i = 0; i < count; ++i) {
    const Pose pose_a = random_pose(random, 100.0);
    Pose pose_b = random_pose(random, 1.7);
    for (int k = 0; k < 3; ++k) pose_b.position[k] += pose_a.position[k];
    const std::uint32_t body_a = add_shape(random, scene, a, pose_a, false);
    scene.pairs.push_back({body_a, add_shape(random, scene, b, pose_b, false)});
  }
  return scene;
}

Scene hostile_scene(ShapeKind a, ShapeKind b, std::size_t count) {
  Scene scene{{a, b}, ShapePool(), {}, {}, {}};
  Random random(12);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = random.chance(0.3) ? 0.0 : random.log_uniform(1e-15, 1e-2);
    const Pose pose_a = aligned_pose(random, random.chance(0.5) ? 0.0 : turn);
    Pose pose_b = aligned_pose(random, turn);
    if (random.chance(0.1)) pose_b = pose_a;
    if (random.chance(0.3)) pose_b.position[random.below(3)] += random.log_uniform(1e-12, 1e-1);
    const std::uint32_t body_a = add_shape(random, scene, a, pose_a, true);
    scene.pairs.push_back({body_a, add_shape(random, scene, b, pose_b, true)});
  }
  return scene;
}

// Returns the largest 1-norm of a vertex of the pair, or the sum of the roundings if it is larger.
double scale_of(const FlatReference& a, const FlatReference& b) {
  long double scale = a.rounding + b.rounding;
  for (const FlatReference* t : {&a, &b}) {
    for (const LongVector& v : t->vertices) scale = std::max(scale, v.lpNorm<1>());
  }
  return static_cast<double>(scale);
}

struct FlatReferences {
  FlatReference a;
  FlatReference b;
  long double distance;
  double scale;

  FlatReferences(const Scene& scene, std::size_t i)
      : a(scene.reference(scene.pairs[i].a, scene.poses[scene.pairs[i].a].position.data())),
        b(scene.reference(scene.pairs[i].b, scene.poses[scene.pairs[i].a].position.data())),
        distance(signed_distance(a, b)),
        scale(scale_of(a, b)) {}
};

std::vector<FlatReferences> references_of(const Scene& scene) {
  std::vector<FlatReferences> references;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) references.emplace_back(scene, i);
  return references;
}

// Relative error of the reference implementation: a few roundings.
constexpr long double kReferenceError = 1e-17L;

void expect_overlaps(const std::vector<FlatReferences>& references, const Answers& answers) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (!answers.certified[i]) continue;
    const double doubt = references[i].scale * static_cast<double>(kReferenceError);
    if (std::abs(references[i].distance) <= doubt) continue;
    ASSERT_EQ(answers.overlap[i], references[i].distance <= 0.0L ? 1 : 0)
        << i << " distance " << static_cast<double>(references[i].distance);
  }
}

void expect_distances(const std::vector<FlatReferences>& references, const Answers& answers) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (!answers.certified[i]) continue;
    const FlatReferences& t = references[i];
    const double d = answers.distance[i];
    const double doubt = answers.bound[i] + t.scale * static_cast<double>(64 * kReferenceError);
    ASSERT_NEAR(d, static_cast<double>(t.distance), doubt) << i;
    ASSERT_LE(answers.bound[i], 4e-12 * t.scale) << i;
    if (std::abs(t.distance) > kReferenceError * t.scale) {
      ASSERT_EQ(d <= 0.0, t.distance <= 0.0L) << i;
    }
    const LongVector n = answers.normal_of(i);
    const double tolerance = t.scale * 1e-10;
    ASSERT_NEAR(static_cast<double>(n.norm()), 1.0, 1e-13) << i;
    // The shapes are separated along the normal by the distance.
    ASSERT_NEAR(static_cast<double>(separation(t.a, t.b, n)), d, tolerance) << i;
    // Both witness points are on the shapes.
    const LongVector on_a = answers.point_of(i);
    const LongVector on_b = on_a + n * d;
    const double slack = t.scale * 1e-6;
    ASSERT_LE(static_cast<double>(signed_distance(t.a, FlatReference(on_a))), slack) << i;
    ASSERT_LE(static_cast<double>(signed_distance(t.b, FlatReference(on_b))), slack) << i;
  }
}

void expect_manifolds(const std::vector<FlatReferences>& references, const Answers& answers,
                      double margin) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (!answers.certified[i]) continue;
    const FlatReferences& t = references[i];
    const double d = answers.distance[i];
    const double tolerance = answers.bound[i] + t.scale * 1e-6;
    if (d > margin) {
      ASSERT_EQ(answers.count[i], 0U) << i;
      ASSERT_LE(d, static_cast<double>(t.distance) + tolerance) << i;
      continue;
    }
    ASSERT_NEAR(d, static_cast<double>(t.distance),
                answers.bound[i] + t.scale * static_cast<double>(64 * kReferenceError))
        << i;
    ASSERT_GE(answers.count[i], 1U) << i;
    ASSERT_LE(answers.count[i], kManifoldPoints) << i;
    const std::size_t first = answers.first[i];
    ASSERT_NEAR(answers.depth[first], -d, tolerance) << i;
    const double off = t.scale * 1e-5;
    for (std::size_t p = first; p < first + answers.count[i]; ++p) {
      ASSERT_LE(answers.depth[p], answers.depth[first] + tolerance) << i;
      const LongVector x(answers.position[0][p], answers.position[1][p], answers.position[2][p]);
      const double half = 0.5 * std::abs(static_cast<double>(answers.depth[p]));
      ASSERT_LE(static_cast<double>(signed_distance(t.a, FlatReference(x))), half + off) << i;
      ASSERT_LE(static_cast<double>(signed_distance(t.b, FlatReference(x))), half + off) << i;
    }
  }
}

struct Kinds {
  ShapeKind a;
  ShapeKind b;
};

class FlatKernels : public ::testing::TestWithParam<Kinds> {};

std::string name_of(const ::testing::TestParamInfo<Kinds>& info) {
  return std::string(to_string(info.param.a)) + "_" + to_string(info.param.b);
}

void expect_all_right(const Scene& scene) {
  const std::vector<FlatReferences> references = references_of(scene);
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    expect_overlaps(references, run(scene, ContactLevel::boolean));
    expect_distances(references, run(scene, ContactLevel::distance));
    for (const double margin : {0.0, 0.25}) {
      expect_manifolds(references, run(scene, ContactLevel::manifold, margin), margin);
    }
  }
}

TEST_P(FlatKernels, random_pairs_stay_within_error_bounds) {
  expect_all_right(random_scene(GetParam().a, GetParam().b, scaled(1'000)));
}

TEST_P(FlatKernels, hostile_pairs_are_right_or_not_certified) {
  expect_all_right(hostile_scene(GetParam().a, GetParam().b, scaled(3'000)));
}

TEST_P(FlatKernels, random_pairs_are_almost_always_certified) {
  const Scene scene = random_scene(GetParam().a, GetParam().b, 4'096);
  for (const auto level : {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    const Answers answers = run(scene, level);
    const auto left = std::count(answers.certified.begin(), answers.certified.end(), false);
    EXPECT_LE(left, 12) << static_cast<int>(level);
  }
}

TEST_P(FlatKernels, swapped_pairs_give_mirrored_answers) {
  if (GetParam().a != GetParam().b) GTEST_SKIP() << "these kinds have only one order";
  Scene scene = random_scene(GetParam().a, GetParam().b, 515);
  const Answers given = run(scene, ContactLevel::distance);
  const Answers manifold = run(scene, ContactLevel::manifold, 0.1);
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
  const Answers mirrored = run(scene, ContactLevel::distance);
  const Answers mirrored_manifold = run(scene, ContactLevel::manifold, 0.1);
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    ASSERT_EQ(given.distance[i], mirrored.distance[i]);
    ASSERT_EQ(given.bound[i], mirrored.bound[i]);
    ASSERT_EQ(given.normal_of(i), -mirrored.normal_of(i));
    const Pose& a = scene.poses[scene.pairs[i].b];
    const Pose& b = scene.poses[scene.pairs[i].a];
    const LongVector apart(b.position[0] - a.position[0], b.position[1] - a.position[1],
                           b.position[2] - a.position[2]);
    const LongVector on_b = given.point_of(i) + given.normal_of(i) * given.distance[i] - apart;
    ASSERT_LT((mirrored.point_of(i) - on_b).norm(), 1e-13L);
    ASSERT_EQ(manifold.count[i], mirrored_manifold.count[i]);
    for (std::uint32_t p = 0; p < manifold.count[i]; ++p) {
      const std::size_t x = manifold.first[i] + p;
      const std::size_t y = mirrored_manifold.first[i] + p;
      ASSERT_EQ(manifold.depth[x], mirrored_manifold.depth[y]);
      ASSERT_EQ(manifold.feature[x] >> 32U, mirrored_manifold.feature[y] & 0xFFFFFFFFU);
    }
  }
  for (BodyPair& pair : scene.pairs) std::swap(pair.a, pair.b);
}

TEST_P(FlatKernels, answers_match_at_any_batch_position_and_isa) {
  Scene scene = hostile_scene(GetParam().a, GetParam().b, 301);
  for (const auto level : {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    const Answers whole = run(scene, level, 0.1);
    for (const Isa isa : available_isas()) {
      const IsaScope scope(isa);
      const std::vector<BodyPair> all = scene.pairs;
      scene.pairs.erase(scene.pairs.begin(), scene.pairs.begin() + 5);
      const Answers again = run(scene, level, 0.1);
      scene.pairs = all;
      for (std::size_t i = 0; i + 5 < all.size(); ++i) {
        ASSERT_EQ(again.certified[i], whole.certified[i + 5]) << i;
        if (!again.certified[i]) continue;
        if (level == ContactLevel::boolean) {
          ASSERT_EQ(again.overlap[i], whole.overlap[i + 5]) << i;
          continue;
        }
        ASSERT_EQ(again.distance[i], whole.distance[i + 5]) << i;
        ASSERT_EQ(again.bound[i], whole.bound[i + 5]) << i;
        ASSERT_EQ(again.normal_of(i), whole.normal_of(i + 5)) << i;
        if (level == ContactLevel::distance) {
          ASSERT_EQ(again.point_of(i), whole.point_of(i + 5)) << i;
        } else {
          ASSERT_EQ(again.count[i], whole.count[i + 5]) << i;
          for (std::uint32_t p = 0; p < again.count[i]; ++p) {
            ASSERT_EQ(again.depth[again.first[i] + p], whole.depth[whole.first[i + 5] + p]);
            ASSERT_EQ(again.feature[again.first[i] + p], whole.feature[whole.first[i + 5] + p]);
          }
        }
      }
    }
  }
}

TEST_P(FlatKernels, bad_poses_and_huge_sizes_are_not_certified) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Scene scene = random_scene(GetParam().a, GetParam().b, 64);
  scene.poses[scene.pairs[3].a].position[1] = kNan;
  scene.poses[scene.pairs[9].b].position[0] = kInfinity;
  scene.poses[scene.pairs[20].a].orientation[2] = kNan;
  scene.poses[scene.pairs[21].b].orientation[0] = kInfinity;
  for (double& q : scene.poses[scene.pairs[40].b].orientation) q = 0.0;
  for (double& q : scene.poses[scene.pairs[41].a].orientation) q = 0.0;
  scene.poses[scene.pairs[50].a].position[0] = 1e200;
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const auto level :
         {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
      const Answers answers = run(scene, level);
      for (const std::size_t i : {3U, 9U, 20U, 21U, 40U, 41U, 50U}) {
        EXPECT_FALSE(answers.certified[i]) << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FlatKernels,
                         ::testing::Values(Kinds{ShapeKind::box, ShapeKind::box},
                                           Kinds{ShapeKind::box, ShapeKind::triangle},
                                           Kinds{ShapeKind::triangle, ShapeKind::triangle}),
                         name_of);

}  // namespace
}  // namespace winnow::test
