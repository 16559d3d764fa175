#include "pipeline/mesh/mesh_rays.h"

#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/accurate_cross.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// In the units of the nodes: more than float makes of a bound on its way to tau.
constexpr double kUnitDoubt = 0.05;
/// A ray that moves by fewer units for each tau stands on that axis: its way through the mesh takes
/// it less than kUnitDoubt.
constexpr double kStandingRate = 0.01;
constexpr double kStandingInverse = 1e30;
/// More slack than this leaves all in doubt as well.
constexpr double kMostSlack = 1e200;
constexpr double kMostWrong = 1e38;

/// The part of [0, limit] in which the ray is in a box. Empty if in > out.
struct BoxPassage {
  double in = 0.0;
  double out;

  BoxPassage(const SurfaceRay& ray, const double (&inverse)[3], const Vector3d& low,
             const Vector3d& high, double limit) noexcept
      : out(limit) {
    for (int axis = 0; axis < 3; ++axis) {
      const double near = low[axis] - ray.slack - ray.origin[axis];
      const double far = high[axis] + ray.slack - ray.origin[axis];
      if (ray.direction[axis] == 0.0) {
        if (near > 0.0 || far < 0.0) out = -1.0;
        continue;
      }
      // Zero times infinity, as the second operand of a comparison, narrows nothing.
      const double a = near * inverse[axis];
      const double b = far * inverse[axis];
      in = std::max(in, std::min(a, b) * (1.0 - 0x1p-48));
      out = std::min(out, std::max(a, b) * (1.0 + 0x1p-48));
    }
  }
};

/// How the ray passes bounds on an axis. `from` is where it is, and `grow` by how much boxes are
/// grown, in units of the nodes; `inverse` is how long, in tau, it takes for one. Which way it goes
/// is as hard to foresee as a coin: nothing branches on it.
void set_axis(MeshRayJob& job, std::uint32_t axis, double from, double inverse,
              double grow) noexcept {
  if (!(std::abs(inverse) <= 1.0 / kStandingRate)) {
    inverse = std::copysign(kStandingInverse, inverse);
  }
  const std::size_t upper = std::signbit(inverse) ? 3 : 0;
  job.near_bound[axis] = static_cast<std::uint32_t>(place_of_bound(0, axis + upper));
  job.far_bound[axis] = static_cast<std::uint32_t>(place_of_bound(0, axis + 3 - upper));
  const double forward_grow = std::copysign(grow, inverse);
  job.inverse[axis] = static_cast<float>(inverse);
  job.near[axis] = static_cast<float>((-from - forward_grow) * inverse);
  job.far[axis] = static_cast<float>((-from + forward_grow) * inverse);
}

/// What every ray needs of a mesh.
struct MeshSpan {
  Vector3d low;
  Vector3d step;
  Vector3d units;
  /// Of the box of all nodes, with a step to spare on each side.
  Vector3d least;
  Vector3d most;
  /// The longest side of that box, and tau for each t.
  double extent;
  double pace;
  /// What rounding the coordinates of rays to float makes of corners. Everything is in doubt where
  /// differences of coordinates may leave the range of float.
  double rounding;

  explicit MeshSpan(const MeshView& mesh) noexcept
      : low(Eigen::Map<const Eigen::Vector3f>(mesh.origin).cast<double>()),
        step(Eigen::Map<const Eigen::Vector3f>(mesh.step).cast<double>()),
        units(step.cwiseInverse()),
        least(low - step),
        most(low + (kMaxNodeBound + 1.0) * step),
        extent((most - least).maxCoeff()),
        pace(1.0 / extent),
        rounding(rounding_of(least.cwiseAbs().cwiseMax(most.cwiseAbs()).maxCoeff())) {}

 private:
  static double rounding_of(double farthest) noexcept {
    constexpr double kFarthest = 1e37;
    return farthest < kFarthest ? 0x1p-21 * farthest + 1e-36
                                : std::numeric_limits<double>::infinity();
  }
};

