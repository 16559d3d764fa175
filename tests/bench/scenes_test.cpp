// Built-in scenes of the benchmarks: equal seeds make equal scenes, and each moves as its name
// implies.

#include <winnow/core/eigen.h>
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/fingerprint.h"
#include "bench/measure/race.h"
#include "bench/scenes/scene.h"
#include "bench/scenes/solids.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// A scene and the boxes of the frame before the last.
class Watched {
 public:
  Watched(const char* name, std::size_t objects, std::uint64_t seed = 5)
      : scene_(make_scene(name, objects, seed)) {
    keep();
  }

  void advance() {
    keep();
    ASSERT_TRUE(scene_->advance());
  }
  [[nodiscard]] const FrameSource& scene() const { return *scene_; }
  [[nodiscard]] std::vector<std::size_t> changed() const {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < before_.size(); ++i) {
      if (!(before_[i] == scene_->boxes()[i])) rows.push_back(i);
    }
    return rows;
  }
  /// The displacement of the low corner of a box in the last frame.
  [[nodiscard]] Eigen::Vector3d way(std::size_t i) const {
    return scene_->boxes()[i].min.cast<double>() - before_[i].min.cast<double>();
  }
  [[nodiscard]] std::size_t size() const { return before_.size(); }
  /// The share of the objects that moved further than `distance`.
  [[nodiscard]] double share_beyond(double distance) const {
    std::size_t far = 0;
    for (std::size_t i = 0; i < size(); ++i) far += way(i).norm() > distance ? 1U : 0U;
    return static_cast<double>(far) / static_cast<double>(size());
  }

 private:
  void keep() { before_.assign(scene_->boxes().begin(), scene_->boxes().end()); }

  std::unique_ptr<FrameSource> scene_;
  std::vector<Aabb> before_;
};

PairSummary pairs_of(const FrameSource& scene) {
  ReferenceSweep sweep(-1);
  sweep.start(scene.boxes());
  return summarize(sweep.pairs(), scene.boxes());
}

TEST(Scenes, scenes_of_equal_seeds_are_equal) {
  for (const SceneInfo& info : scene_infos()) {
    const auto a = make_scene(info.name, 300, 1);
    const auto b = make_scene(info.name, 300, 1);
    const auto other = make_scene(info.name, 300, 2);
    for (int frame = 0; frame < 5; ++frame) {
      ASSERT_TRUE(std::ranges::equal(a->boxes(), b->boxes())) << info.name << ", frame " << frame;
      EXPECT_FALSE(std::ranges::equal(a->boxes(), other->boxes())) << info.name;
      a->advance();
      b->advance();
      other->advance();
    }
  }
}

TEST(Scenes, boxes_stay_valid_and_inside_the_world) {
  for (const SceneInfo& info : scene_infos()) {
    for (const std::size_t objects : {1U, 2U, 500U}) {
      const auto scene = make_scene(info.name, objects, 3);
      const Aabb world = scene->world();
      for (int frame = 0; frame < 20; ++frame) {
        ASSERT_EQ(scene->objects(), objects) << info.name;
        ASSERT_TRUE(info.name == "growth" || scene->boxes().size() == objects) << info.name;
        for (const Aabb& box : scene->boxes()) {
          ASSERT_TRUE(box.is_valid()) << info.name;
          Aabb merged = world;
          merged.merge(box);
          ASSERT_EQ(merged, world) << info.name << ", frame " << frame;
        }
        scene->advance();
      }
    }
  }
}

TEST(Scenes, scenes_move_as_their_names_imply) {
  const auto moved_share = [](const char* name) {
    Watched watched(name, 4000);
    watched.advance();
    return static_cast<double>(watched.changed().size()) / 4000.0;
  };
  for (const char* name : {"uniform", "teleport", "teleport_mixed", "respawn", "shear", "jumps"}) {
    EXPECT_GT(moved_share(name), 0.99) << name;
  }
  EXPECT_NEAR(moved_share("sleepy"), 0.05, 0.02);
  EXPECT_NEAR(moved_share("jitter"), 0.99, 0.01);
}

TEST(Scenes, teleport_moves_all_boxes_at_equal_density) {
  for (const char* name : {"teleport", "teleport_mixed"}) {
    Watched watched(name, 4000);
    const auto first = static_cast<double>(pairs_of(watched.scene()).pairs);
    watched.advance();
    EXPECT_GT(watched.share_beyond(1.0), 0.98) << name;
    EXPECT_NEAR(static_cast<double>(pairs_of(watched.scene()).pairs), first, 0.15 * first) << name;
  }
}

TEST(Scenes, teleport_keeps_the_sizes) {
  Watched watched("teleport_mixed", 300);
  const Aabb before = watched.scene().boxes()[7];
  watched.advance();
  const Aabb after = watched.scene().boxes()[7];
  const Eigen::Vector3f edges = before.max - before.min;
  EXPECT_TRUE(edges.isApprox(Eigen::Vector3f(after.max - after.min), 1e-4F));
}

TEST(Scenes, respawn_moves_another_tenth_in_each_frame) {
  Watched watched("respawn", 1000);
  std::vector<int> times(1000);
  for (int frame = 0; frame < 10; ++frame) {
    watched.advance();
    EXPECT_NEAR(watched.share_beyond(0.2), 0.1, 0.002);
    for (std::size_t i = 0; i < times.size(); ++i) times[i] += watched.way(i).norm() > 0.2 ? 1 : 0;
  }
  EXPECT_GT(std::count(times.begin(), times.end(), 1), 990);
}

