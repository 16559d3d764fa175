// Contact manifolds: the number of points, their depths compared with the pair's depth, and equal
// manifolds for equal shapes given as different kinds.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/simd/isa.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using enum ShapeKind;

constexpr NarrowTier kTiers[] = {NarrowTier::robust, NarrowTier::reference};
constexpr double kMargin = 0.05;

Pose pose_of(const Eigen::Quaterniond& turn, const Eigen::Vector3d& place) {
  Pose pose = Pose::at(place.x(), place.y(), place.z());
  pose.orientation[0] = turn.w();
  for (int i = 0; i < 3; ++i) pose.orientation[i + 1] = turn.vec()[i];
  return pose;
}

ShapeId box_shape(ShapePool& pool, const Eigen::Vector3d& half, bool as_hull) {
  ShapeId id;
  if (!as_hull) {
    id = expect_ok(pool.add(BoxShape{{half.x(), half.y(), half.z()}, 0.0}));
    return id;
  }
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                         (i & 4) != 0 ? half.z() : -half.z());
  }
  id = expect_ok(pool.add_hull(corners, 0.0));
  return id;
}

/// Returns boxes that rest on boxes, slightly tilted and sunk in. Each pair appears four times in
/// the same poses: box-box, box-hull, hull-box and hull-hull.
PairScene resting_boxes(std::size_t count, double least_tilt, double most_tilt, Random& random) {
  PairScene scene;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d half[2];
    for (Eigen::Vector3d& h : half) {
      for (double& x : h) x = random.uniform(0.5, 1.5);
    }
    const double tilt = random.log_uniform(least_tilt, most_tilt);
    const double side = random.uniform(0.0, 6.28);
    const Eigen::Quaterniond tilted(
        Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(side), std::sin(side), 0.0)));
    const Eigen::Quaterniond rotated(Eigen::AngleAxisd(
        random.chance(0.3) ? 0.0 : random.uniform(-3.1, 3.1), Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d place(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4),
                                half[0].z() + half[1].z() - random.uniform(0.0, 0.01));
    const Eigen::Quaterniond world =
        Eigen::Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0.5)
            .normalized();
    for (int given = 0; given < 4; ++given) {
      const auto first = static_cast<std::uint32_t>(scene.shapes.size());
      scene.shapes.push_back(box_shape(scene.pool, half[0], (given & 1) != 0));
      scene.shapes.push_back(box_shape(scene.pool, half[1], (given & 2) != 0));
      scene.poses.push_back(pose_of(world, Eigen::Vector3d::Zero()));
      scene.poses.push_back(pose_of(world * tilted * rotated, world * place));
      scene.pairs.push_back({first, first + 1});
    }
  }
  return scene;
}

double depth_of(const PairResults& answer) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const ContactPoint& c : answer.contacts) deepest = std::max<double>(deepest, c.depth);
  return deepest;
}

/// Returns the number of points of `of` that have no counterpart in `in`.
std::size_t unmatched_points(const PairResults& of, const PairResults& in, double tolerance) {
  const auto near = [&](const ContactPoint& c, const ContactPoint& d) {
    double apart = std::abs(double{c.depth} - double{d.depth});
    for (int i = 0; i < 3; ++i) {
      apart = std::max(apart, std::abs(double{c.position[i]} - double{d.position[i]}));
    }
    return apart <= tolerance;
  };
  return static_cast<std::size_t>(
      std::count_if(of.contacts.begin(), of.contacts.end(), [&](const ContactPoint& c) {
        return std::none_of(in.contacts.begin(), in.contacts.end(),
                            [&](const ContactPoint& d) { return near(c, d); });
      }));
}

TEST(Manifolds, slightly_tilted_cubes_have_four_points) {
  PairScene scene;
  const Eigen::Vector3d half(1, 1, 1);
  scene.shapes = {box_shape(scene.pool, half, true), box_shape(scene.pool, half, true)};
  const Eigen::Quaterniond turn(1.0, 3e-5, 4e-5, 2e-5);
  scene.poses = {Pose{}, pose_of(turn.normalized(), {0.1, 0.1, 1.99})};
  scene.pairs = {{0, 1}};
  for (const NarrowTier tier : kTiers) {
    const PairResults answer = compute_results(scene, {.tier = tier}).at(0);
    EXPECT_EQ(answer.contacts.size(), 4U);
    for (const ContactPoint& contact : answer.contacts) EXPECT_NEAR(contact.depth, 0.01, 5e-4);
  }
}

