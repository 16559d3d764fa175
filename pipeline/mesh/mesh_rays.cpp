#include "pipeline/mesh/mesh_rays.h"

#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/accurate_cross.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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

/// The part of [0, limit] in which the ray is in a box. Empty if in > out.
struct BoxPassage {
  double in = 0.0;
  double out;

  BoxPassage(const SurfaceRay& ray, const Vector3d& inverse, const Vector3d& low,
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
/// grown, in units of the nodes; `inverse` is how long, in tau, it takes for one.
void set_axis(MeshRayJob& job, int axis, double from, double inverse, double grow) noexcept {
  if (!(std::abs(inverse) <= 1.0 / kStandingRate)) {
    inverse = std::copysign(kStandingInverse, inverse);
  }
  const bool is_backward = inverse < 0.0;
  const auto lower = static_cast<std::uint32_t>(place_of_bound(0, static_cast<std::size_t>(axis)));
  const auto upper =
      static_cast<std::uint32_t>(place_of_bound(0, static_cast<std::size_t>(axis) + 3));
  job.near_bound[axis] = is_backward ? upper : lower;
  job.far_bound[axis] = is_backward ? lower : upper;
  const double low = (-from - grow) * inverse;
  const double high = (-from + grow) * inverse;
  job.inverse[axis] = static_cast<float>(inverse);
  job.near[axis] = static_cast<float>(is_backward ? high : low);
  job.far[axis] = static_cast<float>(is_backward ? low : high);
}

/// False if the ray passes the mesh by.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Where the ray is in the mesh's box, grown by its
/// slack, that is less than kUnitDoubt and 2^-20 of the slack.
bool set_job(const MeshView& mesh, const SurfaceRay& ray, double limit, MeshRayJob& job) noexcept {
  const Vector3d low = Eigen::Map<const Eigen::Vector3f>(mesh.origin).cast<double>();
  const Vector3d step = Eigen::Map<const Eigen::Vector3f>(mesh.step).cast<double>();
  const Vector3d origin = Vector3d::Map(ray.origin);
  const Vector3d direction = Vector3d::Map(ray.direction);
  const Vector3d inverse = direction.cwiseInverse();
  const BoxPassage passage(ray, inverse, low - step, low + (kMaxNodeBound + 1.0) * step, limit);
  if (!(passage.in <= passage.out)) return false;
  job.entry = passage.in;
  const Vector3d moved = passage.in * direction;
  const Vector3d from = origin + moved;
  const double slack =
      std::min(kMostSlack, ray.slack + 0x1p-51 * (origin.cwiseAbs() + moved.cwiseAbs()).maxCoeff());
  // The ray is not in the box, grown by the slack, for longer.
  const Vector3d extent = (kMaxNodeBound + 1.0) * step + Vector3d::Constant(2.0 * slack);
  const double longest = extent.cwiseProduct(inverse.cwiseAbs()).minCoeff();
  job.pace = 1.0 / longest;
  const Vector3d units = step.cwiseInverse();
  for (int axis = 0; axis < 3; ++axis) {
    job.origin[axis] = from[axis];
    job.direction[axis] = direction[axis] * longest;
    set_axis(job, axis, (from[axis] - low[axis]) * units[axis],
             step[axis] * inverse[axis] * job.pace, kUnitDoubt + 1.001 * slack * units[axis]);
  }
  Eigen::Index fastest = 0;
  direction.cwiseAbs().maxCoeff(&fastest);
  job.fastest = static_cast<std::uint32_t>(fastest);
  for (int k = 0; k < 2; ++k) {
    job.shear[k] = static_cast<float>(direction[(fastest + 1 + k) % 3] * inverse[fastest]);
  }
  job.slack = static_cast<float>(std::min(slack, 1e38));
  return true;
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
  Vector3d normal = accurate_cross(Vector3d::Map(corner[1]) - Vector3d::Map(corner[0]),
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

void mesh_ray(const MeshView& mesh, const SurfaceRay& ray, double limit,
              const SlotVisitor& visitor) noexcept {
  MeshRayJob job;
  if (mesh.triangle_count == 0 || !(limit >= 0.0) || !set_job(mesh, ray, limit, job)) return;
  mesh_kernels().rays(mesh, job, limit, visitor);
}

}  // namespace winnow
