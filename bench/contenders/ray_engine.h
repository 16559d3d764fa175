#pragma once

#include <winnow/pipeline/shape_rays.h>
#include "bench/contenders/query_engine.h"
#include "bench/scenes/meshes.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// What is asked of rays: where each first meets the mesh; whether it does; the first hit of every
/// body that it meets, sorted, which of one mesh is a list of one.
enum class RayWant { closest, any, all };

/// Anything that takes rays through one triangle mesh: winnow or another library. The harness times
/// `run` from outside, on one thread.
class RayEngine {
 public:
  RayEngine(const RayEngine&) = delete;
  RayEngine& operator=(const RayEngine&) = delete;
  virtual ~RayEngine() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  /// Makes everything ready. Called once; `mesh` outlives the engine.
  virtual void start(const Triangles& mesh) = 0;
  /// Of the mesh and its tree; 0 if it does not tell.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Takes the rays, in whatever form it wants them, to be asked by the next `run`. Not timed.
  virtual void take(std::span<const ShapeRay> rays) = 0;
  virtual void run(RayWant want, Asking asking) = 0;
  /// Of each ray, t of the first hit as the last `run` found it, infinity without one; of
  /// RayWant::any zero instead. Not timed.
  [[nodiscard]] virtual std::vector<double> hits() const = 0;

 protected:
  RayEngine() = default;
};

}  // namespace winnow::bench
