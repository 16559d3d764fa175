#pragma once

#include "bench/common/interface.h"
#include "bench/scenes/body_scenes.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

/// Number of contacts found in a frame. Reports show it beside the time, because an engine that
/// finds fewer contacts does less work.
struct SceneFinds {
  std::size_t touching = 0;  ///< touching pairs; the mesh counts as a body
  std::size_t points = 0;    ///< contact points
};

/// Base of everything that finds the contacts of a scene, from poses to contact points: winnow and
/// other libraries. The harness times `start` and `frame` from outside, on one thread inside a
/// `tbb::task_arena`.
class SceneEngine : public Interface {
 public:
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if it reuses contacts of the last frame, so that scenes at rest are cheaper.
  [[nodiscard]] virtual bool caches_contacts() const = 0;
  /// Prepares everything. Called once, before any frame; `set` outlives the engine.
  virtual void start(const BodySet& set) = 0;
  /// Sets the poses of all bodies and finds all contacts with their points.
  virtual void frame(std::span<const Pose> poses) = 0;
  /// Returns the numbers for the last frame. Not timed.
  [[nodiscard]] virtual SceneFinds finds() const = 0;
  /// Bytes allocated in total after the last frame; 0 if unavailable.
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }
};

/// Base of everything that builds a triangle mesh and finds the triangles that overlap triangles of
/// a copy.
class MeshEngine : public Interface {
 public:
  using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  [[nodiscard]] virtual std::string name() const = 0;
  /// Builds the mesh anew.
  virtual void build(const Triangles& mesh) = 0;
  /// Bytes of the mesh and its tree.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Finds all overlapping triangles, with contact points, for the mesh at two poses.
  virtual void collide(const Pose& a, const Pose& b) = 0;
  /// Returns the pairs of the last `collide`. Not timed.
  [[nodiscard]] virtual TrianglePairs pairs() const = 0;
};

}  // namespace winnow::bench
