#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow::bench {

/// An indexed triangle mesh: three entries of `corners` for each triangle.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] std::size_t size() const noexcept { return corners.size() / 3; }
  // As arguments of winnow's functions.
  [[nodiscard]] std::span<const Eigen::Vector3d> points() const noexcept { return vertices; }
  [[nodiscard]] std::span<const std::uint32_t> indices() const noexcept { return corners; }
};

/// A funnel about the z axis, open at both ends: a cone that widens from `outlet` at z = -depth to
/// `radius` at z = 0, and a cylindrical wall from there to z = wall. Triangles have edges of about
/// `edge`.
struct FunnelSize {
  double radius = 10.0;
  double outlet = 2.0;
  double depth = 8.0;
  double wall = 10.0;
  double edge = 2.0;
};
[[nodiscard]] Triangles make_funnel(const FunnelSize& size);

/// Returns a torus about the z axis with 2 * rings * sides triangles, major radius `radius` and
/// minor radius `tube`.
[[nodiscard]] Triangles make_torus(std::uint32_t rings, std::uint32_t sides, double radius,
                                   double tube);

/// Heights over a square lattice of (cells + 1)^2 points with spacing `edge`.
struct Heights {
  std::uint32_t cells = 0;
  double edge = 1.0;
  std::vector<double> height{};  ///< height of point (x, y) at [y * (cells + 1) + x]

  /// Returns the height of the triangulated surface at a point. Each cell is split along its
  /// diagonal from (0, 0) to (1, 1).
  [[nodiscard]] double at(double x, double y) const noexcept;
};

/// Returns hills of four sizes with heights up to about `relief`: value noise (random values on a
/// lattice, smoothly interpolated, in octaves).
[[nodiscard]] Heights make_hills(std::uint32_t cells, double edge, double relief,
                                 std::uint64_t seed);
/// Returns separate triangles of random orientations and similar sizes in a cube of side 10. Their
/// size depends on their number, so that they always cover the same share of a view.
[[nodiscard]] Triangles make_soup(std::size_t triangles, std::uint64_t seed);
/// Returns two triangles for each cell, counter-clockwise seen from above.
[[nodiscard]] Triangles make_terrain(const Heights& heights);

}  // namespace winnow::bench
