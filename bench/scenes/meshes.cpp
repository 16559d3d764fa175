// Generates triangle meshes for scenes: funnel, torus, hills, terrain and random triangles.
// Vertices are rounded to float, because other libraries store floats.

#include "bench/scenes/meshes.h"

#include "bench/common/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace winnow::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Rounds to float, as libraries store vertices, so that all get the same triangles.
double as_float(double value) {
  return static_cast<double>(static_cast<float>(value));
}

std::uint32_t steps_over(double length, double edge) {
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / edge)));
}

/// Adds two triangles between each two neighbours of two closed rows of points. `next` is the first
/// point of the second row.
void stitch(std::vector<std::uint32_t>& corners, std::uint32_t first, std::uint32_t next,
            std::uint32_t points) {
  for (std::uint32_t i = 0; i < points; ++i) {
    const std::uint32_t j = (i + 1) % points;
    corners.insert(corners.end(), {first + i, first + j, next + j, first + i, next + j, next + i});
  }
}

double random_at(std::uint64_t x, std::uint64_t y, std::uint64_t seed) {
  return static_cast<double>(mix(mix(x * 0x10001ULL + seed) + y) >> 11U) * 0x1p-53;
}

/// Returns value noise: random values at integer points, smoothly interpolated.
double noise(double x, double y, std::uint64_t seed) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::uint64_t>(fx);
  const auto iy = static_cast<std::uint64_t>(fy);
  const auto blend = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = blend(x - fx);
  const double v = blend(y - fy);
  const double low = std::lerp(random_at(ix, iy, seed), random_at(ix + 1, iy, seed), u);
  const double high = std::lerp(random_at(ix, iy + 1, seed), random_at(ix + 1, iy + 1, seed), u);
  return std::lerp(low, high, v);
}

}  // namespace

Triangles make_funnel(const FunnelSize& size) {
  Triangles mesh;
  const auto around = std::max(16U, steps_over(kTurn * size.radius, size.edge));
  const auto ring = [&](double radius, double z) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = kTurn * i / around;
      mesh.vertices.emplace_back(as_float(radius * std::cos(angle)),
                                 as_float(radius * std::sin(angle)), as_float(z));
    }
  };
  const double slope = std::hypot(size.radius - size.outlet, size.depth);
  const std::uint32_t cone = steps_over(slope, size.edge);
  for (std::uint32_t i = 0; i <= cone; ++i) {
    const double t = static_cast<double>(i) / cone;
    ring(std::lerp(size.outlet, size.radius, t), std::lerp(-size.depth, 0.0, t));
  }
  const std::uint32_t wall = steps_over(size.wall, size.edge);
  for (std::uint32_t i = 1; i <= wall; ++i) ring(size.radius, size.wall * i / wall);
  for (std::uint32_t i = 0; i < cone + wall; ++i) {
    stitch(mesh.corners, i * around, (i + 1) * around, around);
  }
  return mesh;
}

Triangles make_torus(std::uint32_t rings, std::uint32_t sides, double radius, double tube) {
  Triangles mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    const double around = kTurn * i / rings;
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double along = kTurn * k / sides;
      const double out = radius + tube * std::cos(along);
      mesh.vertices.emplace_back(as_float(out * std::cos(around)), as_float(out * std::sin(around)),
                                 as_float(tube * std::sin(along)));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    stitch(mesh.corners, (i + 1) % rings * sides, i * sides, sides);
  }
  return mesh;
}

double Heights::at(double x, double y) const noexcept {
  const double most = cells - 1;
  const double cx = std::clamp(std::floor(x / edge), 0.0, most);
  const double cy = std::clamp(std::floor(y / edge), 0.0, most);
  const double u = x / edge - cx;
  const double v = y / edge - cy;
  const std::size_t row = cells + 1;
  const std::size_t i = static_cast<std::size_t>(cy) * row + static_cast<std::size_t>(cx);
  const double start = height[i];
  const double end = height[i + row + 1];
  if (u >= v) {
    const double turn = height[i + 1];
    return start + u * (turn - start) + v * (end - turn);
  }
  const double turn = height[i + row];
  return start + v * (turn - start) + u * (end - turn);
}

Heights make_hills(std::uint32_t cells, double edge, double relief, std::uint64_t seed) {
  Heights hills{.cells = cells, .edge = edge};
  hills.height.reserve(static_cast<std::size_t>(cells + 1) * (cells + 1));
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      double height = 0.0;
      double share = 0.5;
      double size = 64.0;
      for (std::uint64_t octave = 0; octave < 4; ++octave, share *= 0.4, size *= 0.5) {
        height += share * noise(x / size, y / size, seed + octave);
      }
      hills.height.push_back(as_float(relief * height));
    }
  }
  return hills;
}

Triangles make_soup(std::size_t triangles, std::uint64_t seed) {
  Random random(seed);
  const double size = 4.6 / std::cbrt(static_cast<double>(triangles));
  Triangles mesh;
  for (std::size_t i = 0; i < triangles; ++i) {
    const Eigen::Vector3d middle(random.in(-5, 5), random.in(-5, 5), random.in(-5, 5));
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d corner = middle;
      for (double& x : corner) x = as_float(x + random.in(-size, size));
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back(corner);
    }
  }
  return mesh;
}

Triangles make_terrain(const Heights& heights) {
  Triangles mesh;
  const std::uint32_t row = heights.cells + 1;
  for (std::uint32_t y = 0; y < row; ++y) {
    for (std::uint32_t x = 0; x < row; ++x) {
      mesh.vertices.emplace_back(as_float(heights.edge * x), as_float(heights.edge * y),
                                 heights.height[static_cast<std::size_t>(y) * row + x]);
    }
  }
  for (std::uint32_t y = 0; y < heights.cells; ++y) {
    for (std::uint32_t x = 0; x < heights.cells; ++x) {
      const std::uint32_t i = y * row + x;
      mesh.corners.insert(mesh.corners.end(), {i, i + 1, i + row + 1, i, i + row + 1, i + row});
    }
  }
  return mesh;
}

}  // namespace winnow::bench