/// False if the ray passes the mesh by.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Where the ray is in the mesh's box, grown by its
/// slack, that is less than kUnitDoubt and 2^-20 of the slack.
bool set_job(const MeshSpan& mesh, const SurfaceRay& ray, double limit, MeshRayJob& job) noexcept {
  const double* const direction = ray.direction;
  const double inverse[3] = {1.0 / direction[0], 1.0 / direction[1], 1.0 / direction[2]};
  const BoxPassage passage(ray, inverse, mesh.least, mesh.most, limit);
  if (!(passage.in <= passage.out)) return false;
  job.limit = limit;
  job.entry = passage.in;
  double farthest = 0.0;
  double from[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const double moved = passage.in * direction[axis];
    farthest = std::max(farthest, std::abs(ray.origin[axis]) + std::abs(moved));
    from[axis] = ray.origin[axis] + moved;
  }
  const double slack = std::min(kMostSlack, ray.slack + 0x1p-51 * farthest);
  // The ray is not in the box, grown by the slack, for longer than twice this.
  double longest = mesh.extent;
  job.pace = mesh.pace;
  if (slack > 0x1p-10 * mesh.extent) {
    longest = mesh.extent + 2.0 * slack;
    job.pace = 1.0 / longest;
  }
  std::uint32_t fastest = 0;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    job.origin[axis] = from[axis];
    job.direction[axis] = direction[axis] * longest;
    set_axis(job, axis, (from[axis] - mesh.low[axis]) * mesh.units[axis],
             mesh.step[axis] * inverse[axis] * job.pace,
             kUnitDoubt + 1.001 * slack * mesh.units[axis]);
    if (std::abs(direction[axis]) > std::abs(direction[fastest])) fastest = axis;
  }
  for (std::uint32_t k = 0; k < 2; ++k) {
    const std::uint32_t axis = (fastest + 1 + k) % 3;
    std::fill_n(job.across[k], 3, 0.0F);
    job.across[k][axis] = 1.0F;
    job.across[k][fastest] = static_cast<float>(-direction[axis] * inverse[fastest]);
  }
  job.wrong = static_cast<float>(std::min(4.0 * slack, kMostWrong) + mesh.rounding);
  return true;
}

/// The product of two edges of a triangle, at right angles to both. Where no more than three bits
/// of the products cancel, they need no more care.
Vector3d normal_of(const Vector3d& a, const Vector3d& b) noexcept {
  const Vector3d plus(a.y() * b.z(), a.z() * b.x(), a.x() * b.y());
  const Vector3d minus(a.z() * b.y(), a.x() * b.z(), a.y() * b.x());
  const Vector3d normal = plus - minus;
  constexpr double kLeastLeft = 0.125;
  const double size = plus.cwiseAbs().sum() + minus.cwiseAbs().sum();
  return normal.cwiseAbs().sum() > kLeastLeft * size ? normal : accurate_cross(a, b);
}

}  // namespace

Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3], double low,
                        double high, SurfaceHit& hit) noexcept {
  const Vector3d origin = Vector3d::Map(ray.origin);
  const Vector3d direction = Vector3d::Map(ray.direction);
  const Vector3d a = Vector3d::Map(corner[0]) - origin;
  const Vector3d b = Vector3d::Map(corner[1]) - origin;
  const Vector3d c = Vector3d::Map(corner[2]) - origin;
  const double far = a.cwiseAbs().sum() + b.cwiseAbs().sum() + c.cwiseAbs().sum();
  const double doubt = direction.cwiseAbs().sum() * far * (0x1p-48 * far + 4.0 * ray.slack);
  const double volume[3] = {direction.dot(c.cross(b)), direction.dot(a.cross(c)),
                            direction.dot(b.cross(a))};
  const double least = std::min({volume[0], volume[1], volume[2]});
  const double greatest = std::max({volume[0], volume[1], volume[2]});
  if (least < -doubt && greatest > doubt) return Crossing::none;
  if (!(least > doubt || greatest < -doubt)) return Crossing::doubtful;
  Vector3d normal = normal_of(Vector3d::Map(corner[1]) - Vector3d::Map(corner[0]),
                              Vector3d::Map(corner[2]) - Vector3d::Map(corner[0]));
  const double rate = normal.dot(direction);
  const double t = normal.dot(a) / rate;
  const double error = normal.cwiseAbs().sum() * (2.0 * ray.slack + 0x1p-48 * far) / std::abs(rate);
  if (t < low - error || t > high + error) return Crossing::none;
  if (!(t > low + error && t < high - error)) return Crossing::doubtful;
  if (rate > 0.0) normal = -normal;
  hit.t = t;
  Vector3d::Map(hit.normal) = normal;
  return Crossing::found;
}

void mesh_rays(const MeshView& mesh, std::span<const SurfaceRay> rays, const double* limits,
               const RaySlotVisitor& visitor) noexcept {
  if (mesh.triangle_count == 0) return;
  const MeshSpan span(mesh);
  MeshRayJob jobs[kRaysAtOnce];
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    if (!(limits[i] >= 0.0) || !set_job(span, rays[i], limits[i], jobs[count])) continue;
    jobs[count++].ray = i;
  }
  mesh_kernels().rays(mesh, jobs, count, visitor);
}

}  // namespace winnow
