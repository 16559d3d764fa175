#include "bench/simulation/mesh_files.h"

#if WINNOW_HAVE_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace winnow::bench {

#if WINNOW_HAVE_ASSIMP

namespace {

void append(const aiMesh& part, Triangles& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& v = part.mVertices[i];
    mesh.vertices.emplace_back(static_cast<double>(v.x), static_cast<double>(v.y),
                               static_cast<double>(v.z));
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    for (unsigned k = 0; k < 3; ++k) mesh.corners.push_back(first + face.mIndices[k]);
  }
}

}  // namespace

bool reads_mesh_files() noexcept {
  return true;
}

Triangles read_mesh(const std::string& path) {
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                  aiProcess_DropNormals | aiProcess_PreTransformVertices);
  if (scene == nullptr) throw MeshFileError(path + ": " + importer.GetErrorString());
  Triangles mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) append(*scene->mMeshes[i], mesh);
  if (mesh.corners.empty()) throw MeshFileError(path + ": there are no triangles in it");
  return mesh;
}

#else

bool reads_mesh_files() noexcept {
  return false;
}

Triangles read_mesh(const std::string& path) {
  throw MeshFileError(path +
                      ": mesh files need assimp, which this was built without. On Debian:\n"
                      "  apt-get install -y libassimp-dev");
}

#endif

}  // namespace winnow::bench
