#pragma once

#include "bench/scenes/meshes.h"

#include <stdexcept>
#include <string>

namespace winnow::bench {

/// What is wrong with a mesh file.
class MeshFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// True if this was built with the library that reads mesh files.
[[nodiscard]] bool reads_mesh_files() noexcept;

/// All triangles of an OBJ, STL or PLY file; polygons are cut into triangles, equal vertices are
/// made one. Throws MeshFileError.
[[nodiscard]] Triangles read_mesh(const std::string& path);

/// Writes a mesh as the file's extension says: .obj, .stl or .ply. Throws MeshFileError.
void write_mesh(const std::string& path, const Triangles& mesh);

}  // namespace winnow::bench
