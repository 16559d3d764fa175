#pragma once

#include "pipeline/scene_race.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// A race on a scene of the whole pipeline.
struct PipelineMeasureOptions {
  std::string scene = "pile";  ///< pile or terrain
  bool resting = false;        ///< and winnow carries contacts over
  SceneLevel level = SceneLevel::manifold;
  std::vector<int> threads{1, 2};
  bool peers = true;
  std::size_t frames = 9;
  std::uint64_t seed = 1;
};

struct PipelineMeasurement {
  std::vector<SceneTiming> timings;
  std::vector<std::string> peers;  ///< names of the other libraries that took part
  std::size_t bodies = 0;
  std::size_t triangles = 0;
  double machine_ms = 0.0;  ///< of the MachineClock, before and after the race

  /// Null if there is none.
  [[nodiscard]] const SceneTiming* winnow(int threads) const noexcept;
  [[nodiscard]] const SceneTiming* peer(const std::string& name) const noexcept;
};

[[nodiscard]] PipelineMeasurement measure_pipeline(const PipelineMeasureOptions& options);

struct MeshMeasurement {
  std::vector<MeshTiming> timings;  ///< winnow's is the first
  double machine_ms = 0.0;

  [[nodiscard]] const MeshTiming* peer() const noexcept {
    return timings.size() > 1 ? &timings[1] : nullptr;
  }
};

/// Two tori, one thread.
[[nodiscard]] MeshMeasurement measure_meshes(std::size_t rounds, bool peers);

}  // namespace winnow::bench
