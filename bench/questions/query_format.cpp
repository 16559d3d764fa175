// The format of queries in JSON as tables of members, from which `fault_of` explains why a query is
// refused and `query_format` writes the help of `winnow query`. shape_json.cpp and motion_json.cpp
// read the same format.

#include "bench/questions/query_format.h"

#include "bench/questions/motion_json.h"
#include "bench/questions/shape_json.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace winnow::bench {
namespace {

/// A condition on a value; `element` applies to each element of an array.
struct Rule {
  const char* expected;
  bool (*holds)(const Json& value);
  const Rule* element = nullptr;
};

struct Member {
  const char* name;
  const Rule* rule;
  const char* meaning;  ///< with the unit
  bool required = true;
};

struct ShapeFormat {
  const char* type;
  std::vector<Member> members;
};

bool is_finite(const Json& value) {
  double number = 0.0;
  return read_number(value, number) && std::isfinite(number);
}
bool is_length(const Json& value) {
  return is_finite(value) && value.get<double>() >= 0.0;
}
bool is_exact(const Json& value) {
  double number = 0.0;
  return read_exact_number(value, number) && std::isfinite(number);
}
template <std::size_t N>
bool has_size(const Json& value) {
  return value.is_array() && value.size() == N;
}
bool is_list(const Json& value) {
  return value.is_array() && !value.empty();
}
/// Returns whether a number of an array differs from 0, or is none.
bool has_nonzero(const Json& value) {
  return std::any_of(value.begin(), value.end(), [](const Json& one) { return one != 0.0; });
}
/// Returns whether the rows of an array that are arrays have equal lengths.
bool has_equal_rows(const Json& value) {
  return is_list(value) && std::all_of(value.begin(), value.end(), [&](const Json& row) {
           return !row.is_array() || !value[0].is_array() || row.size() == value[0].size();
         });
}

constexpr Rule kNumber{"a finite number", is_finite};
constexpr Rule kLength{"a finite number >= 0", is_length};
constexpr Rule kRayEnd{"a number >= 0, or \"inf\"",
                       [](const Json& value) { return value == "inf" || is_length(value); }};
constexpr Rule kExact{"a finite number, or a string such as \"0x1.8p+1\"", is_exact};
constexpr Rule kSeparation{"a finite number >= 0, or a string such as \"0x1.8p+1\"",
                           [](const Json& value) {
                             double number = 0.0;
                             return read_exact_number(value, number) && number >= 0.0;
                           }};
constexpr Rule kVector{"three numbers [x, y, z]", has_size<3>, &kNumber};
constexpr Rule kDirection{
    "three numbers [x, y, z], not all 0",
    [](const Json& value) { return has_size<3>(value) && has_nonzero(value); }, &kNumber};
constexpr Rule kQuaternion{
    "four numbers [w, x, y, z], not all 0",
    [](const Json& value) { return has_size<4>(value) && has_nonzero(value); }, &kNumber};
constexpr Rule kLengths3{"three numbers >= 0", has_size<3>, &kLength};
constexpr Rule kLengths2{"two numbers >= 0", has_size<2>, &kLength};
constexpr Rule kSpacing{
    "two numbers > 0",
    [](const Json& value) { return has_size<2>(value) && value[0] != 0.0 && value[1] != 0.0; },
    &kLength};
constexpr Rule kPoints{"an array of points [x, y, z]", is_list, &kVector};
constexpr Rule kThreePoints{"three points [x, y, z]", has_size<3>, &kVector};
constexpr Rule kIndex{"an index of a point, from 0",
                      [](const Json& value) { return value.is_number_unsigned(); }};
constexpr Rule kCorners{"three indices [i, j, k]", has_size<3>, &kIndex};
constexpr Rule kTriangles{"an array of triangles [i, j, k]", is_list, &kCorners};
constexpr Rule kRow{"an array of numbers", is_list, &kNumber};
constexpr Rule kRows{"rows with equally many numbers", has_equal_rows, &kRow};
constexpr Rule kExactPoint{"three numbers [x, y, z]", has_size<3>, &kExact};
constexpr Rule kFourPoints{"four points [x, y, z]", has_size<4>, &kExactPoint};
constexpr Rule kFeatures{"\"vertex_face\" or \"edge_edge\"", [](const Json& value) {
                           return value == "vertex_face" || value == "edge_edge";
                         }};

const std::vector<Member> kPose{
    {"position", &kVector, "position of the shape's frame; length; 0 if missing", false},
    {"orientation", &kQuaternion, "quaternion [w,x,y,z] of any length; no unit; 1 if missing",
     false}};

const Member kRadius{"radius", &kLength, "radius; length"};
const Member kHalfLength{"half_length", &kLength,
                         "half of the extent along the local z axis, without rounded caps; length"};
const Member kRounding{"rounding", &kLength,
                       "radius added outside, for convex shapes; length; 0 if missing", false};

const std::vector<ShapeFormat> kConvex{
    {"sphere", {kRadius, kRounding}},
    {"capsule", {kRadius, kHalfLength, kRounding}},
    {"cylinder", {kRadius, kHalfLength, kRounding}},
    {"cone", {kRadius, kHalfLength, kRounding}},
    {"box", {{"half", &kLengths3, "half of the edges along x, y, z; length"}, kRounding}},
    {"triangle", {{"v", &kThreePoints, "vertices; length"}, kRounding}},
    {"hull", {{"v", &kPoints, "vertices; length"}, kRounding}},
    {"half_space",
     {{"normal", &kDirection, "outward normal of any length"},
      {"offset", &kNumber,
       "distance of the plane from the origin; length, times that of the normal"},
      kRounding}},
    {"ellipsoid", {{"radii", &kLengths3, "semi-axes along x, y, z; length"}, kRounding}},
    {"tapered_capsule",
     {{"radii", &kLengths2, "radii at z = -half_length and z = half_length; length"},
      kHalfLength,
      kRounding}}};
const std::vector<ShapeFormat> kComposite{
    {"mesh",
     {{"v", &kPoints, "vertices; length"},
      {"triangles", &kTriangles, "three indices of vertices each, from 0"}}},
    {"height_field",
     {{"heights", &kRows, "rows of heights; length"},
      {"spacing", &kSpacing, "distance of samples along x and y; length; 1 if missing", false}}}};

const std::vector<Member> kRay{
    {"origin", &kVector, "start of the ray; length"},
    {"direction", &kDirection, "direction of any length; the unit of t"},
    {"max_t", &kRayEnd, "end of the ray in units of the direction; \"inf\" if missing", false}};
const std::vector<Member> kMotion{
    {"kind", &kFeatures, "a vertex and the corners of a face, or the ends of two edges"},
    {"start", &kFourPoints, "points at time 0; length"},
    {"end", &kFourPoints, "points at time 1; length"}};
const Member kMinSeparation{"min_separation", &kSeparation,
                            "distance that counts as contact; length; 0 if missing", false};

std::string shortened(const Json& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kLongest) text.replace(kLongest, std::string::npos, "...");
  return text;
}