TEST(Manifolds, box_given_as_hull_matches_box) {
  Random random(5);
  const double tilts[][2] = {{1e-12, 1e-6}, {1e-6, 1e-4}, {1e-4, 1e-2}, {1e-2, 0.1}};
  for (const auto& tilt : tilts) {
    const PairScene scene = resting_boxes(scaled(4000), tilt[0], tilt[1], random);
    for (const Isa isa : available_isas()) {
      const IsaScope scope(isa);
      for (const NarrowTier tier : kTiers) {
        SCOPED_TRACE(std::string(to_string(isa)) + " tilted by " + std::to_string(tilt[1]));
        const auto answers = compute_results(scene, {.tier = tier, .contact_margin = kMargin});
        for (std::size_t i = 0; i < answers.size(); ++i) {
          const PairResults& as_boxes = answers[i / 4 * 4];
          ASSERT_GE(as_boxes.contacts.size(), 2U) << i;
          ASSERT_EQ(answers[i].contacts.size(), as_boxes.contacts.size()) << i;
          // If two axes or two corners are equally good, either may be chosen.
          const double same = 2e-5 + answers[i].error_bound + as_boxes.error_bound;
          ASSERT_NEAR(depth_of(answers[i]), depth_of(as_boxes), same) << i;
        }
      }
    }
  }
}

TEST(Manifolds, resting_hulls_rarely_need_solver) {
  Random random(6);
  for (const double tilt : {1e-14, 1e-10, 1e-7, 1e-5, 1e-3}) {
    const PairScene scene = resting_boxes(500, tilt, 3.0 * tilt, random);
    NarrowPhase narrow;
    NarrowResult result;
    ASSERT_EQ(narrow.collide(scene.pool, scene.bodies(), scene.pairs, {}, result), Status::ok);
    EXPECT_LE(narrow.statistics().recomputed, scene.pairs.size() / 20) << tilt;
  }
}

TEST(Manifolds, capsule_deep_in_hull_has_deepest_point) {
  PairScene scene;
  scene.shapes.resize(2);
  scene.shapes[0] =
      expect_ok(scene.pool.add(CapsuleShape{0.2222824254022642, 0.026282565200887533}));
  const std::vector<Eigen::Vector3d> points{
      {-0.19631014625979862, 0.12218800340009678, -0.81374006265294041},
      {0.28154849142473987, 0.038549749736952646, 0.80102849761636152},
      {0.062003479886133361, -0.15152285426041126, -0.83766352001487832},
      {-0.086893110304325144, 0.14606993770425319, -0.83808389624948587},
      {0.19643134900823414, 0.016241340883103736, 0.86974381062733142},
      {-0.098299979927226236, 0.30210454347201721, -0.4966735780099592},
      {-0.066486376412280987, -0.23867647143189979, 0.69372883531562657},
      {-0.24831994428858464, 0.194020962072501, -0.67466690563330489},
      {-0.063708071679541955, 0.29053466662447802, -0.55276815185466421},
      {0.4153574480228624, 0.10429567270739504, -0.57972170774647402}};
  scene.shapes[1] = expect_ok(scene.pool.add_hull(points, 0.0));
  const double turn[4] = {-0.085698602130273152, -0.51986299515095569, -0.030135590498817796,
                          0.84940571110093332};
  const double other[4] = {0.36052780060193618, 0.65003809976047455, 0.26109453534335325,
                           0.61587321541593332};
  scene.poses = {Pose::at(9.3572710803516728, 3.9158354702756637, 8.8810190294935509),
                 Pose::at(10.102228529405721, 3.4847428763075854, 8.9397608177362375)};
  scene.poses[0].orientation = turn;
  scene.poses[1].orientation = other;
  scene.pairs = {{0, 1}};
  for (const NarrowTier tier : kTiers) {
    const PairResults answer = compute_results(scene, {.tier = tier}).at(0);
    EXPECT_EQ(answer.contacts.size(), 2U);
    EXPECT_NEAR(depth_of(answer), 0.0708781, 1e-6);
  }
}

