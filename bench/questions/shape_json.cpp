// Reads shapes, poses, motions and rays of JSON queries and adds the shapes to the pools.
// questions.cpp calls these functions; shape_json.h states the format.

#include "bench/questions/shape_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool read_numbers(const Json& value, std::span<double> out) {
  if (!value.is_array() || value.size() != out.size()) return false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!read_number(value[i], out[i])) return false;
  }
  return true;
}

/// Reads members of one object and records whether all were present and of the right type.
class ShapeReader {
 public:
  explicit ShapeReader(const Json& object) : object_(object), good_(object.is_object()) {}

  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool has(const char* name) const { return good_ && object_.contains(name); }

  double number(const char* name) {
    double value = 0.0;
    good_ = has(name) && read_number(object_[name], value);
    return value;
  }
  double number_or(const char* name, double value) { return has(name) ? number(name) : value; }

  void numbers(const char* name, std::span<double> out) {
    good_ = has(name) && read_numbers(object_[name], out);
  }
  void numbers_if_any(const char* name, std::span<double> out) {
    if (has(name)) numbers(name, out);
  }

  std::vector<Vec3d> points(const char* name) {
    std::vector<Vec3d> result;
    good_ = has(name) && object_[name].is_array() && !object_[name].empty();
    if (!good_) return result;
    for (const Json& point : object_[name]) {
      good_ = good_ && read_numbers(point, std::span<double>(result.emplace_back().data(), 3));
    }
    return result;
  }

  std::string text(const char* name) {
    good_ = has(name) && object_[name].is_string();
    return good_ ? object_[name].get<std::string>() : std::string();
  }

 private:
  const Json& object_;
  bool good_;
};

template <typename Shape>
Status add(ShapePool& pool, const ShapeReader& reader, const Shape& shape, ShapeId& id) {
  return reader.good() ? pool.add(shape, id) : Status::invalid_argument;
}

/// Adds the rounding radius to a length. A negative rounding gives NaN, which the pool rejects.
double rounded(double length, double rounding) {
  return rounding >= 0.0 ? length + rounding : kNan;
}

Status add_triangle(ShapePool& pool, ShapeReader& reader, double rounding, ShapeId& id) {
  const std::vector<Vec3d> v = reader.points("v");
  if (!reader.good() || v.size() != 3) return Status::invalid_argument;
  TriangleShape shape;
  for (std::size_t i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) shape.vertex[i][k] = v[i][k];
  }
  shape.rounding = rounding;
  return pool.add(shape, id);
}

/// Adds a shape that is defined by a radius: a sphere, or a kind with a half length as well.
Status add_round(const std::string& type, ShapePool& pool, ShapeReader& reader, double rounding,
                 ShapeId& id) {
  const double radius = reader.number("radius");
  if (type == "sphere") return add(pool, reader, SphereShape{rounded(radius, rounding)}, id);
  const double half = reader.number("half_length");
  if (type == "capsule")
    return add(pool, reader, CapsuleShape{rounded(radius, rounding), half}, id);
  if (type == "cylinder") return add(pool, reader, CylinderShape{radius, half, rounding}, id);
  if (type == "cone") return add(pool, reader, ConeShape{radius, half, rounding}, id);
  return Status::invalid_argument;
}

Status add_mesh(const Json& value, ShapeReader& reader, CompositePool& composites, ShapeId& id) {
  const std::vector<Vec3d> v = reader.points("v");
  if (!reader.good() || !value.contains("triangles")) return Status::invalid_argument;
  std::vector<std::uint32_t> corners;
  for (const Json& triangle : value["triangles"]) {
    if (!triangle.is_array() || triangle.size() != 3) return Status::invalid_argument;
    for (const Json& corner : triangle) {
      if (!corner.is_number_unsigned()) return Status::invalid_argument;
      // Vertex numbers beyond 32 bits are clamped; no mesh has that many vertices, so the pool
      // rejects them.
      const auto number = std::min<std::uint64_t>(corner.get<std::uint64_t>(), ~0U);
      corners.push_back(static_cast<std::uint32_t>(number));
    }
  }
  return composites.add_mesh(PointView(v), IndexView(corners), id);
}

Status add_height_field(const Json& value, ShapeReader& reader, CompositePool& composites,
                        ShapeId& id) {
  std::vector<float> heights;
  HeightSamples samples;
  reader.numbers_if_any("spacing", samples.spacing);
  if (!reader.good() || !value.contains("heights") || !value["heights"].is_array()) {
    return Status::invalid_argument;
  }
  for (const Json& row : value["heights"]) {
    std::vector<double> numbers(row.size());
    if (!read_numbers(row, numbers)) return Status::invalid_argument;
    if (samples.rows++ == 0) samples.columns = static_cast<std::uint32_t>(numbers.size());
    if (numbers.size() != samples.columns) return Status::invalid_argument;
    for (const double height : numbers) heights.push_back(static_cast<float>(height));
  }
  samples.heights = heights;
  return composites.add_height_field(samples, id);
}

