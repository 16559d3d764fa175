// Races winnow's Scene and other libraries on scenes of bodies (pile, terrain, balls).
// bench/rows/scene_rows.cpp calls it.

#include "bench/measure/scene_race.h"

#include "bench/common/arena.h"
#include "bench/common/sample.h"

#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

constexpr std::size_t kWarming = 2;
constexpr std::size_t kPileBodies = 20'000;
constexpr std::size_t kBalls = 100'000;
constexpr std::size_t kTerrainBodies = 2'000;
/// 200,978 triangles.
constexpr std::uint32_t kTerrainCells = 317;

double frame_ms(const SceneContender& contender, Arenas& arenas, std::span<const Pose> poses) {
  if (contender.threads == 1) {
    const ThreadStopwatch own_clock;
    contender.engine->frame(poses);
    return own_clock.ms();
  }
  double ms = 0.0;
  arenas.run(contender.threads, [&] {
    const Stopwatch clock;
    contender.engine->frame(poses);
    ms = clock.ms();
  });
  return ms;
}

}  // namespace

std::vector<SceneTiming> race_scene(const BodySet& set, const PoseNoise& by,
                                    std::span<SceneContender> contenders, std::size_t frames) {
  int most_threads = 1;
  std::vector<SceneTiming> timings;
  for (const SceneContender& contender : contenders) {
    most_threads = std::max(most_threads, contender.threads);
    timings.push_back({.engine = contender.engine->name(), .threads = contender.threads});
    contender.engine->start(set);
  }
  Arenas arenas(most_threads);
  std::vector<Pose> poses;
  for (std::size_t frame = 0; frame < kWarming + frames; ++frame) {
    apply_pose_noise(set, by, frame, poses);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const double ms = frame_ms(contenders[i], arenas, poses);
      if (frame >= kWarming) timings[i].ms.push_back(ms);
    }
  }
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    timings[i].finds = contenders[i].engine->finds();
    timings[i].bytes = contenders[i].engine->bytes();
  }
  return timings;
}

std::unique_ptr<BodySet> make_pipeline_scene(const std::string& scene, std::size_t bodies,
                                             std::uint64_t seed) {
  if (scene == "pile") return make_heap(bodies != 0 ? bodies : kPileBodies, seed);
  if (scene == "balls") return make_balls(bodies != 0 ? bodies : kBalls, seed);
  if (bodies == 0) return make_landscape(kTerrainBodies, kTerrainCells, seed);
  const double share = static_cast<double>(bodies) / static_cast<double>(kTerrainBodies);
  const auto cells = static_cast<std::uint32_t>(std::lround(kTerrainCells * std::sqrt(share)));
  return make_landscape(bodies, std::max(1U, cells), seed);
}

}  // namespace winnow::bench