QueryFault fault_at(const std::string& path, std::string expected, const Json& value) {
  return {path, std::move(expected), value.is_discarded() ? "nothing" : shortened(value)};
}

std::string joined(const std::string& path, const char* name) {
  return path.empty() ? name : path + "." + name;
}

/// Each function below returns the first fault, or nothing.
using Fault = std::optional<QueryFault>;

Fault check_value(const Json& value, const Rule& rule, const std::string& path) {
  if (!rule.holds(value)) return fault_at(path, rule.expected, value);
  if (rule.element == nullptr) return {};
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (Fault fault = check_value(value[i], *rule.element, path + "[" + std::to_string(i) + "]")) {
      return fault;
    }
  }
  return {};
}

Fault check_member(const Json& object, const Member& member, const std::string& path) {
  if (object.contains(member.name)) {
    return check_value(object[member.name], *member.rule, joined(path, member.name));
  }
  if (!member.required) return {};
  return fault_at(joined(path, member.name), member.rule->expected, Json::value_t::discarded);
}

Fault check_members(const Json& object, std::span<const Member> members, const std::string& path) {
  if (!object.is_object()) return fault_at(path, "an object", object);
  for (const Member& member : members) {
    if (Fault fault = check_member(object, member, path)) return fault;
  }
  return {};
}

