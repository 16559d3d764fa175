#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/engines.h"
#include "bench/contenders/winnow_engines.h"
#include "bench/scenes/body_scenes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

struct SceneContender {
  std::unique_ptr<SceneEngine> engine;
  int threads = 1;
};

/// Results of one engine on a scene.
struct SceneTiming {
  std::string engine;
  int threads = 1;
  std::vector<double> ms{};  ///< ms per frame
  SceneFinds finds{};        ///< of the last frame
  std::size_t bytes = 0;     ///< allocated after the last frame
};

/// Runs all contenders on the same frames in turns; two frames before the timed ones are not timed.
/// On one thread the time is CPU time of the thread, on several wall-clock time.
[[nodiscard]] std::vector<SceneTiming> race_scene(const BodySet& set, const PoseNoise& by,
                                                  std::span<SceneContender> contenders,
                                                  std::size_t frames);

/// Makes the bodies of the scene pile, terrain or balls, equal for each race on it; 0 bodies: the
/// usual number. Takes seconds for the pile.
[[nodiscard]] std::unique_ptr<BodySet> make_pipeline_scene(const std::string& scene,
                                                           std::size_t bodies, std::uint64_t seed);

}  // namespace winnow::bench
