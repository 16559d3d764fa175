#pragma once

#include <winnow/pipeline/scene_queries.h>
#include "pipeline/composites/shape_distance.h"
#include "pipeline/scene/scene_state.h"

namespace winnow {

/// Returns the distance to the shape of a body as one to the body.
[[nodiscard]] inline SceneDistance distance_to(const SceneState& scene, std::uint32_t body,
                                               const ShapeDistance& shape) noexcept {
  return {.key = scene.keys.key_of(body),
          .data = scene.keys.client_data(body),
          .part_a = shape.part_a,
          .part = shape.part,
          .distance = shape.distance,
          .error_bound = shape.error_bound,
          .normal = shape.normal,
          .point_a = shape.point_a,
          .point_b = shape.point_b};
}

}  // namespace winnow
