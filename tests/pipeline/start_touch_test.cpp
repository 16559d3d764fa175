// Motions that start in touch, over floors of many primitives with walls that belong to the same
// body.

#include "tests/pipeline/composite_world.h"
#include "tests/support/answers.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/scene_queries.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace winnow::test {
namespace {

/// Floors are at z = 0 from x = -10 to 3. The walls at x = 3 are 4 high.
constexpr double kWall = 3.0;
constexpr double kStart = -3.0;
constexpr double kWay = 9.0;

/// A level: one body, or a floor and a wall.
struct SlideLevel {
  std::string name;
  std::vector<BodyDefinition> bodies;
  /// How far a wall leans back from its foot.
  double lean = 0.0;
};

/// A moving shape whose lowest point is `height` below its centre.
struct SlideMover {
  ShapeId shape;
  double height;
  double reach;
  /// True if the shape is symmetric about the vertical.
  bool is_round = false;
  /// True if no point of the shape is farther out horizontally than its lowest points.
  bool has_wide_base = true;
};

/// All lengths are multiplied by `scale`.
class TouchWorld {
 public:
  explicit TouchWorld(double scale) : scale_(scale) {
    add_levels();
    add_movers();
  }

  ShapePool shapes;
  CompositePool composites{shapes};
  std::vector<SlideLevel> levels;
  std::vector<SlideMover> movers;

 private:
  void add_levels();
  void add_movers();
  [[nodiscard]] Pose at(double x, double y, double z) const {
    return Pose::at(scale_ * x, scale_ * y, scale_ * z);
  }
  [[nodiscard]] ShapeId box(double x, double y, double z) {
    return add(shapes, BoxShape{{scale_ * x, scale_ * y, scale_ * z}, 0.0});
  }
  [[nodiscard]] ShapeId compound(const std::vector<CompoundChild>& children) {
    ShapeId id = expect_ok(composites.add_compound(children));
    return id;
  }
  [[nodiscard]] ShapeId mesh(const std::vector<Eigen::Vector3d>& corners,
                             const std::vector<std::uint32_t>& triangles) {
    Surface surface;
    for (const Eigen::Vector3d& c : corners) {
      surface.vertices.emplace_back((scale_ * c).cast<float>());
    }
    surface.corners = triangles;
    return add(composites, surface);
  }
  [[nodiscard]] ShapeId floor_and_wall(int pieces);

  double scale_;
};

/// Returns a floor of squares with a wall.
ShapeId TouchWorld::floor_and_wall(int pieces) {
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::uint32_t> triangles;
  const auto quad = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& u,
                        const Eigen::Vector3d& v) {
    const auto i = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), {from, from + u, from + v, from + u + v});
    triangles.insert(triangles.end(), {i, i + 1, i + 3, i, i + 3, i + 2});
  };
  const double dx = 13.0 / pieces;
  const double dy = 20.0 / pieces;
  for (int i = 0; i < pieces; ++i) {
    for (int k = 0; k < pieces; ++k) quad({-10 + i * dx, -10 + k * dy, 0}, {dx, 0, 0}, {0, dy, 0});
    quad({kWall, -10 + i * dy, 0}, {0, 0, 4}, {0, dy, 0});
  }
  return mesh(corners, triangles);
}

void TouchWorld::add_levels() {
  const auto whole = [&](const char* name, ShapeId shape, double lean = 0.0,
                         const Pose& pose = Pose{}) {
    levels.push_back({name, {{.shape = shape, .pose = pose, .state = BodyState::fixed}}, lean});
  };
  const CompoundChild wall{box(1, 10, 4), at(kWall + 1, 0, 0)};
  const ShapeId space = add(shapes, HalfSpaceShape{{0, 0, 1}, 0});
  for (const CompoundChild& floor :
       {CompoundChild{box(6.5, 10, 1), at(-3.5, 0, -1)}, CompoundChild{space, Pose{}}}) {
    levels.push_back({"bodies",
                      {{.shape = floor.shape, .pose = floor.pose, .state = BodyState::fixed},
                       {.shape = wall.shape, .pose = wall.pose, .state = BodyState::fixed}}});
    whole("compound of floor and wall", compound({floor, wall}));
  }
  std::vector<CompoundChild> tiles{wall};
  for (int i = 0; i < 13; ++i) tiles.push_back({box(0.5, 10, 0.5), at(i - 9.5, 0, -0.5)});
  whole("compound of tiles", compound(tiles));
  const ShapeId two = floor_and_wall(1);
  whole("mesh of few", two);
  whole("mesh of many", floor_and_wall(8));
  const ShapeId one_sided = floor_and_wall(3);
  EXPECT_EQ(composites.set_one_sided(one_sided), Status::ok);
  whole("one-sided mesh", one_sided);
  whole("compound of a mesh", compound({{two, Pose{}}}));
  std::vector<float> heights(41 * 41);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[i] = i % 41 > 26 ? static_cast<float>(4.0 * scale_) : 0.0F;
  }
  ShapeId field =
      expect_ok(composites.add_height_field({heights, 41, 41, 0, {0.5 * scale_, 0.5 * scale_}}));
  whole("height field", field, 0.5, at(-10, -10, 0));
}

