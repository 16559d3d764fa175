#pragma once

#include <winnow/pipeline/surfaces.h>
#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::test {

/// A triangle mesh in the layout of a caller: three corners per triangle, one triangle after
/// another.
struct MeshData {
  std::string name;
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] std::size_t triangles() const { return corners.size() / 3; }
  [[nodiscard]] PointView points() const { return {std::span<const Eigen::Vector3f>(vertices)}; }
  [[nodiscard]] IndexView indices() const { return {std::span<const std::uint32_t>(corners)}; }
  [[nodiscard]] Status build(TriangleMesh& mesh, const MeshOptions& options = {}) const {
    return mesh.build(points(), indices(), options);
  }
};

/// A torus around the z axis with radii 1 and 0.3: closed, wound outward.
[[nodiscard]] MeshData torus(std::uint32_t rings, std::uint32_t sides);
/// Hills over [0, cells] x [0, cells], z up: 2 cells^2 triangles.
[[nodiscard]] MeshData terrain(std::uint32_t cells);
/// A toothed wheel around the z axis: closed, sharp edges, long thin triangles.
[[nodiscard]] MeshData gear(std::uint32_t teeth);
/// Two wavy sheets a thousandth apart, whose triangles share no vertex index.
[[nodiscard]] MeshData thin_sheets(std::uint32_t cells);
/// The terrain with a few separate triangles among the hills, which give some leaves more than
/// sixteen vertices.
[[nodiscard]] MeshData littered_terrain(std::uint32_t cells);
/// Triangles of any size anywhere, including points, segments, duplicates and edges of many
/// triangles.
[[nodiscard]] MeshData degenerate_soup(std::uint32_t triangles, std::uint64_t stream);

/// One of each.
[[nodiscard]] std::vector<MeshData> sample_meshes();

}  // namespace winnow::test
