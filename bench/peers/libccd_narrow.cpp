// Adapter of libccd: support functions for winnow's shapes, and its GJK with EPA and its MPR on
// them. peers.cpp makes it through adapters.h.

#include "bench/peers/adapters.h"
#include "bench/peers/narrow_adapter.h"
#include "bench/scenes/lens.h"

#include <ccd/ccd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace winnow::bench {
namespace {

/// A body, as the support functions read it.
struct CcdBody {
  double turn[9];  // rotation, by columns
  double position[3];
  double size[3];  // half lengths of a box; radii and half length of round shapes
  const Lens* lens;
  const double* vertex[3];  // columns of coordinates
  std::uint32_t vertices;
};

void to_local(const CcdBody& body, const ccd_vec3_t& world, double (&local)[3]) {
  for (int i = 0; i < 3; ++i) {
    const double* column = body.turn + 3 * i;
    local[i] = column[0] * world.v[0] + column[1] * world.v[1] + column[2] * world.v[2];
  }
}

void to_world(const CcdBody& body, const double (&local)[3], ccd_vec3_t& world) {
  for (int i = 0; i < 3; ++i) {
    world.v[i] = body.position[i] + body.turn[i] * local[0] + body.turn[3 + i] * local[1] +
                 body.turn[6 + i] * local[2];
  }
}

double length_of(const ccd_vec3_t& v) {
  return std::sqrt(v.v[0] * v.v[0] + v.v[1] * v.v[1] + v.v[2] * v.v[2]);
}

void add_radius(const ccd_vec3_t& direction, double radius, ccd_vec3_t& point) {
  const double factor = radius / length_of(direction);
  for (int i = 0; i < 3; ++i) point.v[i] += factor * direction.v[i];
}

// Support functions: the support point of a body in a direction of any length, both in world
// coordinates.

void of_sphere(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  std::copy_n(body.position, 3, point->v);
  add_radius(*direction, body.size[0], *point);
}

void of_capsule(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  const double* axis = body.turn + 6;
  const double along =
      axis[0] * direction->v[0] + axis[1] * direction->v[1] + axis[2] * direction->v[2];
  const double h = along < 0.0 ? -body.size[1] : body.size[1];
  for (int i = 0; i < 3; ++i) point->v[i] = body.position[i] + h * axis[i];
  add_radius(*direction, body.size[0], *point);
}

void of_taper(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  const double* axis = body.turn + 6;
  const double along =
      axis[0] * direction->v[0] + axis[1] * direction->v[1] + axis[2] * direction->v[2];
  const double rise = (body.size[0] - body.size[1]) * length_of(*direction);
  const bool low = rise > 2.0 * body.size[2] * along;
  const double h = low ? -body.size[2] : body.size[2];
  for (int i = 0; i < 3; ++i) point->v[i] = body.position[i] + h * axis[i];
  add_radius(*direction, body.size[low ? 0 : 1], *point);
}

void of_box(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  to_local(body, *direction, local);
  for (int i = 0; i < 3; ++i) local[i] = std::copysign(body.size[i], local[i]);
  to_world(body, local, *point);
}

void of_cylinder(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  to_local(body, *direction, local);
  const double across = std::hypot(local[0], local[1]);
  const double reach = across > 0.0 ? body.size[0] / across : 0.0;
  const double at[3] = {reach * local[0], reach * local[1], std::copysign(body.size[1], local[2])};
  to_world(body, at, *point);
}

void of_cone(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  to_local(body, *direction, local);
  const double across = std::hypot(local[0], local[1]);
  const double reach = across > 0.0 ? body.size[0] / across : 0.0;
  const bool apex = 2.0 * body.size[1] * local[2] > body.size[0] * across;
  const double at[3] = {apex ? 0.0 : reach * local[0], apex ? 0.0 : reach * local[1],
                        apex ? body.size[1] : -body.size[1]};
  to_world(body, at, *point);
}

void of_ellipsoid(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  to_local(body, *direction, local);
  for (int i = 0; i < 3; ++i) local[i] *= body.size[i];
  const double length = std::hypot(local[0], local[1], local[2]);
  for (int i = 0; i < 3; ++i) local[i] *= length > 0.0 ? body.size[i] / length : 0.0;
  to_world(body, local, *point);
}

void of_lens(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  double at[3];
  to_local(body, *direction, local);
  farthest_of_lens(*body.lens, local, at);
  to_world(body, at, *point);
}

void of_points(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = *static_cast<const CcdBody*>(object);
  double local[3];
  to_local(body, *direction, local);
  std::uint32_t best = 0;
  double most = -HUGE_VAL;
  for (std::uint32_t i = 0; i < body.vertices; ++i) {
    const double along =
        body.vertex[0][i] * local[0] + body.vertex[1][i] * local[1] + body.vertex[2][i] * local[2];
    if (along > most) {
      most = along;
      best = i;
    }
  }
  const double at[3] = {body.vertex[0][best], body.vertex[1][best], body.vertex[2][best]};
  to_world(body, at, *point);
}

/// Returns the position of the body: all shapes in the race contain the origin of their frame.
void center_of(const void* object, ccd_vec3_t* center) {
  std::copy_n(static_cast<const CcdBody*>(object)->position, 3, center->v);
}

ccd_support_fn support_of(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::sphere:
      return of_sphere;
    case ShapeKind::capsule:
      return of_capsule;
    case ShapeKind::box:
      return of_box;
    case ShapeKind::cylinder:
      return of_cylinder;
    case ShapeKind::cone:
      return of_cone;
    case ShapeKind::ellipsoid:
      return of_ellipsoid;
    case ShapeKind::tapered_capsule:
      return of_taper;
    case ShapeKind::support:
      return of_lens;
    default:
      return of_points;
  }
}

