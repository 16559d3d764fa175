#pragma once

// Plain structs: kernel files include this.

namespace winnow {

/// Where a surface stands, and the matrix that takes the world's vectors into its frame. No
/// coordinate of it is larger than `reach` in that frame, or than `size` in the world's axes.
struct SurfaceFrame {
  double position[3];
  double to_own[3][3];  ///< by columns
  bool is_turned;       ///< false: that changes nothing
  double reach;
  double size;
};

}  // namespace winnow
