#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/scene_engine.h"
#include "bench/contenders/winnow_scene.h"
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

/// Options of a race on a scene of the whole pipeline.
struct PipelineMeasureOptions {
  std::string scene = "pile";  ///< pile, terrain or balls
  bool resting = false;        ///< bodies rest, and winnow caches contacts
  ContactLevel level = ContactLevel::manifold;
  std::vector<int> threads{1, 2};
  bool peers = true;
  std::size_t frames = 9;
  const BodySet* set = nullptr;  ///< the scene's bodies, if already made
  std::size_t bodies = 0;        ///< number of bodies to make; 0: the scene's default
  std::uint64_t seed = 1;
};

/// Makes the bodies of a scene, equal for each race on it. Takes seconds for the pile.
[[nodiscard]] std::unique_ptr<BodySet> make_pipeline_scene(const std::string& scene,
                                                           std::size_t bodies, std::uint64_t seed);

struct PipelineMeasurement {
  std::vector<SceneTiming> timings;
  std::size_t bodies = 0;
  std::size_t triangles = 0;
};

[[nodiscard]] PipelineMeasurement measure_pipeline(const PipelineMeasureOptions& options);

/// Options for the cost of a scene's contacts by level and contact margin, with bodies that move a
/// little.
struct SceneCostOptions {
  std::string scene = "balls";
  int threads = 1;
  std::size_t frames = 9;
  std::size_t bodies = 0;
  std::uint64_t seed = 1;
};

struct SceneCost {
  ContactLevel level{};
  double contact_margin = 0.0;  ///< 0, then a fiftieth of a body's size, for each level
  SceneTiming timing;
};

/// Measures the levels distance and manifold.
[[nodiscard]] std::vector<SceneCost> measure_scene_costs(const SceneCostOptions& options);

}  // namespace winnow::bench
