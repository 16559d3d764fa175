#include "tests/support/meshes.h"

#include <cmath>
#include <numbers>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

Eigen::Vector3f point(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

void add_triangle(MeshData& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.corners.insert(mesh.corners.end(), {a, b, c});
}
void add_square(MeshData& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                std::uint32_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

}  // namespace

MeshData torus(std::uint32_t rings, std::uint32_t sides) {
  MeshData mesh{"torus", {}, {}};
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double a = kTurn * i / rings;
      const double b = kTurn * j / sides;
      const double r = 1.0 + 0.3 * std::cos(b);
      mesh.vertices.push_back(point(r * std::cos(a), r * std::sin(a), 0.3 * std::sin(b)));
      const auto at = [&](std::uint32_t ring, std::uint32_t side) {
        return ring % rings * sides + side % sides;
      };
      add_square(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

MeshData terrain(std::uint32_t cells) {
  MeshData mesh{"terrain", {}, {}};
  for (std::uint32_t row = 0; row <= cells; ++row) {
    for (std::uint32_t column = 0; column <= cells; ++column) {
      mesh.vertices.push_back(
          point(column, row, 2.0 * std::sin(0.3 * column) * std::cos(0.2 * row)));
      if (row == cells || column == cells) continue;
      const std::uint32_t corner = row * (cells + 1) + column;
      add_square(mesh, corner, corner + 1, corner + cells + 2, corner + cells + 1);
    }
  }
  return mesh;
}

MeshData gear(std::uint32_t teeth) {
  MeshData mesh{"gear", {}, {}};
  const std::uint32_t rim = 4 * teeth;
  for (const double z : {-0.2, 0.2}) {
    for (std::uint32_t i = 0; i < rim; ++i) {
      const double r = i % 4 < 2 ? 1.0 : 1.25;
      mesh.vertices.push_back(
          point(r * std::cos(kTurn * i / rim), r * std::sin(kTurn * i / rim), z));
    }
  }
  const std::uint32_t hub = 2 * rim;
  mesh.vertices.push_back(point(0, 0, -0.2));
  mesh.vertices.push_back(point(0, 0, 0.2));
  for (std::uint32_t i = 0; i < rim; ++i) {
    const std::uint32_t next = (i + 1) % rim;
    add_square(mesh, i, next, rim + next, rim + i);
    add_triangle(mesh, hub, next, i);
    add_triangle(mesh, hub + 1, rim + i, rim + next);
  }
  return mesh;
}

MeshData thin_sheets(std::uint32_t cells) {
  MeshData mesh{"thin_sheets", {}, {}};
  const double n = cells;
  for (const double lift : {0.0, 0.001}) {
    for (std::uint32_t i = 0; i < cells * cells; ++i) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const auto& [u, v] : {std::pair{0U, 0U}, {1U, 0U}, {1U, 1U}, {0U, 1U}}) {
        const double x = (i % cells + u) / n;
        const double y = (i / cells + v) / n;
        mesh.vertices.push_back(point(x, y, 0.05 * std::sin(9.0 * x + 4.0 * y) + lift));
      }
      add_square(mesh, first, first + 1, first + 2, first + 3);
    }
  }
  return mesh;
}

MeshData degenerate_soup(std::uint32_t triangles, std::uint64_t stream) {
  MeshData mesh{"degenerate_soup", {}, {}};
  Random random(stream);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const double size = random.log_uniform(1e-4, 0.5);
    const Eigen::Vector3d center(random.uniform(-1, 1), random.uniform(-1, 1),
                                 random.uniform(-1, 1));
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(point(center.x() + size * random.uniform(-1, 1),
                                    center.y() + size * random.uniform(-1, 1),
                                    center.z() + size * random.uniform(-1, 1)));
    }
    std::uint32_t corner[3] = {3 * i, 3 * i + 1, 3 * i + 2};
    if (random.chance(0.1)) corner[1] = corner[0];
    if (random.chance(0.1)) corner[2] = corner[1];
    if (random.chance(0.1)) mesh.vertices[corner[2]] = mesh.vertices[corner[0]];
    if (random.chance(0.2) && i > 3) corner[0] = static_cast<std::uint32_t>(random.below(3 * i));
    add_triangle(mesh, corner[0], corner[1], corner[2]);
    if (random.chance(0.1)) add_triangle(mesh, corner[0], corner[2], corner[1]);
  }
  return mesh;
}

MeshData littered_terrain(std::uint32_t cells) {
  MeshData mesh = terrain(cells);
  mesh.name = "littered terrain";
  const std::size_t step = mesh.vertices.size() / 5;
  for (std::size_t i = step / 2; i < 5 * step; i += step) {
    const Eigen::Vector3f at = mesh.vertices[i] + Eigen::Vector3f(0.3F, 0.3F, 0.1F);
    for (const Eigen::Vector3f& corner :
         {Eigen::Vector3f(0.0F, 0.0F, 0.0F), Eigen::Vector3f(0.2F, 0.0F, 0.1F),
          Eigen::Vector3f(0.0F, 0.2F, 0.0F)}) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.emplace_back(at + corner);
    }
  }
  return mesh;
}

std::vector<MeshData> sample_meshes() {
  return {torus(24, 12),   terrain(16),          gear(9),
          thin_sheets(10), littered_terrain(16), degenerate_soup(300, 5)};
}

}  // namespace winnow::test
