// The format of queries in JSON as tables of members. By them `is_readable` checks types before
// shape_json.cpp and questions.cpp read a query, `fault_of` explains why a query is refused, and
// `query_format` writes the help of `winnow query`.

#include "bench/questions/query_format.h"

#include "bench/questions/shape_json.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace winnow::bench {
namespace {

/// A condition on a value: on its type, on each element of an array, and on the range of numbers.
struct Rule {
  const char* expected;
  bool (*has_type)(const Json& value);
  const Rule* element = nullptr;
  bool (*is_in_range)(const Json& value) = nullptr;  ///< called only if the type is right
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

/// Returns the number, or NaN if the value is none.
double number_of(const Json& value) {
  double number = std::nan("");
  static_cast<void>(read_exact_number(value, number));
  return number;
}
bool is_number(const Json& value) {
  double number = 0.0;
  return read_number(value, number);
}
bool is_exact(const Json& value) {
  double number = 0.0;
  return read_exact_number(value, number);
}
bool is_finite(const Json& value) {
  return std::isfinite(number_of(value));
}
bool is_length(const Json& value) {
  return is_finite(value) && number_of(value) >= 0.0;
}
bool is_not_negative(const Json& value) {
  return number_of(value) >= 0.0;
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
bool has_no_zero(const Json& value) {
  return std::none_of(value.begin(), value.end(), [](const Json& one) { return one == 0.0; });
}
/// Returns whether the rows of an array that are arrays have equal lengths.
bool has_equal_rows(const Json& value) {
  return is_list(value) && std::all_of(value.begin(), value.end(), [&](const Json& row) {
           return !row.is_array() || !value[0].is_array() || row.size() == value[0].size();
         });
}
bool is_index(const Json& value) {
  return value.is_number_unsigned();
}
bool is_kind_of_features(const Json& value) {
  return value == "vertex_face" || value == "edge_edge";
}

constexpr Rule kNumber{"a finite number", is_number, nullptr, is_finite};
constexpr Rule kLength{"a finite number >= 0", is_number, nullptr, is_length};
constexpr Rule kRayEnd{"a number >= 0, or \"inf\"", is_number, nullptr, is_not_negative};
constexpr Rule kExact{"a finite number, or a string such as \"0x1.8p+1\"", is_exact, nullptr,
                      is_finite};
constexpr Rule kSeparation{"a finite number >= 0, or a string such as \"0x1.8p+1\"", is_exact,
                           nullptr, is_length};
constexpr Rule kVector{"three numbers [x, y, z]", has_size<3>, &kNumber};
constexpr Rule kDirection{"three numbers [x, y, z], not all 0", has_size<3>, &kNumber, has_nonzero};
constexpr Rule kQuaternion{"four numbers [w, x, y, z], not all 0", has_size<4>, &kNumber,
                           has_nonzero};
constexpr Rule kLengths3{"three numbers >= 0", has_size<3>, &kLength};
constexpr Rule kLengths2{"two numbers >= 0", has_size<2>, &kLength};
constexpr Rule kSpacing{"two numbers > 0", has_size<2>, &kLength, has_no_zero};
constexpr Rule kPoints{"an array of points [x, y, z]", is_list, &kVector};
constexpr Rule kThreePoints{"three points [x, y, z]", has_size<3>, &kVector};
constexpr Rule kIndex{"an index of a point, from 0", is_index};
constexpr Rule kCorners{"three indices [i, j, k]", has_size<3>, &kIndex};
constexpr Rule kTriangles{"an array of triangles [i, j, k]", is_list, &kCorners};
constexpr Rule kRow{"an array of numbers", is_list, &kNumber};
constexpr Rule kRows{"rows with equally many numbers", has_equal_rows, &kRow};
constexpr Rule kExactPoint{"three numbers [x, y, z]", has_size<3>, &kExact};
constexpr Rule kFourPoints{"four points [x, y, z]", has_size<4>, &kExactPoint};
constexpr Rule kFeatures{"\"vertex_face\" or \"edge_edge\"", is_kind_of_features};

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

using Fault = std::optional<QueryFault>;

enum class Allowed { convex, child, any };

/// Each function returns the first fault, or nothing.
class FormatCheck {
 public:
  /// Without `ranges` only types are checked.
  explicit FormatCheck(bool ranges) : ranges_(ranges) {}

  [[nodiscard]] Fault members(const Json& object, std::span<const Member> members,
                              const std::string& path) const {
    if (!object.is_object()) return fault_at(path, "an object", object);
    for (const Member& one : members) {
      if (Fault fault = member_of(object, one, path)) return fault;
    }
    return {};
  }
  [[nodiscard]] Fault member_of(const Json& object, const Member& member,
                                const std::string& path) const {
    if (object.contains(member.name)) {
      return value(object[member.name], *member.rule, joined(path, member.name));
    }
    if (!member.required) return {};
    return fault_at(joined(path, member.name), member.rule->expected, Json::value_t::discarded);
  }
  [[nodiscard]] Fault shape(const Json& shape, Allowed allowed, const std::string& path) const {
    if (!shape.is_object()) return fault_at(path, "a shape, {\"type\": ...}", shape);
    for (const char* const pose : {"pose", "end_pose"}) {
      if (!shape.contains(pose)) continue;
      if (Fault fault = members(shape[pose], kPose, joined(path, pose))) return fault;
    }
    const Json& type = member(shape, "type");
    if (allowed == Allowed::any && type == "compound") return children(shape, path);
    std::string types;
    for (const auto* const formats : {&kConvex, &kComposite}) {
      if (allowed == Allowed::convex && formats == &kComposite) break;
      for (const ShapeFormat& format : *formats) {
        types += (types.empty() ? "" : ", ") + std::string(format.type);
        if (type != format.type) continue;
        Fault fault = members(shape, format.members, path);
        return fault || type != "mesh" ? fault : indices(shape, path);
      }
    }
    if (allowed == Allowed::any) types += ", compound";
    return fault_at(joined(path, "type"), "one of " + types,
                    shape.contains("type") ? type : Json(Json::value_t::discarded));
  }

 private:
  [[nodiscard]] Fault value(const Json& value, const Rule& rule, const std::string& path) const {
    const bool is_right = rule.has_type(value);
    for (std::size_t i = 0; is_right && rule.element != nullptr && i < value.size(); ++i) {
      const std::string element = path + "[" + std::to_string(i) + "]";
      if (Fault fault = this->value(value[i], *rule.element, element)) return fault;
    }
    if (is_right && (!ranges_ || rule.is_in_range == nullptr || rule.is_in_range(value))) return {};
    return fault_at(path, rule.expected, value);
  }
  /// The pool accepts only indices of vertices.
  [[nodiscard]] Fault indices(const Json& mesh, const std::string& path) const {
    const std::size_t count = mesh["v"].size();
    const Json& triangles = mesh["triangles"];
    for (std::size_t i = 0; ranges_ && i < triangles.size(); ++i) {
      for (const Json& corner : triangles[i]) {
        if (corner.get<std::uint64_t>() < count) continue;
        return fault_at(path + ".triangles[" + std::to_string(i) + "]",
                        "indices below " + std::to_string(count), triangles[i]);
      }
    }
    return {};
  }
  [[nodiscard]] Fault children(const Json& shape, const std::string& path) const {
    const std::string list = joined(path, "children");
    const Json nothing(Json::value_t::discarded);
    const Json& children = shape.contains("children") ? shape["children"] : nothing;
    if (!is_list(children)) return fault_at(list, "an array of shapes", children);
    for (std::size_t i = 0; i < children.size(); ++i) {
      const std::string child = list + "[" + std::to_string(i) + "]";
      if (Fault fault = this->shape(children[i], Allowed::child, child)) return fault;
    }
    return {};
  }

  bool ranges_;
};

Fault fault_of_shape(const Json& query, const char* name, Allowed allowed) {
  if (query.contains(name)) return FormatCheck(true).shape(query[name], allowed, name);
  return fault_at(name, "a shape, {\"type\": ...}", Json::value_t::discarded);
}

}  // namespace

std::optional<QueryFault> fault_of(const Json& query) {
  const FormatCheck check(true);
  if (!query.is_object()) return fault_at("", "an object", query);
  if (query.contains("ray")) {
    if (Fault fault = check.members(query["ray"], kRay, "ray")) return fault;
    return fault_of_shape(query, "target", Allowed::convex);
  }
  if (query.contains("motion")) {
    if (Fault fault = check.members(query["motion"], kMotion, "motion")) return fault;
    return check.member_of(query, kMinSeparation, "");
  }
  if (!query.contains("a") && !query.contains("b")) {
    return fault_at("", "the members \"a\" and \"b\", \"ray\" and \"target\", or \"motion\"",
                    query);
  }
  const bool moves = has_end_pose(member(query, "a")) || has_end_pose(member(query, "b"));
  const Allowed allowed = moves ? Allowed::any : Allowed::convex;
  if (Fault fault = fault_of_shape(query, "a", allowed)) return fault;
  return fault_of_shape(query, "b", allowed);
}

bool is_readable(const Json& value, QueryPart part) {
  const FormatCheck check(false);
  switch (part) {
    case QueryPart::convex_shape:
      return !check.shape(value, Allowed::convex, "");
    case QueryPart::any_shape:
      return !check.shape(value, Allowed::any, "");
    case QueryPart::ray:
      return !check.members(value, kRay, "");
    default:
      return !check.members(member(value, "motion"), kMotion, "") &&
             !check.member_of(value, kMinSeparation, "");
  }
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
