#pragma once

#include "engine/sample.h"
#include "peers/scene_engine.h"
#include "pipeline/scenes.h"

#include <winnow/pipeline/contacts.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// winnow on a scene. What rests is carried over if `carry_over` is above 0.
[[nodiscard]] std::unique_ptr<SceneEngine> make_winnow_scene(
    int threads, double carry_over, ContactLevel level = ContactLevel::manifold);
[[nodiscard]] std::unique_ptr<MeshEngine> make_winnow_mesh();

struct SceneContender {
  std::unique_ptr<SceneEngine> engine;
  int threads = 1;
};

/// One engine on a scene.
struct SceneTiming {
  std::string engine;
  int threads = 1;
  std::vector<double> ms{};  ///< a frame
  SceneFinds finds{};        ///< in the last frame

  [[nodiscard]] double median_ms() const { return median_of(ms); }
};

/// All contenders on the same frames in turns; two frames more are not timed. Time on one thread
/// is what the thread computed, on several that of the clock on the wall.
[[nodiscard]] std::vector<SceneTiming> race_scene(const BodySet& set, const Stray& by,
                                                  std::span<SceneContender> contenders,
                                                  std::size_t frames);

/// One engine on tori.
struct MeshTiming {
  std::string engine;
  std::vector<double> build_ms{};
  double bytes_per_triangle = 0.0;
  /// By torus_poses().
  std::vector<double> collide_ms[4]{};
  std::size_t pairs[4]{};
  /// Pairs that the first engine did not find, or that it alone found.
  std::size_t differ[4]{};
};

[[nodiscard]] std::vector<MeshTiming> race_meshes(
    std::span<const std::unique_ptr<MeshEngine>> engines, std::size_t rounds);

}  // namespace winnow::bench
