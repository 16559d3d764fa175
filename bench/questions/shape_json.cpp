// Reads numbers, shapes, poses, motions and rays of JSON queries and adds the shapes to the pools.
// questions.cpp calls these functions; shape_json.h states the format.

#include "bench/questions/shape_json.h"

#include "bench/questions/query_format.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The functions below read objects of the right format, see is_readable().

double number(const Json& object, const char* name, double otherwise = 0.0) {
  static_cast<void>(read_number(member(object, name), otherwise));
  return otherwise;
}

bool is_true(const Json& object, const char* name) {
  return member(object, name) == true;
}

void numbers(const Json& array, std::span<double> out) {
  for (std::size_t i = 0; i < array.size(); ++i) static_cast<void>(read_number(array[i], out[i]));
}

std::vector<Vec3d> vertices(const Json& shape) {
  std::vector<Vec3d> points;
  for (const Json& point : shape["v"]) {
    numbers(point, std::span<double>(points.emplace_back().data(), 3));
  }
  return points;
}

/// Adds the rounding radius to a length. A negative rounding gives NaN, which the pool rejects.
double rounded(double length, double rounding) {
  return rounding >= 0.0 ? length + rounding : kNan;
}

Status add_mesh(const Json& mesh, CompositePool& composites, ShapeId& id) {
  const std::vector<Vec3d> v = vertices(mesh);
  std::vector<std::uint32_t> corners;
  for (const Json& triangle : mesh["triangles"]) {
    for (const Json& corner : triangle) {
      // Vertex numbers beyond 32 bits are clamped; no mesh has that many vertices, so the pool
      // rejects them.
      const auto index = std::min<std::uint64_t>(corner.get<std::uint64_t>(), ~0U);
      corners.push_back(static_cast<std::uint32_t>(index));
    }
  }
  const Status status = composites.add_mesh(PointView(v), IndexView(corners)).get(id);
  if (status != Status::ok || !is_true(mesh, "solid")) return status;
  return composites.set_solid(id);
}

Status add_height_field(const Json& field, CompositePool& composites, ShapeId& id) {
  HeightSamples samples;
  numbers(member(field, "spacing"), samples.spacing);
  std::vector<float> heights;
  for (const Json& row : field["heights"]) {
    std::vector<double> values(row.size());
    numbers(row, values);
    samples.columns = static_cast<std::uint32_t>(values.size());
    ++samples.rows;
    for (const double height : values) heights.push_back(static_cast<float>(height));
  }
  samples.heights = heights;
  return composites.add_height_field(samples).get(id);
}

Status add_shape(const Json& value, ShapePool& pool, ShapeId& id) {
  const Json& type = value["type"];
  const double rounding = number(value, "rounding");
  const double radius = number(value, "radius");
  const double half_length = number(value, "half_length");
  if (type == "sphere") return pool.add(SphereShape{rounded(radius, rounding)}).get(id);
  if (type == "capsule")
    return pool.add(CapsuleShape{rounded(radius, rounding), half_length}).get(id);
  if (type == "cylinder") return pool.add(CylinderShape{radius, half_length, rounding}).get(id);
  if (type == "cone") return pool.add(ConeShape{radius, half_length, rounding}).get(id);
  if (type == "box") {
    BoxShape shape{{}, rounding};
    numbers(value["half"], shape.half);
    return pool.add(shape).get(id);
  }
  if (type == "ellipsoid") {
    EllipsoidShape shape{{}, rounding};
    numbers(value["radii"], shape.radius);
    return pool.add(shape).get(id);
  }
  if (type == "half_space") {
    HalfSpaceShape shape;
    numbers(value["normal"], shape.normal);
    shape.offset = rounded(number(value, "offset"), rounding);
    return pool.add(shape).get(id);
  }
  if (type == "tapered_capsule") {
    double radii[2] = {};
    numbers(value["radii"], radii);
    return pool
        .add(TaperedCapsuleShape{{rounded(radii[0], rounding), rounded(radii[1], rounding)},
                                 half_length})
        .get(id);
  }
  const std::vector<Vec3d> v = vertices(value);
  if (type == "hull") return pool.add_hull(v, rounding).get(id);
  TriangleShape shape;
  for (std::size_t i = 0; i < 3; ++i) shape.vertex[i] = v[i];
  shape.rounding = rounding;
  return pool.add(shape).get(id);
}

