// The format of queries in JSON, which format.json lists. By it `is_readable` checks types before
// shape_json.cpp and questions.cpp read a query, `fault_of` explains why a query is refused, and
// `query_format` writes the help of `winnow query`.

#include "bench/questions/query_format.h"

#include "bench/questions/shape_json.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace winnow::bench {

extern const char* const kQueryFormat;  // the text of format.json

namespace {

/// Returns format.json, which lists:
/// - "rules": conditions on values. A value is a "number", an "exact" number, an "index", one of
///   "values", or a list "of" a rule. A number is "finite" and has a "least" value; a list has a
///   "size", or at least one element, "nonzero" elements, and "equal_rows".
/// - "members": rules and meanings of members, by their names. A name with a type precedes.
/// - "convex", "composite", "other": the members of each type of shape, and of other objects.
const Json& format() {
  static const Json format = Json::parse(kQueryFormat);
  return format;
}

/// Returns the entry of a member in format.json.
const Json& entry_of(const std::string& object, const std::string& name) {
  const Json& members = format()["members"];
  const auto at = members.find(object + "." + name);
  return at != members.end() ? *at : members[name];
}
const Json& rule_of(const Json& entry) {
  return format()["rules"][entry["rule"].get_ref<const std::string&>()];
}

/// Calls `visit(object, name of the member)` for each member of each object, in the order of the
/// help.
template <typename Visit>
void visit_members(Visit&& visit) {
  for (const char* const group : {"convex", "composite", "other"}) {
    for (const auto& [object, names] : format()[group].items()) {
      for (const std::string name : names) visit(object, name);
    }
  }
}

/// Returns the number, or NaN if the value is none.
double number_of(const Json& value) {
  double number = std::nan("");
  static_cast<void>(read_exact_number(value, number));
  return number;
}

/// Returns whether the rows of an array that are arrays have equal lengths.
bool has_equal_rows(const Json& value) {
  return std::all_of(value.begin(), value.end(), [&](const Json& row) {
    return !row.is_array() || !value[0].is_array() || row.size() == value[0].size();
  });
}

/// Returns whether the type of a value, but not of its elements, is right.
bool has_type(const Json& rule, const Json& value) {
  double number = 0.0;
  const Json& type = member(rule, "type");
  if (type == "number") return read_number(value, number);
  if (type == "exact") return read_exact_number(value, number);
  if (type == "index") return value.is_number_unsigned();
  if (const Json& values = member(rule, "values"); !values.is_null()) {
    return std::find(values.begin(), values.end(), value) != values.end();
  }
  if (!value.is_array() || value.empty()) return false;
  if (rule.contains("equal_rows") && !has_equal_rows(value)) return false;
  return !rule.contains("size") || value.size() == rule["size"];
}

/// Returns whether a value of the right type is in the range.
bool is_in_range(const Json& rule, const Json& value) {
  if (rule.contains("finite") && !std::isfinite(number_of(value))) return false;
  if (rule.contains("least") && !(number_of(value) >= rule["least"].get<double>())) return false;
  if (!rule.contains("nonzero")) return true;
  const auto is_nonzero = [](const Json& one) { return one != 0.0; };
  return rule["nonzero"] == "all" ? std::all_of(value.begin(), value.end(), is_nonzero)
                                  : std::any_of(value.begin(), value.end(), is_nonzero);
}

std::string shortened(const Json& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kLongest) text.replace(kLongest, std::string::npos, "...");
  return text;
}

QueryFault fault_at(const std::string& path, std::string expected, const Json& value) {
  return {path, std::move(expected), value.is_discarded() ? "nothing" : shortened(value)};
}