Status add_shape(const Json& value, ShapePool& pool, ShapeId& id) {
  ShapeReader reader(value);
  const std::string type = reader.text("type");
  const double rounding = reader.number_or("rounding", 0.0);
  if (!reader.good()) return Status::invalid_argument;
  if (type == "hull") {
    const std::vector<Vec3d> v = reader.points("v");
    return reader.good() ? pool.add_hull(v, rounding, id) : Status::invalid_argument;
  }
  if (type == "triangle") return add_triangle(pool, reader, rounding, id);
  if (type == "half_space") {
    HalfSpaceShape shape;
    reader.numbers("normal", shape.normal);
    shape.offset = rounded(reader.number("offset"), rounding);
    return add(pool, reader, shape, id);
  }
  if (type == "box") {
    BoxShape shape{{}, rounding};
    reader.numbers("half", shape.half);
    return add(pool, reader, shape, id);
  }
  if (type == "ellipsoid") {
    EllipsoidShape shape{{}, rounding};
    reader.numbers("radii", shape.radius);
    return add(pool, reader, shape, id);
  }
  if (type == "tapered_capsule") {
    double radii[2] = {};
    reader.numbers("radii", radii);
    const double half = reader.number("half_length");
    const TaperedCapsuleShape shape{{rounded(radii[0], rounding), rounded(radii[1], rounding)},
                                    half};
    return add(pool, reader, shape, id);
  }
  return add_round(type, pool, reader, rounding, id);
}

/// Overwrites the parts of `pose` that the member `name` contains and keeps the others.
Status read_pose(const Json& shape, const char* name, Pose& pose) {
  if (!shape.contains(name)) return Status::ok;
  ShapeReader reader(shape[name]);
  reader.numbers_if_any("position", pose.position);
  reader.numbers_if_any("orientation", pose.orientation);
  if (!reader.good()) return Status::invalid_argument;
  return pose.is_valid() ? Status::ok : Status::invalid_pose;
}

/// Adds any shape that may be a child of a compound.
Status add_child(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id) {
  ShapeReader reader(value);
  const std::string type = reader.text("type");
  if (type == "mesh") return add_mesh(value, reader, composites, id);
  if (type == "height_field") return add_height_field(value, reader, composites, id);
  return add_shape(value, pool, id);
}

Status add_compound(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id) {
  if (!value.contains("children") || !value["children"].is_array()) {
    return Status::invalid_argument;
  }
  std::vector<CompoundChild> children;
  for (const Json& entry : value["children"]) {
    if (!entry.is_object()) return Status::invalid_argument;
    CompoundChild& child = children.emplace_back();
    Status status = read_pose(entry, "pose", child.pose);
    if (status == Status::ok) status = add_child(entry, pool, composites, child.shape);
    if (status != Status::ok) return status;
  }
  return composites.add_compound(children, id);
}

/// Adds a convex or composite shape.
Status add_any_shape(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id) {
  const bool is_compound = ShapeReader(value).text("type") == "compound";
  return is_compound ? add_compound(value, pool, composites, id)
                     : add_child(value, pool, composites, id);
}

}  // namespace

Status read_shape(const Json& value, ShapePool& pool, ShapeId& id, Pose& pose) {
  if (!value.is_object()) return Status::invalid_argument;
  pose = {};
  const Status pose_status = read_pose(value, "pose", pose);
  if (pose_status == Status::invalid_argument) return pose_status;
  const Status status = add_shape(value, pool, id);
  return status == Status::ok ? pose_status : status;
}

bool has_end_pose(const Json& value) {
  return value.is_object() && value.contains("end_pose");
}

Status read_moving_shape(const Json& value, ShapePool& pool, CompositePool& composites, ShapeId& id,
                         RigidMotion& motion) {
  if (!value.is_object()) return Status::invalid_argument;
  Pose start;
  const Status start_status = read_pose(value, "pose", start);
  if (start_status == Status::invalid_argument) return start_status;
  const Status status = add_any_shape(value, pool, composites, id);
  if (status != Status::ok) return status;
  if (start_status != Status::ok) return start_status;
  Pose end = start;
  const Status end_status = read_pose(value, "end_pose", end);
  motion = RigidMotion::between(start, end);
  return end_status == Status::ok && !motion.is_valid() ? Status::invalid_pose : end_status;
}

Status read_ray(const Json& value, ShapeRay& ray) {
  ShapeReader reader(value);
  reader.numbers("origin", ray.origin);
  reader.numbers("direction", ray.direction);
  ray.max_t = reader.number_or("max_t", kInfinity);
  return reader.good() ? Status::ok : Status::invalid_argument;
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

Json number_to_json(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return value;
}

}  // namespace winnow::bench