void TouchWorld::add_movers() {
  std::vector<Eigen::Vector3d> frustum;
  std::vector<Eigen::Vector3d> cube;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    cube.push_back(corner);
    const double half = i & 4 ? 0.5 : 1.0;
    frustum.emplace_back(scale_ * Eigen::Vector3d(half, half, 1.0).cwiseProduct(corner));
  }
  ShapeId hull = expect_ok(shapes.add_hull(frustum, 0.0));
  const ShapeId block = box(0.5, 0.5, 0.5);
  const ShapeId ball = add(shapes, SphereShape{scale_ * 0.5});
  const ShapeId crate = mesh(cube, {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
  movers = {{ball, 0.5, 0.5, true, false},
            {block, 0.5, 0.5},
            {add(shapes, CylinderShape{scale_ * 0.5, scale_ * 0.5, 0.0}), 0.5, 0.5, true},
            {add(shapes, CapsuleShape{scale_ * 0.25, scale_ * 0.25}), 0.5, 0.25, true, false},
            {hull, 0.5, 0.5},
            {crate, 0.5, 0.5},
            {compound({{block, at(-1, 0, 0)}, {ball, at(0.2, 0, 0)}}), 0.5, 0.7, false, false}};
}

/// A motion that starts above a level's floor, in the axes and units of the level.
struct SlideWay {
  double gap;
  Eigen::Vector3d travel;
  double turn = 0.0;
};

/// A rigidly moved level with a moving shape that is not yet a body.
class LevelRun {
 public:
  LevelRun(const TouchWorld& world, const SlideLevel& level, const SlideMover& mover, double scale,
           const SlideWay& way, const Eigen::Quaterniond& turned, const Eigen::Vector3d& away)
      : scene_(world.shapes, {.composites = &world.composites}),
        shape_(mover.shape),
        scale_(scale),
        way_(scale * (turned * way.travel)),
        turned_(turned),
        away_(scale * away) {
    for (const BodyDefinition& fixed : level.bodies) {
      BodyDefinition body = fixed;
      body.pose = placed(body.pose);
      floor_.emplace_back() = expect_ok(scene_.add(body));
    }
    EXPECT_EQ(scene_.refresh(), Status::ok);
    const Pose pose =
        placed(Pose::at(scale * kStart, scale * 0.013, scale * (mover.height + way.gap)));
    motion_ = RigidMotion::stationary(pose);
    as_eigen(motion_.travel) = way_;
    as_eigen(motion_.turn) = turned * Eigen::Vector3d(0, 0, way.turn);
  }

  [[nodiscard]] SceneHit cast(bool touching = false) const {
    SceneQueries queries(scene_);
    ShapeCast cast{.shape = shape_, .pose = motion_.start, .touching = touching};
    as_eigen(cast.direction) = way_;
    SceneHit hit = expect_ok(queries.closest(cast, {}, 1e-6 * scale_));
    std::span<const SceneHit> all = expect_ok(queries.all(cast, {}, 1e-6 * scale_));
    EXPECT_EQ(all.empty() ? Key{} : all[0].key, hit.key);
    return hit;
  }
  [[nodiscard]] SceneHit motion_cast(bool touching = false) const {
    SceneQueries queries(scene_);
    const MotionCast cast{shape_, motion_, touching};
    SceneHit hit = expect_ok(queries.closest(cast, {}, 1e-6));
    std::span<const SceneHit> all = expect_ok(queries.all(cast, {}, 1e-6));
    EXPECT_EQ(all.empty() ? Key{} : all[0].key, hit.key);
    return hit;
  }
  /// Returns the time of the first impact in the scene, without initial touches, or 2 if there is
  /// none.
  [[nodiscard]] double first_impact_time() {
    Key key = expect_ok(scene_.add({.shape = shape_, .pose = motion_.start}));
    ContinuousCollision ccd(scene_);
    EXPECT_EQ(ccd.find_impacts({&key, 1}, {&motion_, 1}, {.touching = false}), Status::ok);
    EXPECT_EQ(scene_.remove(key), Status::ok);
    return ccd.impacts().empty() ? 2.0 : ccd.impacts()[0].time;
  }
  [[nodiscard]] Eigen::Vector3d up() const { return turned_ * Eigen::Vector3d::UnitZ(); }

 private:
  [[nodiscard]] Pose placed(const Pose& pose) const {
    Pose result;
    as_eigen(result.position) = turned_ * as_eigen(pose.position) + away_;
    const double turn[4] = {turned_.w(), turned_.x(), turned_.y(), turned_.z()};
    result.orientation = turn;
    return result;
  }

  Scene scene_;
  ShapeId shape_;
  double scale_;
  Eigen::Vector3d way_;
  Eigen::Quaterniond turned_;
  Eigen::Vector3d away_;
  std::vector<Key> floor_;
  RigidMotion motion_;
};

/// Calls test(name, level, mover, run_of(way)) for all levels and movers in several sizes.
template <typename Test>
void for_all(std::uint64_t stream, bool may_turn, Test&& test) {
  Random random(stream);
  for (const double scale : {1.0, 0x1p-10, 256.0}) {
    const TouchWorld world(scale);
    for (const SlideLevel& level : world.levels) {
      for (const SlideMover& mover : world.movers) {
        for (const bool turned : {false, true}) {
          if (turned && !may_turn) continue;
          Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
          if (turned) {
            turn = Eigen::Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1),
                                      random.uniform(-1, 1), random.uniform(-1, 1))
                       .normalized();
          }
          const Eigen::Vector3d away =
              turned ? Eigen::Vector3d(random.uniform(-5, 5), random.uniform(-5, 5), 3)
                     : Eigen::Vector3d::Zero();
          SCOPED_TRACE(level.name + " mover " + std::to_string(&mover - world.movers.data()) +
                       " scale " + std::to_string(scale) + (turned ? " turned" : ""));
          test(random, level, mover, [&](const SlideWay& way) {
            return LevelRun(world, level, mover, scale, way, turn, away);
          });
        }
      }
    }
  }
}

