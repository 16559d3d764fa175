#pragma once

#include "core/numbers/rotation.h"
#include "pipeline/composites/part_tables.h"
#include "pipeline/motion/relative_motion_bounds.h"

namespace winnow::impact {

/// Puts parts of moving bodies into tables of convex shapes, which the impact searches read.
class PartPair {
 public:
  explicit PartPair(const ShapePool& pool) noexcept : tables_(pool) {}

  [[nodiscard]] const ShapeTables& tables() const noexcept { return tables_.tables(); }

  /// Stores a part in slot 0 or 1. If the pose of a triangle has no rotation, its corners are
  /// stored in the frame of the body. Corners that neighbouring triangles share are then equal bit
  /// for bit, so there is no gap between neighbours.
  [[nodiscard]] MovingPart put(std::size_t slot, const MovingShape& moving) noexcept {
    SubShape part = moving.shape;
    MovingPart result{part.shape, moving.motion};
    TriangleShape own;
    if (part.triangle != nullptr && is_unturned(part.pose)) {
      own = *part.triangle;
      for (auto& corner : own.vertex) {
        for (int i = 0; i < 3; ++i) corner[i] += part.pose.position[i];
      }
      part.triangle = &own;
    } else if (part.part != kWholeShape) {
      const Quaternion turn = normalized(scale_to_unit_max(moving.motion.start.orientation));
      const Eigen::Matrix3d to_world = rotation_of_unit(turn);
      result.arm = to_world * as_eigen(part.pose.position);
      const Quaternion q = turn * normalized(scale_to_unit_max(part.pose.orientation));
      result.motion.start.orientation = q;
    }
    result.shape = tables_.put(slot, part);
    return result;
  }

 private:
  [[nodiscard]] static bool is_unturned(const Pose& pose) noexcept {
    return pose.orientation[0] == 1.0 && pose.orientation[1] == 0.0 && pose.orientation[2] == 0.0 &&
           pose.orientation[3] == 0.0;
  }

  PartTables tables_;
};

}  // namespace winnow::impact
