#include "tests/pipeline/reproduction.h"

#include <sstream>

namespace winnow::test {
namespace {

template <typename Number>
void list(std::ostream& out, const char* name, const Number* values, int count) {
  out << '"' << name << "\":[";
  for (int i = 0; i < count; ++i) out << (i == 0 ? "" : ",") << values[i];
  out << "],";
}

void write_points(std::ostream& out, const HullShape& hull) {
  out << "\"v\":[";
  for (std::uint32_t i = 0; i < hull.vertex_count; ++i) {
    out << (i == 0 ? "[" : ",[") << hull.vertex[0][i] << ',' << hull.vertex[1][i] << ','
        << hull.vertex[2][i] << ']';
  }
  out << "],\"rounding\":" << hull.rounding << ',';
}

template <typename Round>
void write_round(std::ostream& out, const Round& shape) {
  out << "\"radius\":" << shape.radius << ",\"half_length\":" << shape.half_length << ',';
}

void write_shape(std::ostream& out, const ShapeTables& tables, ShapeId id) {
  out << "{\"type\":\"" << to_string(id.kind()) << "\",";
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      out << "\"radius\":" << tables.spheres[i].radius << ',';
      break;
    case ShapeKind::capsule:
      write_round(out, tables.capsules[i]);
      break;
    case ShapeKind::box:
      list(out, "half", tables.boxes[i].half.data(), 3);
      out << "\"rounding\":" << tables.boxes[i].rounding << ',';
      break;
    case ShapeKind::cylinder:
      write_round(out, tables.cylinders[i]);
      out << "\"rounding\":" << tables.cylinders[i].rounding << ',';
      break;
    case ShapeKind::cone:
      write_round(out, tables.cones[i]);
      out << "\"rounding\":" << tables.cones[i].rounding << ',';
      break;
    case ShapeKind::triangle: {
      const auto& v = tables.triangles[i].vertex;
      out << "\"v\":[";
      for (int k = 0; k < 3; ++k) {
        out << (k == 0 ? "[" : ",[") << v[k][0] << ',' << v[k][1] << ',' << v[k][2] << ']';
      }
      out << "],\"rounding\":" << tables.triangles[i].rounding << ',';
      break;
    }
    case ShapeKind::hull:
      write_points(out, tables.hulls[i]);
      break;
    case ShapeKind::half_space:
      list(out, "normal", tables.half_spaces[i].normal.data(), 3);
      out << "\"offset\":" << tables.half_spaces[i].offset << ',';
      break;
    case ShapeKind::ellipsoid:
      list(out, "radii", tables.ellipsoids[i].radius.data(), 3);
      out << "\"rounding\":" << tables.ellipsoids[i].rounding << ',';
      break;
    case ShapeKind::tapered_capsule:
      list(out, "radii", tables.tapered_capsules[i].radius, 2);
      out << "\"half_length\":" << tables.tapered_capsules[i].half_length << ',';
      break;
    case ShapeKind::support:
      break;
  }
}

void write_body(std::ostream& out, const PairScene& scene, std::uint32_t body) {
  write_shape(out, scene.pool.tables(), scene.shapes[body]);
  out << "\"pose\":{";
  list(out, "position", scene.poses[body].position.data(), 3);
  list(out, "orientation", scene.poses[body].orientation.data(), 4);
  out.seekp(-1, std::ios::cur);
  out << "}}";
}

}  // namespace

std::string reproduction(const PairScene& scene, BodyPair pair) {
  std::ostringstream out;
  out.precision(17);
  out << "{\"id\":0,\"a\":";
  write_body(out, scene, pair.a);
  out << ",\"b\":";
  write_body(out, scene, pair.b);
  out << '}';
  return out.str();
}

}  // namespace winnow::test