// A ball near a corner, an edge and a face of a cube, and inside the cube; each case in random
// orientations and in both orders of the bodies.
TEST(Manifolds, ball_on_hull_has_midpoint_and_closest_feature) {
  constexpr double kRadius = 0.5;
  const Eigen::Vector3d half(1.0, 1.5, 2.0);
  const struct {
    Eigen::Vector3d center;
    Eigen::Vector3d on_hull;
    std::uint32_t kind;
  } cases[] = {{{1.2, 1.7, 2.2}, {1.0, 1.5, 2.0}, 0},
               {{1.3, 1.8, 0.4}, {1.0, 1.5, 0.4}, 1},
               {{1.45, 0.2, -0.3}, {1.0, 0.2, -0.3}, 2},
               {{0.8, 0.2, -0.3}, {1.0, 0.2, -0.3}, 2}};
  Random random(31);
  const auto any_turn = [&] {
    Eigen::Vector4d q;
    do {
      for (double& x : q) x = random.uniform(-1.0, 1.0);
    } while (q.norm() > 1.0 || q.norm() < 0.1);
    return Eigen::Quaterniond(q.normalized());
  };
  PairScene scene;
  const ShapeId hull = box_shape(scene.pool, half, true);
  ShapeId ball = expect_ok(scene.pool.add(SphereShape{kRadius}));
  std::vector<Eigen::Vector3d> halfway;
  std::vector<double> depths;
  for (const auto& one : cases) {
    for (int turned = 0; turned < 8; ++turned) {
      const Eigen::Quaterniond turn = any_turn();
      const Eigen::Vector3d place(random.uniform(-9, 9), random.uniform(-9, 9), 3.0);
      const Eigen::Vector3d away = one.center - one.on_hull;
      const double gap = one.center.x() < half.x() ? -away.norm() : away.norm();
      const Eigen::Vector3d outward = away / gap;
      const Eigen::Vector3d ball_end = one.center - kRadius * outward;
      depths.push_back(kRadius - gap);
      halfway.emplace_back(turn * (0.5 * (one.on_hull + ball_end)));
      const auto hull_body = static_cast<std::uint32_t>(scene.shapes.size());
      scene.shapes.insert(scene.shapes.end(), {hull, ball});
      scene.poses.push_back(pose_of(turn, place));
      scene.poses.push_back(pose_of(any_turn(), place + turn * one.center));
      scene.pairs.push_back({hull_body, hull_body + 1});
      scene.pairs.push_back({hull_body + 1, hull_body});
    }
  }
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const NarrowTier tier : kTiers) {
      const auto answers = compute_results(scene, {.tier = tier});
      for (std::size_t i = 0; i < answers.size(); ++i) {
        SCOPED_TRACE(testing::Message()
                     << to_string(isa) << " " << static_cast<int>(tier) << " " << i);
        ASSERT_EQ(answers[i].contacts.size(), 1U);
        const ContactPoint& point = answers[i].contacts[0];
        EXPECT_NEAR(point.depth, depths[i / 2], 1e-5);
        const bool ball_first = i % 2 == 1;
        const auto body = [&](std::size_t k) { return as_eigen(scene.poses[k].position); };
        const Eigen::Vector3d from_hull =
            as_eigen(point.position).cast<double>() +
            (ball_first ? Eigen::Vector3d(body(i / 2 * 2 + 1) - body(i / 2 * 2))
                        : Eigen::Vector3d::Zero());
        EXPECT_LT((from_hull - halfway[i / 2]).norm(), 2e-5);
        const auto of_hull =
            static_cast<std::uint32_t>(ball_first ? point.feature : point.feature >> 32U);
        if (tier != NarrowTier::reference) {
          EXPECT_EQ(of_hull >> 30U, cases[i / 16].kind);
        }
      }
    }
  }
}

/// All pairs of kinds except two half-spaces.
TEST(Manifolds, points_include_deepest_and_respect_margin) {
  const std::vector<ShapeKind> kinds = all_kinds();
  Random random(23);
  for (const PairStyle style : kPairStyles) {
    PairScene scene;
    for (const ShapeKind a : kinds) {
      for (const ShapeKind b : kinds) {
        if (b < a || (a == half_space && b == half_space)) continue;
        add_pairs(scene, a, b, style, scaled(600), random);
      }
    }
    for (const NarrowTier tier : kTiers) {
      for (const double margin : {0.0, kMargin}) {
        SCOPED_TRACE(std::string(to_string(style)) + " margin " + std::to_string(margin));
        const auto answers = compute_results(scene, {.tier = tier, .contact_margin = margin});
        for (std::size_t i = 0; i < answers.size(); ++i) {
          const PairResults& answer = answers[i];
          ASSERT_EQ(answer.contacts.empty(), answer.distance > margin) << i;
          if (answer.contacts.empty()) continue;
          const double reach = extent(scene, scene.pairs[i]) + std::abs(answer.distance);
          const double doubt = answer.error_bound + 1e-6 * reach;
          ASSERT_NEAR(depth_of(answer), -answer.distance, doubt) << i;
          for (const ContactPoint& contact : answer.contacts) {
            ASSERT_GE(contact.depth, -margin - doubt) << i;
          }
        }
      }
    }
  }
}

