// Prepares the traversals of a mesh's tree: converts boxes, balls, hulls and placements into jobs
// with bounds on rounding, and calls the kernels. mesh_below is scalar.

#include "pipeline/mesh/mesh_traversal.h"

#include "pipeline/mesh/mesh_rays.kernel.h"

#include <winnow/core/volumes.h>
#include "pipeline/mesh/mesh_tree.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {

WINNOW_DEFINE_KERNELS(MeshKernels, mesh_kernels)
WINNOW_DEFINE_KERNELS(MeshRayKernels, mesh_ray_kernels)

namespace {

using mid::kInfinity;
// Beyond this, sums of products of coordinates may leave the range of double.
constexpr double kLargestCoordinate = 1e150;
// Beyond this, slack in the scale of a would leave the range of float.
constexpr double kLargestSlack = 1e30;

/// The largest absolute coordinate of the decoded nodes on an axis.
double largest(const MeshView& mesh, std::size_t axis) {
  const double low = static_cast<double>(mesh.origin[axis]);
  return std::max(std::abs(low), std::abs(low + static_cast<double>(kMaxNodeBound) *
                                                    static_cast<double>(mesh.step[axis])));
}

/// 2^-e for the exponent e of the largest coordinate, clamped to normal floats.
float scale_of(const MeshView& mesh) {
  const double size = std::max({largest(mesh, 0), largest(mesh, 1), largest(mesh, 2)});
  const int exponent = size > 0.0 ? std::ilogb(size) : 0;
  return std::ldexp(1.0F, std::clamp(-exponent, -126, 126));
}

MeshPairJob pair_job(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                     const double margin[3]) {
  MeshPairJob job{};
  job.scale = scale_of(a);
  for (std::size_t k = 0; k < 3; ++k) {
    double reach = std::abs(b_in_a.offset[k]) + std::abs(margin[k]);
    for (std::size_t i = 0; i < 3; ++i) reach += std::abs(b_in_a.matrix[k][i]) * largest(b, i);
    // Bounds fewer than ten roundings of sums and products of the terms in `reach`.
    job.slack[k] = margin[k] + reach * 0x1p-48;
    const double scaled = job.slack[k] * static_cast<double>(job.scale);
    if (!(reach < kLargestCoordinate && scaled < kLargestSlack)) {
      job.slack[k] = kInfinity;
      job.scaled_slack[k] = std::numeric_limits<float>::infinity();
      continue;
    }
    // Adding 2^-100 of a's size covers a slack that underflows.
    job.scaled_slack[k] = round_up(scaled + 0x1p-100);
    std::copy_n(b_in_a.matrix[k], 3, job.matrix[k]);
    job.offset[k] = b_in_a.offset[k];
  }
  return job;
}

MeshBoxJob box_job(const MeshView& mesh, const double min[3], const double max[3]) {
  MeshBoxJob job{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    job.node_low[axis] = static_cast<float>(mesh_units(mesh, axis, min[axis]));
    job.node_high[axis] = static_cast<float>(mesh_units(mesh, axis, max[axis]));
    job.low[axis] = round_up(min[axis]);
    job.high[axis] = round_down(max[axis]);
  }
  return job;
}

/// Returns false for balls so large, so small or so far away that floats cannot exclude triangles.
bool set_ball(const double center[3], double radius, MeshBallJob& ball) {
  constexpr double kFar = 1e30;
  if (!(radius >= 1e-30 && radius < kFar)) return false;
  ball.scale = std::ldexp(1.0F, -std::ilogb(radius));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(std::abs(center[axis]) < kFar)) return false;
    ball.center[axis] = static_cast<float>(center[axis]);
    ball.largest = std::max(ball.largest, std::abs(ball.center[axis]) * ball.scale);
  }
  ball.radius = round_up(radius * static_cast<double>(ball.scale));
  return true;
}

/// Returns false for hulls for which the precision of doubles, or of the kernels' floats, is too
/// low to separate triangles.
bool set_hull(const MeshHull& hull, const double center[3], MeshHullJob& job) {
  constexpr double kFar = 1e30;
  // In units of the radius.
  constexpr double kFarFromOrigin = 1e3;
  constexpr double kFarFromMesh = 1e7;
  const HullShape& shape = hull.shape;
  if (!(shape.radius > 1.0 / kFar && shape.radius < kFar)) return false;
  const double scale = std::ldexp(1.0, -std::ilogb(shape.radius));
  double middle = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    middle = std::max(middle, std::abs(shape.center[i]));
    if (!(std::abs(center[i]) < kFar && middle < kFarFromOrigin * shape.radius)) return false;
    job.middle[i] = static_cast<float>(center[i]);
    job.center[i] = static_cast<float>(shape.center[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    double offset = hull.mesh_in_hull.offset[i] - static_cast<double>(job.center[i]);
    double size = std::abs(offset);
    for (std::size_t k = 0; k < 3; ++k) {
      const double by = hull.mesh_in_hull.matrix[i][k];
      const double at = by * static_cast<double>(job.middle[k]);
      if (!(std::abs(by * scale) < kFar)) return false;
      offset += at;
      size += std::abs(at);
      job.matrix[i][k] = static_cast<float>(by * scale);
    }
    if (!(size < kFarFromMesh * shape.radius)) return false;
    job.offset[i] = static_cast<float>(offset * scale);
  }
  job.scale = static_cast<float>(scale);
  job.reach = round_up(hull.reach * scale);
  job.largest = round_up((middle + shape.radius) * scale);
  job.shape = &shape;
  return true;
}

/// Tests whether nodes reach below a plane.
struct HalfSpaceTest {
  const MeshView& mesh;
  const double* normal;
  double offset;
  double noise;

  /// Compares the minimum of normal . x over a node's box.
  [[nodiscard]] bool reaches(std::uint32_t level, std::uint32_t node) const noexcept {
    double least = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t bound = normal[axis] < 0.0 ? axis + 3 : axis;
      const double q = bound_of(mesh, level, node, bound);
      least += normal[axis] *
               (static_cast<double>(mesh.origin[axis]) + q * static_cast<double>(mesh.step[axis]));
    }
    return !(least > offset + noise);
  }
};

}  // namespace