std::string joined(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

using Fault = std::optional<QueryFault>;

enum class Allowed { convex, child, any };

/// Each function returns the first fault, or nothing.
class FormatCheck {
 public:
  /// Without `ranges` only types are checked.
  explicit FormatCheck(bool ranges) : ranges_(ranges) {}

  /// Checks the members that format.json lists for a type of shape, in "convex" or "composite", or
  /// for an object in "other".
  [[nodiscard]] Fault members(const Json& object, const char* group, const std::string& type,
                              const std::string& path) const {
    if (!object.is_object()) return fault_at(path, "an object", object);
    for (const std::string name : format()[group][type]) {
      const Json& entry = entry_of(type, name);
      const std::string place = joined(path, name);
      if (object.contains(name)) {
        if (Fault fault = value(object[name], rule_of(entry), place)) return fault;
      } else if (!entry.contains("optional")) {
        return fault_at(place, rule_of(entry)["expected"], Json::value_t::discarded);
      }
    }
    return {};
  }
  [[nodiscard]] Fault shape(const Json& shape, Allowed allowed, const std::string& path) const {
    if (!shape.is_object()) return fault_at(path, "a shape, {\"type\": ...}", shape);
    for (const char* const pose : {"pose", "end_pose"}) {
      if (!shape.contains(pose)) continue;
      if (Fault fault = members(shape[pose], "other", "pose", joined(path, pose))) return fault;
    }
    const Json& type = member(shape, "type");
    if (allowed == Allowed::any && type == "compound") return children(shape, path);
    std::string types;
    for (const char* const group : {"convex", "composite"}) {
      if (allowed == Allowed::convex && group != std::string_view("convex")) break;
      for (const auto& [name, names] : format()[group].items()) {
        types += (types.empty() ? "" : ", ") + name;
        if (type != name) continue;
        Fault fault = members(shape, group, name, path);
        return fault || type != "mesh" ? fault : indices(shape, path);
      }
    }
    if (allowed == Allowed::any) types += ", compound";
    return fault_at(joined(path, "type"), "one of " + types,
                    shape.contains("type") ? type : Json(Json::value_t::discarded));
  }

 private:
  [[nodiscard]] Fault value(const Json& value, const Json& rule, const std::string& path) const {
    const bool is_right = has_type(rule, value);
    for (std::size_t i = 0; is_right && rule.contains("of") && i < value.size(); ++i) {
      const Json& element = format()["rules"][rule["of"].get_ref<const std::string&>()];
      if (Fault fault = this->value(value[i], element, path + "[" + std::to_string(i) + "]")) {
        return fault;
      }
    }
    if (is_right && (!ranges_ || is_in_range(rule, value))) return {};
    return fault_at(path, rule["expected"], value);
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
    if (!children.is_array() || children.empty()) {
      return fault_at(list, "an array of shapes", children);
    }
    for (std::size_t i = 0; i < children.size(); ++i) {
      const std::string child = list + "[" + std::to_string(i) + "]";
      if (Fault fault = this->shape(children[i], Allowed::child, child)) return fault;
    }
    return {};
  }

  bool ranges_;
};

Fault fault_of_shape(const Json& query, const char* name) {
  if (query.contains(name)) return FormatCheck(true).shape(query[name], Allowed::any, name);
  return fault_at(name, "a shape, {\"type\": ...}", Json::value_t::discarded);
}

}  // namespace

std::optional<QueryFault> fault_of(const Json& query) {
  const FormatCheck check(true);
  if (!query.is_object()) return fault_at("", "an object", query);
  if (query.contains("ray")) {
    if (Fault fault = check.members(query["ray"], "other", "ray", "ray")) return fault;
    return fault_of_shape(query, "target");
  }
  if (query.contains("motion")) {
    if (Fault fault = check.members(query["motion"], "other", "motion", "motion")) return fault;
    return check.members(query, "other", "query", "");
  }
  if (!query.contains("a") && !query.contains("b")) {
    return fault_at("", "the members \"a\" and \"b\", \"ray\" and \"target\", or \"motion\"",
                    query);
  }
  if (Fault fault = check.members(query, "other", "pair", "")) return fault;
  if (Fault fault = fault_of_shape(query, "a")) return fault;
  return fault_of_shape(query, "b");
}

bool is_readable(const Json& value, QueryPart part) {
  const FormatCheck check(false);
  switch (part) {
    case QueryPart::convex_shape:
      return !check.shape(value, Allowed::convex, "");
    case QueryPart::any_shape:
      return !check.shape(value, Allowed::any, "");
    case QueryPart::ray:
      return !check.members(value, "other", "ray", "");
    case QueryPart::pair:
      return !check.members(value, "other", "pair", "");
    default:
      return !check.members(member(value, "motion"), "other", "motion", "") &&
             !check.members(value, "other", "query", "");
  }
}

std::vector<std::string> query_words() {
  std::vector<std::string> words{"id",     "a",    "b",        "ray",      "target",
                                 "motion", "pose", "end_pose", "compound", "children"};
  visit_members([&](const std::string& object, const std::string& name) {
    words.push_back(object);
    words.push_back(name);
  });
  return words;
}

std::string query_format() {
  std::string text =
      "The file is an array of queries. This example has every member; `winnow query` answers "
      "it:\n\n" +
      std::string(kQueryExample) +
      "\nAll lengths are in one unit of your choice; points are [x,y,z]. Times run from 0 "
      "(\"pose\") "
      "to 1\n(\"end_pose\"). Numbers may also be \"inf\", \"-inf\" and \"nan\".\n\n"
      "  id                            any value, which is copied to the answer\n"
      "  a, b                          two shapes: overlap, signed distance, points\n"
      "  ray, target                   a ray on a shape\n"
      "  motion                        features of a mesh that move\n"
      "  pose                          of each shape and child; the identity if missing\n"
      "  end_pose                      of a or b: the answer is the time of impact\n"
      "  compound.children             shapes, each with a pose\n";
  std::vector<std::string> lines;
  visit_members([&](const std::string& object, const std::string& member) {
    const Json& entry = entry_of(object, member);
    std::string name = "  " + (member == "rounding" ? "" : object + ".") + member;
    name.resize(std::max<std::size_t>(name.size() + 1, 32), ' ');
    lines.push_back(name + rule_of(entry)["expected"].get<std::string>() + ": " +
                    entry["meaning"].get<std::string>() + "\n");
    if (std::find(lines.begin(), lines.end() - 1, lines.back()) == lines.end() - 1) {
      text += lines.back();
    }
  });
  return text;
}

}  // namespace winnow::bench