Fault check_pose(const Json& shape, const char* name, const std::string& path) {
  if (!shape.contains(name)) return {};
  return check_members(shape[name], kPose, joined(path, name));
}

/// The pool accepts only indices of vertices.
Fault check_indices(const Json& mesh, const std::string& path) {
  const std::size_t count = mesh["v"].size();
  const Json& triangles = mesh["triangles"];
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const Json& corner : triangles[i]) {
      if (corner.get<std::uint64_t>() < count) continue;
      return fault_at(path + ".triangles[" + std::to_string(i) + "]",
                      "indices below " + std::to_string(count), triangles[i]);
    }
  }
  return {};
}

enum class Allowed { convex, child, any };

Fault check_shape(const Json& shape, Allowed allowed, const std::string& path);

Fault check_children(const Json& shape, const std::string& path) {
  const std::string list = joined(path, "children");
  if (!shape.contains("children")) {
    return fault_at(list, "an array of shapes", Json::value_t::discarded);
  }
  const Json& children = shape["children"];
  if (!is_list(children)) return fault_at(list, "an array of shapes", children);
  for (std::size_t i = 0; i < children.size(); ++i) {
    const std::string child = list + "[" + std::to_string(i) + "]";
    if (Fault fault = check_shape(children[i], Allowed::child, child)) return fault;
  }
  return {};
}

Fault check_shape(const Json& shape, Allowed allowed, const std::string& path) {
  if (!shape.is_object()) return fault_at(path, "a shape, {\"type\": ...}", shape);
  for (const char* const pose : {"pose", "end_pose"}) {
    if (Fault fault = check_pose(shape, pose, path)) return fault;
  }
  const Json& type = member(shape, "type");
  if (allowed == Allowed::any && type == "compound") return check_children(shape, path);
  std::string types;
  for (const auto* const formats : {&kConvex, &kComposite}) {
    if (allowed == Allowed::convex && formats == &kComposite) break;
    for (const ShapeFormat& format : *formats) {
      types += (types.empty() ? "" : ", ") + std::string(format.type);
      if (type != format.type) continue;
      Fault fault = check_members(shape, format.members, path);
      return fault || type != "mesh" ? fault : check_indices(shape, path);
    }
  }
  if (allowed == Allowed::any) types += ", compound";
  return fault_at(joined(path, "type"), "one of " + types,
                  shape.contains("type") ? type : Json(Json::value_t::discarded));
}

Fault check_required_shape(const Json& query, const char* name, Allowed allowed) {
  if (query.contains(name)) return check_shape(query[name], allowed, name);
  return fault_at(name, "a shape, {\"type\": ...}", Json::value_t::discarded);
}

}  // namespace

std::optional<QueryFault> fault_of(const Json& query) {
  if (!query.is_object()) return fault_at("", "an object", query);
  if (query.contains("ray")) {
    if (Fault fault = check_members(query["ray"], kRay, "ray")) return fault;
    return check_required_shape(query, "target", Allowed::convex);
  }
  if (query.contains("motion")) {
    if (Fault fault = check_members(query["motion"], kMotion, "motion")) return fault;
    return check_member(query, kMinSeparation, "");
  }
  if (!query.contains("a") && !query.contains("b")) {
    return fault_at("", "the members \"a\" and \"b\", \"ray\" and \"target\", or \"motion\"",
                    query);
  }
  const bool moves = has_end_pose(member(query, "a")) || has_end_pose(member(query, "b"));
  const Allowed allowed = moves ? Allowed::any : Allowed::convex;
  if (Fault fault = check_required_shape(query, "a", allowed)) return fault;
  return check_required_shape(query, "b", allowed);
}