void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  SlotSink& out) noexcept {
  if (mesh.triangle_count == 0) return;
  mesh_kernels().overlap(mesh, box_job(mesh, min, max), out);
}

void mesh_overlap(const MeshView& mesh, const double min[3], const double max[3],
                  const double center[3], double radius, const MeshHull* hull,
                  SlotSink& out) noexcept {
  if (mesh.triangle_count == 0) return;
  MeshBoxJob job = box_job(mesh, min, max);
  const bool has_hull = hull != nullptr && set_hull(*hull, center, job.hull);
  job.has_ball = !has_hull && set_ball(center, radius, job.ball);
  mesh_kernels().overlap(mesh, job, out);
}

void mesh_below(const MeshView& mesh, const double normal[3], double offset,
                SlotSink& out) noexcept {
  double noise = std::abs(offset);
  for (int axis = 0; axis < 3; ++axis) {
    const double step =
        static_cast<double>(kMaxNodeBound + 1) * static_cast<double>(mesh.step[axis]);
    noise += std::abs(normal[axis]) * (std::abs(static_cast<double>(mesh.origin[axis])) + step);
  }
  const HalfSpaceTest test{mesh, normal, offset, mid::kSlack * noise};
  // Children are pushed last to first, so that slots come out ascending.
  std::uint32_t level_of[kMaxMeshLevels * kMeshFanout];
  std::uint32_t stack[kMaxMeshLevels * kMeshFanout];
  std::uint32_t depth = 0;
  const auto push = [&](std::uint32_t level, std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t node = end; node-- > first;) {
      if (!test.reaches(level, node)) continue;
      level_of[depth] = level;
      stack[depth++] = node;
    }
  };
  if (mesh.levels == 0) return;
  push(mesh.levels - 1, 0, mesh.count[mesh.levels - 1]);
  while (depth != 0) {
    const std::uint32_t level = level_of[--depth];
    const std::uint32_t first = stack[depth] * kMeshFanout;
    if (level != 0) {
      push(level - 1, first, std::min(first + kMeshFanout, mesh.count[level - 1]));
      continue;
    }
    const std::uint32_t end = std::min(first + kMeshFanout, mesh.triangle_count);
    for (std::uint32_t slot = first; slot < end; ++slot) {
      put_slot(out, slot);
    }
  }
}

void mesh_overlap_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                        const double margin[3], SlotPairSink& out) noexcept {
  if (a.triangle_count == 0 || b.triangle_count == 0) return;
  mesh_kernels().pairs(a, b, pair_job(a, b, b_in_a, margin), out);
}

void mesh_near_pairs(const MeshView& a, const MeshView& b, const MeshPlacement& b_in_a,
                     const double error_bound[3], double limit,
                     const SlotPairVisitor& visitor) noexcept {
  if (a.triangle_count == 0 || b.triangle_count == 0 || !(limit >= 0.0)) return;
  mesh_kernels().near_pairs(a, b, pair_job(a, b, b_in_a, error_bound), limit, visitor);
}

void mesh_cast(const MeshView& mesh, const double min[3], const double max[3],
               const double direction[3], double limit, const SlotVisitor& visitor) noexcept {
  if (mesh.triangle_count == 0 || !(limit >= 0.0)) return;
  MeshCastJob job{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    job.min[axis] = min[axis];
    job.max[axis] = max[axis];
    job.inverse[axis] = 1.0 / direction[axis];
    job.direction[axis] = direction[axis];
    job.is_static[axis] = !std::isfinite(job.inverse[axis]);
    if (direction[axis] == 0.0 || !job.is_static[axis]) continue;
    const double shift = direction[axis] * limit;
    (shift < 0.0 ? job.min : job.max)[axis] += shift;
  }
  mesh_kernels().cast(mesh, job, limit, visitor);
}

void mesh_near(const MeshView& mesh, const double scale[3], const double min[3],
               const double max[3], double limit, const SlotVisitor& visitor) noexcept {
  if (mesh.triangle_count == 0 || !(limit >= 0.0)) return;
  MeshNearJob job;
  std::copy_n(min, 3, job.min);
  std::copy_n(max, 3, job.max);
  std::copy_n(scale, 3, job.scale);
  mesh_kernels().near(mesh, job, limit, visitor);
}

}  // namespace winnow
