// Races: all contenders run all frames, and their pairs are compared.

#include "bench/measure/race.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace winnow::bench {
namespace {

/// A reference sweep that loses a pair in one frame.
class LosingSweep final : public Engine {
 public:
  [[nodiscard]] std::string name() const override { return "losing sweep"; }
  void start(std::span<const Aabb> boxes) override { sweep_.start(boxes); }
  void frame(std::span<const std::uint32_t> rows, std::span<const Aabb> boxes) override {
    sweep_.frame(rows, boxes);
    lost_ = ++frames_ == 5 ? 1 : 0;
  }
  [[nodiscard]] std::span<const Pair> pairs() const override {
    return sweep_.pairs().subspan(lost_);
  }
  [[nodiscard]] std::size_t bytes() const override { return sweep_.bytes(); }

 private:
  ReferenceSweep sweep_;
  int frames_ = 0;
  std::size_t lost_ = 0;
};

/// Returns the runs of the reference sweep and of a contender.
std::vector<Run> runs_beside(std::unique_ptr<Engine> engine) {
  std::vector<Contender> contenders;
  contenders.push_back({std::make_unique<ReferenceSweep>()});
  contenders.push_back({std::move(engine)});
  const auto scene = make_scene("uniform", 300, 1);
  return race(*scene, contenders, {.frames = 12});
}

TEST(Race, equal_contenders_run_all_frames_and_agree) {
  const auto runs = runs_beside(std::make_unique<ReferenceSweep>(1));
  for (const auto& run : runs) EXPECT_EQ(run.frame_ms.size(), 12U);
  EXPECT_TRUE(all_agree(runs));
}

TEST(Race, lost_pair_of_one_frame_is_noticed) {
  const auto runs = runs_beside(std::make_unique<LosingSweep>());
  EXPECT_FALSE(all_agree(runs));
}

}  // namespace
}  // namespace winnow::bench
