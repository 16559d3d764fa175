#pragma once

#include <winnow/pipeline/shape_rays.h>
#include "bench/common/interface.h"
#include "bench/contenders/query_engine.h"
#include "bench/scenes/meshes.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// The result of a ray query: the first hit on the mesh; whether there is any; or the first hit of
/// every body, sorted (a list of one, as there is one mesh).
enum class RayQueryType { closest, any, all };

/// Base of everything that casts rays at one triangle mesh: winnow and other libraries. The harness
/// times `run` from outside, on one thread.
class RayEngine : public Interface {
 public:
  [[nodiscard]] virtual std::string name() const = 0;
  /// Prepares everything. Called once; `mesh` outlives the engine.
  virtual void start(const Triangles& mesh) = 0;
  /// Bytes of the mesh and its tree; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Stores the rays for the next `run`, converted to the engine's types. Not timed.
  virtual void take(std::span<const ShapeRay> rays) = 0;
  virtual void run(RayQueryType query_type, QueryMode mode) = 0;
  /// Returns the ray parameter t of each ray's first hit in the last `run`, infinity without a hit.
  /// For RayQueryType::any a hit has t = 0. Not timed.
  [[nodiscard]] virtual std::vector<double> hits() const = 0;
};

/// Returns winnow's SceneQueries on a scene of one fixed mesh.
[[nodiscard]] std::unique_ptr<RayEngine> make_winnow_rays();

}  // namespace winnow::bench
