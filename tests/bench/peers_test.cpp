// Other libraries and the yardstick find exactly the pairs of the reference sweep.

#include "bench/peers/peers.h"
#include "bench/common/random.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/race.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

/// Boxes of which a share moves in each frame, by at most `step` along each axis. If `step` is 1
/// the moves are whole numbers, so that boxes with a common face continue to touch exactly.
class MovingBoxes final : public FrameSource {
 public:
  MovingBoxes(std::vector<Aabb> boxes, double step, double share)
      : boxes_(std::move(boxes)), step_(step), share_(share) {}

  [[nodiscard]] std::string name() const override { return "moving boxes"; }
  [[nodiscard]] Aabb world() const override { return {}; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }
  bool advance() override {
    for (Aabb& box : boxes_) {
      if (random_.unit() >= share_) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const double by = random_.in(-step_, step_);
        const auto moved = static_cast<float>(step_ == 1.0 ? std::round(by) : by);
        box.min[axis] += moved;
        box.max[axis] += moved;
      }
    }
    return true;
  }

 private:
  std::vector<Aabb> boxes_;
  double step_;
  double share_;
  Random random_{7};
};

/// Boxes whose number grows by one half in each frame, until all are present.
class GrowingBoxes final : public FrameSource {
 public:
  explicit GrowingBoxes(std::vector<Aabb> boxes) : all_(std::move(boxes), 0.1, 1.0) {}

  [[nodiscard]] std::string name() const override { return "growing boxes"; }
  [[nodiscard]] Aabb world() const override { return {}; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return all_.boxes().first(count_); }
  [[nodiscard]] std::size_t objects() const override { return all_.objects(); }
  bool advance() override {
    count_ = std::min(all_.objects(), count_ + count_ / 2);
    return all_.advance();
  }

 private:
  MovingBoxes all_;
  std::size_t count_ = 40;
};

std::vector<Aabb> cubes(std::size_t count, float offset = 0.0F) {
  const auto scene = make_scene("uniform", count, 20);
  std::vector<Aabb> boxes(scene->boxes().begin(), scene->boxes().end());
  for (Aabb& box : boxes)
    box = {box.min + Vec3f::constant(offset), box.max + Vec3f::constant(offset)};
  return boxes;
}

/// Returns boxes with this edge at the points of a lattice, `copies` at each point. With edge 1
/// neighbours touch in faces, edges and corners and overlap nowhere.
std::vector<Aabb> lattice(int side, float edge, int copies) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < copies * side * side * side; ++i) {
    const Eigen::Vector3f min =
        Eigen::Vector3i(i % side, i / side % side, i / side / side % side).cast<float>();
    boxes.push_back({min, min.array() + edge});
  }
  return boxes;
}

std::unique_ptr<FrameSource> source_named(const std::string& name) {
  const auto moving = [](std::vector<Aabb> boxes, double step, double share) {
    return std::make_unique<MovingBoxes>(std::move(boxes), step, share);
  };
  if (name == "empty") return moving({}, 0.1, 1.0);
  if (name == "single") return moving(cubes(1), 0.1, 1.0);
  if (name == "still") return moving(cubes(300), 0.1, 0.0);
  if (name == "few") return moving(cubes(700), 0.3, 0.005);
  if (name == "jumping") return moving(cubes(700), 9.0, 0.5);
  if (name == "leaving") return moving(cubes(700), 90.0, 0.1);
  if (name == "growing") return std::make_unique<GrowingBoxes>(cubes(700));
  if (name == "far") return moving(cubes(500, 1e5F), 0.1, 1.0);
  if (name == "lattice") return moving(lattice(9, 1.0F, 1), 1.0, 0.1);
  if (name == "points") return moving(lattice(6, 0.0F, 2), 1.0, 0.3);
  return make_scene(name, 700, 20);
}

void expect_same_pairs(const std::string& source_name, std::vector<Contender> contenders) {
  contenders.insert(contenders.begin(), Contender{std::make_unique<ReferenceSweep>(-1)});
  RaceOptions options;
  options.frames = 9;
  const auto runs = race(*source_named(source_name), contenders, options);
  for (const auto& run : runs) {
    EXPECT_TRUE(run.same_pairs(runs.front())) << run.engine << ", threads: " << run.threads;
    for (const PairSummary& frame : run.pairs) EXPECT_EQ(frame.reported, frame.pairs);
  }
}

class Peers : public testing::TestWithParam<const char*> {};

TEST_P(Peers, each_library_finds_every_pair_once) {
  for (const int threads : {1, 2}) {
    std::vector<Contender> contenders;
    for (auto& peer : make_peers<Engine>(threads)) contenders.push_back({std::move(peer), threads});
    expect_same_pairs(GetParam(), std::move(contenders));
  }
}

TEST_P(Peers, yardstick_finds_every_pair_once) {
  for (const int threads : {1, 2, 3}) {
    auto yardstick = make_yardstick(threads);
    if (yardstick == nullptr) GTEST_SKIP() << "built without it";
    std::vector<Contender> contenders;
    contenders.push_back({std::move(yardstick), threads});
    expect_same_pairs(GetParam(), std::move(contenders));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Peers,
                         testing::Values("empty", "single", "uniform", "sleepy", "still", "few",
                                         "jumping", "leaving", "growing", "mixed", "clustered",
                                         "pile", "wall", "far", "lattice", "points"));

}  // namespace
}  // namespace winnow::bench
