#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/scenes/meshes.h"

#include <vector>

namespace winnow::bench {

/// What a scene engine is given: bodies that move, and a triangle mesh that stands at the origin
/// (none if it is empty).
struct BodySet {
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  Triangles mesh;
};

}  // namespace winnow::bench
