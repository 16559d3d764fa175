#include "bench/simulation/mesh_files.h"

#include <algorithm>

#if WINNOW_HAVE_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <memory>

namespace winnow::bench {
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

/// Returns the scene that assimp's exporter requires: one mesh under one node.
std::unique_ptr<aiScene> scene_of(const Triangles& mesh) {
  auto scene = std::make_unique<aiScene>();
  scene->mRootNode = new aiNode;
  scene->mRootNode->mNumMeshes = 1;
  scene->mRootNode->mMeshes = new unsigned[1]{0};
  scene->mNumMaterials = 1;
  scene->mMaterials = new aiMaterial* [1] { new aiMaterial };
  auto* part = new aiMesh;
  scene->mNumMeshes = 1;
  scene->mMeshes = new aiMesh* [1] { part };
  part->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  part->mNumVertices = static_cast<unsigned>(mesh.vertices.size());
  part->mVertices = new aiVector3D[mesh.vertices.size()];
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f v = mesh.vertices[i].cast<float>();
    part->mVertices[i] = {v.x(), v.y(), v.z()};
  }
  part->mNumFaces = static_cast<unsigned>(mesh.size());
  part->mFaces = new aiFace[mesh.size()];
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    aiFace& face = part->mFaces[i];
    face.mNumIndices = 3;
    face.mIndices =
        new unsigned[3]{mesh.corners[3 * i], mesh.corners[3 * i + 1], mesh.corners[3 * i + 2]};
  }
  return scene;
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

void write_mesh(const std::string& path, const Triangles& mesh) {
  const std::string format = path.substr(std::min(path.size(), path.rfind('.') + 1));
  Assimp::Exporter exporter;
  if (exporter.Export(scene_of(mesh).get(), format, path) != aiReturn_SUCCESS) {
    throw MeshFileError(path + ": " + exporter.GetErrorString());
  }
}

}  // namespace winnow::bench
#else
namespace winnow::bench {
namespace {

[[noreturn]] void refuse(const std::string& path) {
  throw MeshFileError(path +
                      ": mesh files need assimp, which this was built without. On Debian:\n"
                      "  apt-get install -y libassimp-dev");
}

}  // namespace

bool reads_mesh_files() noexcept {
  return false;
}

Triangles read_mesh(const std::string& path) {
  refuse(path);
}

void write_mesh(const std::string& path, const Triangles&) {
  refuse(path);
}

}  // namespace winnow::bench
#endif
