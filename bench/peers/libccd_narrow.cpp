// Adapter of libccd: support functions for winnow's shapes, and its GJK with EPA and its MPR on
// them. It registers itself in registry.h.

#include "bench/contenders/engines.h"
#include "bench/peers/narrow_adapter.h"
#include "bench/peers/registry.h"
#include "bench/scenes/lens.h"

#include <ccd/ccd.h>
#include <winnow/core/eigen.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace winnow::bench {
namespace {

using Vector = Eigen::Vector3d;

/// A body, as the support functions read it.
struct CcdBody {
  Eigen::Matrix3d turn;
  Vector position;
  double size[3];  // half lengths of a box; radii and half length of round shapes
  const Lens* lens;
  const double* vertex[3];  // columns of coordinates
  std::uint32_t vertices;
};

// Support functions of libccd: the support point of a body in a direction of any length, both in
// world coordinates.

const CcdBody& body_of(const void* object) {
  return *static_cast<const CcdBody*>(object);
}

void of_sphere(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = body_of(object);
  const auto along = Vector::Map(direction->v);
  Vector::Map(point->v) = body.position + body.size[0] / along.norm() * along;
}

void of_capsule(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = body_of(object);
  const auto along = Vector::Map(direction->v);
  const double h = std::copysign(body.size[1], body.turn.col(2).dot(along));
  Vector::Map(point->v) =
      body.position + h * body.turn.col(2) + body.size[0] / along.norm() * along;
}

void of_taper(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = body_of(object);
  const auto along = Vector::Map(direction->v);
  const double length = along.norm();
  const double rise = (body.size[0] - body.size[1]) * length;
  const bool low = rise > 2.0 * body.size[2] * body.turn.col(2).dot(along);
  const double h = low ? -body.size[2] : body.size[2];
  Vector::Map(point->v) =
      body.position + h * body.turn.col(2) + body.size[low ? 0 : 1] / length * along;
}

// Support functions in the frame of the body.

Vector box_corner(const CcdBody& body, const Vector& along) {
  Vector corner;
  for (int i = 0; i < 3; ++i) corner[i] = std::copysign(body.size[i], along[i]);
  return corner;
}

Vector rim_point(const CcdBody& body, const Vector& along, double z) {
  const double across = std::hypot(along.x(), along.y());
  const double reach = across > 0.0 ? body.size[0] / across : 0.0;
  return {reach * along.x(), reach * along.y(), z};
}

Vector on_cylinder(const CcdBody& body, const Vector& along) {
  return rim_point(body, along, std::copysign(body.size[1], along.z()));
}

Vector on_cone(const CcdBody& body, const Vector& along) {
  const double across = std::hypot(along.x(), along.y());
  const bool apex = 2.0 * body.size[1] * along.z() > body.size[0] * across;
  return apex ? Vector(0.0, 0.0, body.size[1]) : rim_point(body, along, -body.size[1]);
}

Vector on_ellipsoid(const CcdBody& body, const Vector& along) {
  const auto radii = Vector::Map(body.size);
  const Vector scaled = radii.cwiseProduct(along);
  const double length = scaled.norm();
  return length > 0.0 ? Vector(radii.cwiseProduct(scaled) / length) : Vector::Zero();
}

Vector on_lens(const CcdBody& body, const Vector& along) {
  Vector point;
  farthest_of_lens(*body.lens, along.data(), point.data());
  return point;
}

Vector farthest_vertex(const CcdBody& body, const Vector& along) {
  const auto vertex = [&](std::uint32_t i) {
    return Vector(body.vertex[0][i], body.vertex[1][i], body.vertex[2][i]);
  };
  std::uint32_t best = 0;
  double most = -HUGE_VAL;
  for (std::uint32_t i = 0; i < body.vertices; ++i) {
    const double value = vertex(i).dot(along);
    if (value > most) {
      most = value;
      best = i;
    }
  }
  return vertex(best);
}

template <Vector (*farthest)(const CcdBody&, const Vector&)>
void rotated(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const CcdBody& body = body_of(object);
  const Vector along = body.turn.transpose() * Vector::Map(direction->v);
  Vector::Map(point->v) = body.position + body.turn * farthest(body, along);
}

/// Returns the position of the body: all shapes in the race contain the origin of their frame.
void center_of(const void* object, ccd_vec3_t* center) {
  Vector::Map(center->v) = body_of(object).position;
}

ccd_support_fn support_of(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::sphere:
      return of_sphere;
    case ShapeKind::capsule:
      return of_capsule;
    case ShapeKind::box:
      return rotated<box_corner>;
    case ShapeKind::cylinder:
      return rotated<on_cylinder>;
    case ShapeKind::cone:
      return rotated<on_cone>;
    case ShapeKind::ellipsoid:
      return rotated<on_ellipsoid>;
    case ShapeKind::tapered_capsule:
      return of_taper;
    case ShapeKind::support:
      return rotated<on_lens>;
    default:
      return rotated<farthest_vertex>;
  }
}

/// `corners` must have room for nine more values, which a triangle uses.
CcdBody make_body(const ShapeTables& tables, ShapeId id, const Pose& pose,
                  std::vector<double>& corners) {
  CcdBody body{};
  body.turn = orientation_of(pose).toRotationMatrix();
  body.position = as_eigen(pose.position);
  const std::uint32_t i = id.index();
  const auto set_sizes = [&](std::initializer_list<double> sizes) {
    std::copy(sizes.begin(), sizes.end(), body.size);
  };
  switch (id.kind()) {
    case ShapeKind::sphere:
      set_sizes({tables.spheres[i].radius});
      break;
    case ShapeKind::capsule:
      set_sizes({tables.capsules[i].radius, tables.capsules[i].half_length});
      break;
    case ShapeKind::cylinder:
      set_sizes({tables.cylinders[i].radius, tables.cylinders[i].half_length});
      break;
    case ShapeKind::cone:
      set_sizes({tables.cones[i].radius, tables.cones[i].half_length});
      break;
    case ShapeKind::box:
      std::copy_n(tables.boxes[i].half.data(), 3, body.size);
      break;
    case ShapeKind::ellipsoid:
      std::copy_n(tables.ellipsoids[i].radius.data(), 3, body.size);
      break;
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape& taper = tables.tapered_capsules[i];
      set_sizes({taper.radius[0], taper.radius[1], taper.half_length});
      break;
    }
    case ShapeKind::support:
      body.lens = static_cast<const Lens*>(tables.supports[i].context);
      break;
    case ShapeKind::triangle:
      for (int axis = 0; axis < 3; ++axis) {
        for (const auto& vertex : tables.triangles[i].vertex) corners.push_back(vertex[axis]);
        body.vertex[axis] = &corners.back() - 2;
      }
      body.vertices = 3;
      break;
    case ShapeKind::hull:
      std::copy_n(tables.hulls[i].vertex, 3, body.vertex);
      body.vertices = tables.hulls[i].vertex_count;
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
    answer.normal = along.v;
    answer.point = point.v;
  }

  bool portals_;
  ccd_t ccd_;
  std::vector<CcdBody> bodies_;
  std::vector<double> corners_;  // by triangle, columns of coordinates
};

const RegisteredPeer<NarrowEngine, LibccdNarrow, false> kLibccdNarrowGjk;
const RegisteredPeer<NarrowEngine, LibccdNarrow, true> kLibccdNarrowMpr;

}  // namespace
}  // namespace winnow::bench