/// `corners` must have room for nine more values, which a triangle uses.
CcdBody make_body(const ShapeTables& tables, ShapeId id, const Pose& pose,
                  std::vector<double>& corners) {
  CcdBody body{};
  Eigen::Map<Eigen::Matrix3d>(body.turn) = orientation_of(pose).toRotationMatrix();
  std::copy_n(pose.position, 3, body.position);
  switch (id.kind()) {
    case ShapeKind::sphere:
      body.size[0] = tables.spheres[id.index()].radius;
      break;
    case ShapeKind::capsule:
      body.size[0] = tables.capsules[id.index()].radius;
      body.size[1] = tables.capsules[id.index()].half_length;
      break;
    case ShapeKind::box:
      std::copy_n(tables.boxes[id.index()].half, 3, body.size);
      break;
    case ShapeKind::ellipsoid:
      std::copy_n(tables.ellipsoids[id.index()].radius, 3, body.size);
      break;
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape& taper = tables.tapered_capsules[id.index()];
      std::copy_n(taper.radius, 2, body.size);
      body.size[2] = taper.half_length;
      break;
    }
    case ShapeKind::support:
      body.lens = static_cast<const Lens*>(tables.supports[id.index()].context);
      break;
    case ShapeKind::cylinder:
      body.size[0] = tables.cylinders[id.index()].radius;
      body.size[1] = tables.cylinders[id.index()].half_length;
      break;
    case ShapeKind::cone:
      body.size[0] = tables.cones[id.index()].radius;
      body.size[1] = tables.cones[id.index()].half_length;
      break;
    case ShapeKind::triangle:
      for (int axis = 0; axis < 3; ++axis) {
        for (const auto& vertex : tables.triangles[id.index()].vertex) {
          corners.push_back(vertex[axis]);
        }
        body.vertex[axis] = &corners.back() - 2;
      }
      body.vertices = 3;
      break;
    case ShapeKind::hull:
      std::copy_n(tables.hulls[id.index()].vertex, 3, body.vertex);
      body.vertices = tables.hulls[id.index()].vertex_count;
      break;
    default:
      break;
  }
  return body;
}

/// libccd in double with support functions defined here. It computes verdicts and, for overlapping
/// pairs, one contact, by GJK and EPA or by MPR; it computes no distances of separate pairs.
/// Tolerances are the defaults; the number of iterations is bounded, so that it terminates.
class LibccdNarrow final : public NarrowAdapter<LibccdNarrow> {
 public:
  explicit LibccdNarrow(bool portals) : portals_(portals) {
    CCD_INIT(&ccd_);
    ccd_.center1 = center_of;
    ccd_.center2 = center_of;
    ccd_.max_iterations = 100;
  }

  [[nodiscard]] std::string name() const override { return portals_ ? "libccd MPR" : "libccd GJK"; }

  [[nodiscard]] static PairFunction pair_function(const PairKind& kind, ContactLevel level) {
    // A half-space has no support points.
    if (kind.b == ShapeKind::half_space) return nullptr;
    switch (level) {
      case ContactLevel::boolean:
        return &LibccdNarrow::verdict;
      case ContactLevel::manifold:
        return &LibccdNarrow::contact;
      default:
        return nullptr;
    }
  }

  void start(const PairSet& set) override {
    set_kind(set.kind);
    ccd_.support1 = support_of(set.kind.a);
    ccd_.support2 = support_of(set.kind.b);
    corners_.reserve(9 * set.poses.size());
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
      bodies_.push_back(make_body(set.pool.tables(), set.shapes[i], set.poses[i], corners_));
    }
  }

 private:
  void verdict(const BodyPair& pair, NarrowAnswer& answer) {
    const auto intersect = portals_ ? ccdMPRIntersect : ccdGJKIntersect;
    answer.overlap = intersect(&bodies_[pair.a], &bodies_[pair.b], &ccd_) != 0;
  }

  void contact(const BodyPair& pair, NarrowAnswer& answer) {
    const auto penetration = portals_ ? ccdMPRPenetration : ccdGJKPenetration;
    ccd_real_t depth = 0.0;
    ccd_vec3_t along{};
    ccd_vec3_t point{};
    answer = {};
    answer.overlap =
        penetration(&bodies_[pair.a], &bodies_[pair.b], &ccd_, &depth, &along, &point) == 0;
    if (!answer.overlap) return;
    answer.contacts = 1;
    answer.distance = -depth;
    write_vector(answer.normal, along.v[0], along.v[1], along.v[2]);
    write_vector(answer.point, point.v[0], point.v[1], point.v[2]);
  }

  bool portals_;
  ccd_t ccd_;
  std::vector<CcdBody> bodies_;
  std::vector<double> corners_;  // by triangle, columns of coordinates
};

}  // namespace

std::unique_ptr<NarrowEngine> make_libccd_gjk() {
  return std::make_unique<LibccdNarrow>(false);
}

std::unique_ptr<NarrowEngine> make_libccd_mpr() {
  return std::make_unique<LibccdNarrow>(true);
}

}  // namespace winnow::bench