struct Kinds {
  ShapeKind a;
  ShapeKind b;
};
void PrintTo(const Kinds& kinds, std::ostream* out) {
  *out << to_string(kinds.a) << "_" << to_string(kinds.b);
}
constexpr Kinds kKinds[] = {{capsule, capsule},  {sphere, box},  {sphere, hull},
                            {sphere, triangle},  {capsule, box}, {capsule, hull},
                            {capsule, triangle}, {box, box},     {box, hull},
                            {box, triangle},     {hull, hull},   {hull, triangle},
                            {triangle, triangle}};

class ManifoldsOf : public testing::TestWithParam<Kinds> {};

/// Manifolds of the solver for slightly perturbed poses. Rounding decides which of two equally deep
/// corners is kept, and whether two nearby points are merged. Therefore a manifold is accepted if
/// it matches one of the manifolds here.
class Neighbours {
 public:
  static constexpr double kNudge = 4e-6;
  static constexpr std::size_t kCount = 200;

  explicit Neighbours(PairScene& scene) : scene_(scene), random_(5) { scene_.pairs.clear(); }

  void add(const BodyPair& pair, double reach) {
    for (std::size_t i = 0; i < kCount; ++i) {
      Pose pose = scene_.poses[pair.b];
      const double nudge = random_.log_uniform(1e-3, 1.0) * kNudge;
      for (double& p : pose.position) p += random_.uniform(-nudge, nudge) * reach;
      for (double& q : pose.orientation) q += random_.uniform(-nudge, nudge);
      scene_.pairs.push_back({pair.a, static_cast<std::uint32_t>(scene_.shapes.size())});
      const ShapeId shape = scene_.shapes[pair.b];
      scene_.shapes.push_back(shape);
      scene_.poses.push_back(pose);
    }
  }
  void solve() {
    solved_ = compute_results(scene_, {.tier = NarrowTier::reference, .contact_margin = kMargin});
  }

  /// Returns true if the manifold matches one of the manifolds of pair `place`, in the order of
  /// add().
  [[nodiscard]] bool have(const PairResults& found, std::size_t place, double tolerance) const {
    const auto first = solved_.begin() + static_cast<std::ptrdiff_t>(place * kCount);
    return std::any_of(first, first + kCount, [&](const PairResults& solved) {
      return found.contacts.size() == solved.contacts.size() &&
             unmatched_points(found, solved, tolerance) == 0;
    });
  }

 private:
  PairScene& scene_;
  Random random_;
  std::vector<PairResults> solved_;
};

TEST_P(ManifoldsOf, lanes_match_solver) {
  constexpr std::size_t kBatch = 10000;
  for (std::size_t done = 0; done < scaled(200000); done += kBatch) {
    PairScene scene;
    Random random(100 + done);
    add_pairs(scene, GetParam().a, GetParam().b, PairStyle::ordinary, kBatch, random);
    const auto found = compute_results(scene, {.contact_margin = kMargin});
    const auto solved =
        compute_results(scene, {.tier = NarrowTier::reference, .contact_margin = kMargin});
    const std::vector<BodyPair> pairs = scene.pairs;
    const auto tolerance = [&](std::size_t i) {
      return 2e-5 * (extent(scene, pairs[i]) + std::abs(solved[i].distance));
    };
    std::vector<std::size_t> others;
    Neighbours neighbours(scene);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (solved[i].contacts.empty()) continue;
      ASSERT_NEAR(depth_of(found[i]), -found[i].distance, 0.1 * tolerance(i)) << done + i;
      if (found[i].contacts.size() == solved[i].contacts.size() &&
          unmatched_points(found[i], solved[i], tolerance(i)) == 0) {
        continue;
      }
      neighbours.add(pairs[i], extent(scene, pairs[i]));
      others.push_back(i);
    }
    neighbours.solve();
    for (std::size_t place = 0; place < others.size(); ++place) {
      const std::size_t i = others[place];
      EXPECT_TRUE(neighbours.have(found[i], place, tolerance(i))) << done + i;
    }
    EXPECT_LE(others.size(), kBatch / 200);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ManifoldsOf, testing::ValuesIn(kKinds),
                         [](const testing::TestParamInfo<Kinds>& kinds) {
                           return std::string(to_string(kinds.param.a)) + "_" +
                                  to_string(kinds.param.b);
                         });

}  // namespace
}  // namespace winnow::test
