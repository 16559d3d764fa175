#pragma once

// Plain structs: kernel files include this.

#include <winnow/core/export.h>

namespace winnow {

/// Where a surface stands.
struct SurfaceFrame {
  double position[3];   ///< of its own origin, in the world
  double to_own[3][3];  ///< columns of the matrix that takes the world's vectors into its frame
  bool is_turned;       ///< false: that changes nothing
  double reach;         ///< no coordinate of it is larger in its frame
  double size;          ///< nor in the world's axes, about its origin
};

}  // namespace winnow
