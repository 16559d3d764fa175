#pragma once

#include "bench/scenes/body_set.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

/// What an engine found in a frame, so that less work does not pass for speed.
struct SceneFinds {
  std::size_t touching = 0;  ///< pairs of bodies, the mesh among them
  std::size_t points = 0;    ///< contact points
};

/// Anything that finds the contacts of a scene, from poses to points: winnow or another library.
/// The harness times `start` and `frame` from outside, on one thread inside a `tbb::task_arena`.
class SceneEngine {
 public:
  SceneEngine(const SceneEngine&) = delete;
  SceneEngine& operator=(const SceneEngine&) = delete;
  virtual ~SceneEngine() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  /// True if it keeps contacts from frame to frame, so that scenes at rest are cheaper.
  [[nodiscard]] virtual bool carries_over() const = 0;
  /// Makes everything ready. Called once, before any frame; `set` outlives the engine.
  virtual void start(const BodySet& set) = 0;
  /// Gives all bodies new poses and finds all contacts with their points.
  virtual void frame(std::span<const Pose> poses) = 0;
  /// Of the last frame. Not timed.
  [[nodiscard]] virtual SceneFinds finds() const = 0;
  /// That it holds after the last frame, all in all; 0 if it does not tell.
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }

 protected:
  SceneEngine() = default;
};

/// Anything that builds a triangle mesh and finds which of its triangles meet those of a copy.
class MeshEngine {
 public:
  using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  MeshEngine(const MeshEngine&) = delete;
  MeshEngine& operator=(const MeshEngine&) = delete;
  virtual ~MeshEngine() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  /// Builds the mesh anew.
  virtual void build(const Triangles& mesh) = 0;
  /// Bytes of the mesh and its tree.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Finds all triangles that meet, with contact points, for the mesh at two poses.
  virtual void collide(const Pose& a, const Pose& b) = 0;
  /// What the last `collide` found. Not timed.
  [[nodiscard]] virtual TrianglePairs pairs() const = 0;

 protected:
  MeshEngine() = default;
};

}  // namespace winnow::bench
