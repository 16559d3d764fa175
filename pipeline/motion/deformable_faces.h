#pragma once

#include <winnow/pipeline/deformable_mesh.h>

#include <array>
#include <cstdint>

namespace winnow {

/// The faces of a mesh during its step, as the search for impacts with rigid shapes reads them.
/// After `move`, except for `are_moved`.
struct DeformableMesh::Faces {
  const DeformableMesh& mesh;

  /// True after `move`.
  [[nodiscard]] bool are_moved() const noexcept;
  /// Returns the distance given to `move`.
  [[nodiscard]] double reach() const noexcept;
  /// Writes the corners of a face at the start and the end of the step.
  void place(std::uint32_t face, std::array<Vec3d, 3>& start,
             std::array<Vec3d, 3>& end) const noexcept;
  /// Calls `chunks` with the faces whose boxes overlap a box (relative to the origin), as second
  /// elements of pairs.
  [[nodiscard]] Status find(const Aabb& box, ResultChunks<Pair> chunks) const noexcept;
};

}  // namespace winnow
