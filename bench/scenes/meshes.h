#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// An indexed triangle mesh: three of `corners` a triangle.
struct Triangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::uint32_t> corners;

  [[nodiscard]] std::size_t size() const noexcept { return corners.size() / 3; }
};

/// A funnel about the z axis, open at both ends: a cone that widens from `outlet` at z = -depth to
/// `radius` at z = 0, and a wall from there to z = wall. Triangles have edges of about `edge`.
struct FunnelSize {
  double radius = 10.0;
  double outlet = 2.0;
  double depth = 8.0;
  double wall = 10.0;
  double edge = 2.0;
};
[[nodiscard]] Triangles make_funnel(const FunnelSize& size);

/// A torus about the z axis of 2 * rings * sides triangles; `tube` is the radius of what is bent
/// into a ring of `radius`.
[[nodiscard]] Triangles make_torus(std::uint32_t rings, std::uint32_t sides, double radius,
                                   double tube);

/// Heights over a square lattice of (cells + 1)^2 points, `edge` apart.
struct Heights {
  std::uint32_t cells = 0;
  double edge = 1.0;
  std::vector<double> height{};  ///< of point (x, y): [y * (cells + 1) + x]

  /// The height of the triangles at a point over the lattice. Cells are cut from (0, 0) to (1, 1).
  [[nodiscard]] double at(double x, double y) const noexcept;
};

/// Hills of four sizes, at most about `relief` high, by value noise (Perlin's lattice of random
/// values, smoothly blended, in octaves).
[[nodiscard]] Heights make_hills(std::uint32_t cells, double edge, double relief,
                                 std::uint64_t seed);
/// Triangles that share no vertices, of all directions and of alike sizes, anywhere in a cube of
/// side 10: as many as there are, they cover as much of a look through it.
[[nodiscard]] Triangles make_soup(std::size_t triangles, std::uint64_t seed);
/// Two triangles a cell, seen from above counter-clockwise.
[[nodiscard]] Triangles make_terrain(const Heights& heights);

}  // namespace winnow::bench