/// Checks that the mover reaches the wall at `time`. A mover that starts above or below the floor
/// may reach the wall a little later, if the wall leans or does not begin at the floor.
[[nodiscard]] testing::AssertionResult is_at_wall(double time, const SlideLevel& level,
                                                  const SlideMover& mover, double gap) {
  const double first = (kWall - kStart - mover.reach) / kWay;
  const double last = first + (mover.has_wide_base ? std::abs(gap) : level.lean) / kWay;
  if (time > first - 4e-6 && time < last + 1e-6) return testing::AssertionSuccess();
  return testing::AssertionFailure() << time << " is not in " << first << " to " << last;
}

[[nodiscard]] Eigen::Vector3d along_floor(Random& random) {
  return {kWay, random.uniform(-3.0, 3.0), 0.0};
}

TEST(StartTouches, ignored_initial_touch_hides_no_wall) {
  for_all(91, true,
          [](Random& random, const SlideLevel& level, const SlideMover& mover, const auto& run_of) {
            for (const double gap : {-1e-2, -1e-5, 0.0, 1e-8, 1e-3}) {
              LevelRun run = run_of({gap, along_floor(random)});
              EXPECT_TRUE(is_at_wall(run.cast().t, level, mover, gap)) << gap;
              EXPECT_TRUE(is_at_wall(run.motion_cast().t, level, mover, gap)) << gap;
              EXPECT_TRUE(is_at_wall(run.first_impact_time(), level, mover, gap)) << gap;
              if (gap <= -1e-5) {
                EXPECT_EQ(run.cast(true).t, 0.0);
                EXPECT_EQ(run.motion_cast(true).t, 0.0);
              }
              if (!mover.is_round) continue;
              LevelRun turning = run_of({gap, along_floor(random), random.uniform(-2.0, 2.0)});
              EXPECT_TRUE(is_at_wall(turning.motion_cast().t, level, mover, gap)) << gap;
            }
          });
}

TEST(StartTouches, motion_into_initial_touch_hits_at_zero) {
  for_all(92, true, [](Random& random, const SlideLevel&, const SlideMover&, const auto& run_of) {
    for (const double gap : {-1e-2, -1e-5}) {
      Eigen::Vector3d travel = along_floor(random);
      travel.z() = -random.log_uniform(1e-2, 10.0);
      LevelRun run = run_of({gap, travel});
      for (const SceneHit& hit : {run.cast(), run.motion_cast()}) {
        EXPECT_TRUE(hit);
        EXPECT_EQ(hit.t, 0.0);
        EXPECT_GT(run.up().dot(as_eigen(hit.normal)), 0.99);
      }
    }
  });
}

TEST(StartTouches, separating_initial_touch_hides_no_wall) {
  for_all(93, true,
          [](Random& random, const SlideLevel& level, const SlideMover& mover, const auto& run_of) {
            if (level.lean != 0.0) return;
            for (const double gap : {-1e-2, -1e-5, 0.0, 1e-8}) {
              Eigen::Vector3d travel = along_floor(random);
              travel.z() = random.log_uniform(1e-3, 3.0);
              LevelRun run = run_of({gap, travel});
              EXPECT_TRUE(is_at_wall(run.cast().t, level, mover, gap)) << gap;
              EXPECT_TRUE(is_at_wall(run.motion_cast().t, level, mover, gap)) << gap;
              EXPECT_TRUE(is_at_wall(run.first_impact_time(), level, mover, gap)) << gap;
            }
          });
}

/// Gaps below the tolerance, with touches enabled.
TEST(StartTouches, near_motion_slides_over_seams_to_wall) {
  for_all(94, false,
          [](Random& random, const SlideLevel& level, const SlideMover& mover, const auto& run_of) {
            for (const double gap : {1e-11, 1e-10, 1e-9, 1e-8, 1e-7}) {
              const LevelRun run = run_of({gap, along_floor(random)});
              EXPECT_TRUE(is_at_wall(run.motion_cast(true).t, level, mover, gap)) << gap;
            }
          });
}

}  // namespace
}  // namespace winnow::test
