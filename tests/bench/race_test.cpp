// Races with time bounds: an engine that is too slow stops, and the other engines continue.

#include "bench/measure/race.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

/// A reference sweep that finishes a given number of frames and then runs until the time bound
/// stops it.
class EndlessSweep final : public Engine {
 public:
  explicit EndlessSweep(std::size_t endless_frame) : left_(endless_frame) {}

  [[nodiscard]] std::string name() const override { return "endless sweep"; }
  void start(std::span<const Aabb> boxes) override {
    wait();
    sweep_.start(boxes);
  }
  void frame(std::span<const std::uint32_t> rows, std::span<const Aabb> boxes) override {
    wait();
    sweep_.frame(rows, boxes);
  }
  [[nodiscard]] std::span<const Pair> pairs() const override { return sweep_.pairs(); }
  [[nodiscard]] std::size_t bytes() const override { return sweep_.bytes(); }

 private:
  void wait() {
    const Stopwatch clock;
    while (left_ == 0) check_time(clock);
    --left_;
  }

  std::size_t left_;
  ReferenceSweep sweep_;
};

/// Returns the runs of the reference sweep and of a contender.
std::vector<Run> runs_beside(std::unique_ptr<Engine> engine, const TimeBounds& bounds) {
  std::vector<Contender> contenders;
  contenders.push_back({std::make_unique<ReferenceSweep>()});
  contenders.push_back({std::move(engine)});
  const auto scene = make_scene("uniform", 300, 1);
  return race(*scene, contenders, {.frames = 12, .bounds = bounds});
}

TEST(Race, race_without_bounds_runs_all_frames) {
  const auto runs = runs_beside(std::make_unique<ReferenceSweep>(1), {});
  for (const auto& run : runs) {
    EXPECT_EQ(run.frame_ms.size(), 12U);
    EXPECT_EQ(run.gave_up_ms, 0.0);
  }
  EXPECT_TRUE(all_agree(runs));
}

TEST(Race, slow_race_stops_after_four_frames) {
  const auto runs = runs_beside(std::make_unique<ReferenceSweep>(1), {.run = 1e-12});
  for (const auto& run : runs) {
    EXPECT_EQ(run.frame_ms.size(), 4U);
    EXPECT_EQ(run.pairs.size(), 4U);
  }
}

TEST(Race, race_continues_without_an_engine_that_quits) {
  for (const std::size_t endless : {0U, 1U, 7U}) {
    const auto runs = runs_beside(std::make_unique<EndlessSweep>(endless), {.frame = 0.01});
    EXPECT_EQ(runs[0].frame_ms.size(), 12U);
    EXPECT_EQ(runs[1].frame_ms.size(), endless);
    EXPECT_GE(runs[1].gave_up_ms, 10.0);
    EXPECT_TRUE(all_agree(runs)) << "in the frames that both finished";
  }
}

}  // namespace
}  // namespace winnow::bench