TEST(Scenes, shear_moves_along_x_by_height) {
  Watched watched("shear", 1000);
  const double width =
      static_cast<double>(watched.scene().world().max.x() - watched.scene().world().min.x() - 1.0F);
  for (int frame = 0; frame < 30; ++frame) {
    watched.advance();
    for (std::size_t i = 0; i < watched.size(); ++i) {
      const Eigen::Vector3d way = watched.way(i);
      const double y = static_cast<double>(watched.scene().boxes()[i].min.y()) + 0.5;
      const double forward = way.x() < -1e-4 ? way.x() + width : way.x();
      EXPECT_NEAR(forward, 0.2 * y, 1e-3) << i;
      EXPECT_EQ(way.y(), 0.0);
      EXPECT_EQ(way.z(), 0.0);
    }
  }
}

TEST(Scenes, jumps_move_boxes_by_two_edges) {
  Watched watched("jumps", 4000);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  watched.advance();
  std::size_t whole = 0;
  for (std::size_t i = 0; i < watched.size(); ++i) {
    whole += std::abs(watched.way(i).norm() - 2.0) < 1e-4 ? 1U : 0U;
    EXPECT_LT(watched.way(i).norm(), 2.0001);
    sum += watched.way(i);
  }
  EXPECT_GT(whole, 3000U);  // the others were reflected
  EXPECT_LT(sum.norm() / 4000.0, 0.1);
}

TEST(Scenes, few_movers_change_the_same_seven_boxes) {
  for (const std::size_t objects : {7U, 100U, 20'000U}) {
    Watched watched("few_movers", objects);
    watched.advance();
    const std::vector<std::size_t> movers = watched.changed();
    EXPECT_EQ(movers.size(), 7U);
    for (int frame = 0; frame < 20; ++frame) {
      watched.advance();
      EXPECT_EQ(watched.changed(), movers);
    }
  }
}

TEST(Scenes, jitter_changes_no_pair) {
  for (const std::size_t objects : {300U, 5000U}) {
    Watched watched("jitter", objects);
    const PairSummary first = pairs_of(watched.scene());
    EXPECT_GT(first.pairs, objects);
    for (int frame = 0; frame < 10; ++frame) {
      watched.advance();
      EXPECT_EQ(watched.share_beyond(5e-5), 0.0);
      EXPECT_LE(watched.changed().size(), objects - objects / 100);
      EXPECT_GE(watched.changed().size(), objects - objects / 90);  // some round to zero
      EXPECT_TRUE(pairs_of(watched.scene()).same_pairs(first)) << frame;
    }
  }
}

TEST(Scenes, growth_has_all_objects_after_sixty_frames) {
  const auto scene = make_scene("growth", 20'000, 1);
  EXPECT_EQ(scene->boxes().size(), 20U);
  for (int frame = 0; frame < 60; ++frame) {
    const std::vector<Aabb> before(scene->boxes().begin(), scene->boxes().end());
    ASSERT_TRUE(scene->advance());
    ASSERT_GE(scene->boxes().size(), before.size());
    EXPECT_LE(scene->boxes().size(), 1 + before.size() * 5 / 4);
    const auto way = scene->boxes()[0].min - before[0].min;
    EXPECT_LT(way.norm(), 0.1F);
    EXPECT_LT(before.size(), 20'000U);
  }
  EXPECT_EQ(scene->boxes().size(), 20'000U);
  EXPECT_TRUE(scene->advance());
  EXPECT_EQ(scene->boxes().size(), 20'000U);
}

TEST(Scenes, growth_race_finds_equal_pairs) {
  const auto scene = make_scene("growth", 1500, 1);
  std::vector<Contender> contenders =
      make_contenders({"LinearBvh", "FlatGrid", "AutoPartition"}, 1);
  contenders.push_back(Contender{std::make_unique<ReferenceSweep>(-1)});
  const auto runs = race(*scene, contenders, {.frames = 70});
  EXPECT_TRUE(all_agree(runs));
  EXPECT_GT(runs.front().pairs.back().pairs, 1500U);
}

TEST(Scenes, scene_of_an_unknown_name_is_null) {
  EXPECT_EQ(make_scene("no_such", 10, 1), nullptr);
}

TEST(Solids, margins_begin_at_different_times) {
  constexpr float kShare = 0.2F;
  const Solids solids = Solids::rods(200, 1);
  const std::vector<OrientedBox> then = solids.boxes_at_last_refit(kShare);
  double sum = 0.0;
  for (std::size_t i = 0; i < then.size(); ++i) {
    const OrientedBox& now = solids.boxes()[i];
    const Aabb bounds = now.bounds();
    const float margin = kShare * (as_eigen(bounds.max) - as_eigen(bounds.min)).maxCoeff();
    const float way = (as_eigen(then[i].center) - as_eigen(now.center)).cwiseAbs().maxCoeff();
    EXPECT_LE(way, 1.001F * margin) << i;
    sum += static_cast<double>(way / margin);
  }
  EXPECT_NEAR(sum / static_cast<double>(then.size()), 0.5, 0.1);
}

}  // namespace
}  // namespace winnow::bench
