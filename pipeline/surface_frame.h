#pragma once

// Plain structs, because kernel files include this.

#include <winnow/core/export.h>

namespace winnow {

/// Frame of a surface (mesh or height field) in the world.
struct SurfaceFrame {
  double position[3];           ///< position of its origin in the world
  double world_to_local[3][3];  ///< columns of the matrix from world vectors to the frame
  bool is_rotated;              ///< false if that matrix is the identity
  double reach;                 ///< upper bound of its coordinates in the frame
  double size;                  ///< upper bound of its coordinates in world axes, about its origin
};

}  // namespace winnow
