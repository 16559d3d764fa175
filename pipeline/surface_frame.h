#pragma once

// The struct is plain, because kernel files include this header.

#include <winnow/core/export.h>

namespace winnow {

/// Frame of a surface (mesh or height field) in the world.
struct SurfaceFrame {
  double position[3];           ///< position of the surface's origin in the world
  double world_to_local[3][3];  ///< columns of the matrix from world vectors to the frame
  bool is_rotated;              ///< false if that matrix is the identity
  double reach;                 ///< upper bound of the surface's coordinates in the frame
  double size;                  ///< upper bound of them in world axes, about the origin
};

}  // namespace winnow