const std::string& query_example() {
  static const std::string example = R"([
 {"id": "two shapes",
  "a": {"type": "sphere", "radius": 1},
  "b": {"type": "box", "half": [1, 2, 0.5], "rounding": 0.1,
        "pose": {"position": [2, 0, 0], "orientation": [1, 0, 0, 0]}}},
 {"id": "round shapes",
  "a": {"type": "capsule", "radius": 0.5, "half_length": 2},
  "b": {"type": "tapered_capsule", "radii": [0.5, 0.25], "half_length": 1}},
 {"id": "solids of revolution",
  "a": {"type": "cylinder", "radius": 1, "half_length": 2},
  "b": {"type": "cone", "radius": 1, "half_length": 1, "pose": {"position": [0, 0, 9]}}},
 {"id": "points",
  "a": {"type": "triangle", "v": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]},
  "b": {"type": "hull", "v": [[0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 2]]}},
 {"id": "a ray",
  "ray": {"origin": [0, 0, 5], "direction": [0, 0, -1], "max_t": 10},
  "target": {"type": "half_space", "normal": [0, 0, 1], "offset": 1}},
 {"id": "a time of impact",
  "a": {"type": "ellipsoid", "radii": [1, 2, 3], "pose": {"position": [0, 0, 9]},
        "end_pose": {"position": [0, 0, -9], "orientation": [0.8, 0.6, 0, 0]}},
  "b": {"type": "mesh", "v": [[-9, -9, 0], [9, -9, 0], [0, 9, 0]], "triangles": [[0, 1, 2]]}},
 {"id": "a compound on a terrain",
  "a": {"type": "compound", "pose": {"position": [1, 1, 5]}, "end_pose": {"position": [1, 1, 0]},
        "children": [{"type": "sphere", "radius": 0.5},
                     {"type": "box", "half": [1, 1, 1], "pose": {"position": [0, 0, 1]}}]},
  "b": {"type": "height_field", "heights": [[0, 1, 0], [1, 0, 1], [0, 1, 0]], "spacing": [1, 1]}},
 {"id": "a vertex and a face", "min_separation": 0.01,
  "motion": {"kind": "vertex_face",
             "start": [[0.2, 0.2, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0]],
             "end": [[0.2, 0.2, "-0x1p+0"], [0, 0, 0], [1, 0, 0], [0, 1, 0]]}}
]
)";
  return example;
}

namespace {

/// Calls `visit(object, member)` for each member of each table, in the order of the help.
template <typename Visit>
void visit_members(Visit&& visit) {
  for (const auto* const formats : {&kConvex, &kComposite}) {
    for (const ShapeFormat& format : *formats) {
      for (const Member& member : format.members) visit(format.type, member);
    }
  }
  for (const Member& member : kPose) visit("pose", member);
  for (const Member& member : kRay) visit("ray", member);
  for (const Member& member : kMotion) visit("motion", member);
  visit("query", kMinSeparation);
}

}  // namespace

std::vector<std::string> query_words() {
  std::vector<std::string> words{"id",     "a",    "b",        "ray",      "target",
                                 "motion", "pose", "end_pose", "compound", "children"};
  visit_members([&](const char* object, const Member& member) {
    words.emplace_back(object);
    words.emplace_back(member.name);
  });
  return words;
}

std::string query_format() {
  std::string text =
      "The file is an array of queries. This example has every member; `winnow query` answers "
      "it:\n\n" +
      query_example() +
      "\nAll lengths are in one unit of your choice; points are [x,y,z]. Times run from 0 "
      "(\"pose\") "
      "to 1\n(\"end_pose\"). Numbers may also be \"inf\", \"-inf\" and \"nan\".\n\n"
      "  id                            any value, which is copied to the answer\n"
      "  a, b                          two shapes: overlap, signed distance, points; convex unless "
      "one moves\n"
      "  ray, target                   a ray on a convex shape\n"
      "  motion                        features of a mesh that move\n"
      "  pose                          of each shape and child; the identity if missing\n"
      "  end_pose                      of a or b: the answer is the time of impact\n"
      "  compound.children             shapes, each with a pose\n";
  std::vector<std::string> lines;
  visit_members([&](const char* object, const Member& member) {
    std::string name =
        "  " + (member.name == kRounding.name ? "" : std::string(object) + ".") + member.name;
    name.resize(std::max<std::size_t>(name.size() + 1, 32), ' ');
    lines.push_back(name + member.rule->expected + ": " + member.meaning + "\n");
    if (std::find(lines.begin(), lines.end() - 1, lines.back()) == lines.end() - 1) {
      text += lines.back();
    }
  });
  return text;
}

}  // namespace winnow::bench