/// Overwrites the parts of `pose` that the member `name` contains and keeps the others.
Status read_pose(const Json& shape, const char* name, Pose& pose) {
  const Json& value = member(shape, name);
  numbers(member(value, "position"), pose.position);
  numbers(member(value, "orientation"), pose.orientation);
  return pose.is_valid() ? Status::ok : Status::invalid_pose;
}

/// Adds a convex or composite shape.
Status add_any_shape(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id) {
  const Json& type = value["type"];
  if (type == "mesh" || type == "height_field") {
    const Status status =
        type == "mesh" ? add_mesh(value, composites, id) : add_height_field(value, composites, id);
    if (status != Status::ok || !is_true(value, "one_sided")) return status;
    return composites.set_one_sided(id);
  }
  if (type != "compound") return add_shape(value, pool, id);
  std::vector<CompoundChild> children;
  for (const Json& entry : value["children"]) {
    CompoundChild& child = children.emplace_back();
    Status status = read_pose(entry, "pose", child.pose);
    if (status == Status::ok) status = add_any_shape(entry, pool, composites, child.shape);
    if (status != Status::ok) return status;
  }
  return composites.add_compound(children).get(id);
}

/// Reads a hexadecimal number such as "0x1.8p+1", with or without a sign, that fills the whole
/// text.
bool read_hexadecimal(const std::string& text, double& out) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  if (text.compare(sign, 2, "0x") != 0 && text.compare(sign, 2, "0X") != 0) return false;
  char* end = nullptr;
  out = std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size() && std::isfinite(out);
}

}  // namespace

Status read_shape(const Json& value, ShapePool& pool, ShapeId& id, Pose& pose) {
  if (!is_readable(value, QueryPart::convex_shape)) return Status::invalid_argument;
  pose = {};
  const Status pose_status = read_pose(value, "pose", pose);
  const Status status = add_shape(value, pool, id);
  return status == Status::ok ? pose_status : status;
}

Status read_any_shape(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id,
                      Pose& pose) {
  if (!is_readable(value, QueryPart::any_shape)) return Status::invalid_argument;
  pose = {};
  const Status pose_status = read_pose(value, "pose", pose);
  const Status status = add_any_shape(value, pool, composites, id);
  return status == Status::ok ? pose_status : status;
}

bool is_composite(const Json& value) {
  const Json& type = member(value, "type");
  return type == "mesh" || type == "height_field" || type == "compound";
}

bool has_end_pose(const Json& value) {
  return value.is_object() && value.contains("end_pose");
}

Status read_moving_shape(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id,
                         RigidMotion& motion) {
  Pose start;
  const Status start_status = read_any_shape(value, pool, composites, id, start);
  if (start_status != Status::ok) return start_status;
  Pose end = start;
  const Status end_status = read_pose(value, "end_pose", end);
  motion = RigidMotion::between(start, end);
  return end_status == Status::ok && !motion.is_valid() ? Status::invalid_pose : end_status;
}

Status read_ray(const Json& value, ShapeRay& ray) {
  if (!is_readable(value, QueryPart::ray)) return Status::invalid_argument;
  numbers(value["origin"], ray.origin);
  numbers(value["direction"], ray.direction);
  ray.min_t = number(value, "min_t");
  ray.max_t = number(value, "max_t", kInfinity);
  return Status::ok;
}

bool read_number(const Json& value, double& out) {
  if (value.is_number()) {
    out = value.get<double>();
  } else if (value == "nan") {
    out = kNan;
  } else if (value == "inf") {
    out = kInfinity;
  } else if (value == "-inf") {
    out = -kInfinity;
  } else {
    return false;
  }
  return true;
}

bool read_exact_number(const Json& value, double& out) {
  return read_number(value, out) ||
         (value.is_string() && read_hexadecimal(value.get_ref<const std::string&>(), out));
}

Json number_to_json(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return value;
}

Json vector_to_json(const Vec3d& value) {
  return Json::array(
      {number_to_json(value[0]), number_to_json(value[1]), number_to_json(value[2])});
}

}  // namespace winnow::bench
