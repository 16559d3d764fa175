#pragma once

#include "bench/scenes/meshes.h"

#include <stdexcept>
#include <string>

namespace winnow::bench {

/// The message states what is wrong with a mesh file.
class MeshFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns whether the tool was built with the library that reads mesh files.
[[nodiscard]] bool reads_mesh_files() noexcept;

/// Reads all triangles of an OBJ, STL or PLY file. Splits polygons into triangles and merges equal
/// vertices. Throws MeshFileError.
[[nodiscard]] Triangles read_mesh(const std::string& path);

}  // namespace winnow::bench
