#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/scenes/meshes.h"

#include <vector>

namespace winnow::bench {

/// Input of a scene engine: moving bodies, and a fixed triangle mesh at the origin (none if it is
/// empty).
struct BodySet {
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  Triangles mesh;
};

}  // namespace winnow::bench
