#include "bench/questions/motion_json.h"

#include <winnow/pipeline/feature_impacts.h>
#include "bench/questions/shape_json.h"

#include <charconv>
#include <string_view>
#include <system_error>

namespace winnow::bench {
namespace {

/// Reads a hexadecimal number such as "0x1.8p+1", with or without a sign, that fills the whole
/// text.
bool read_hexadecimal(std::string_view text, double& out) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (!text.starts_with("0x") && !text.starts_with("0X")) return false;
  text.remove_prefix(2);
  // std::from_chars would accept a second sign or the name of an infinity here.
  if (text.empty() || std::string_view("0123456789abcdefABCDEF.").find(text[0]) == text.npos) {
    return false;
  }
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value, std::chars_format::hex);
  if (read.ec != std::errc() || read.ptr != end) return false;
  out = negative ? -value : value;
  return true;
}

bool read_four_points(const Json& value, std::array<Vec3d, 4>& points) {
  if (!value.is_array() || value.size() != points.size()) return false;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!value[k].is_array() || value[k].size() != 3) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!read_exact_number(value[k][axis], points[k][axis])) return false;
    }
  }
  return true;
}

}  // namespace

bool read_exact_number(const Json& value, double& out) {
  return read_number(value, out) ||
         (value.is_string() && read_hexadecimal(value.get_ref<const std::string&>(), out));
}

Status answer_motion(const Json& question, Json& answer) {
  const Json& motion = member(question, "motion");
  const Json& kind = member(motion, "kind");
  std::array<Vec3d, 4> start;
  std::array<Vec3d, 4> end;
  FeatureImpactOptions options;
  if ((kind != "vertex_face" && kind != "edge_edge") ||
      !read_four_points(member(motion, "start"), start) ||
      !read_four_points(member(motion, "end"), end)) {
    return Status::invalid_argument;
  }
  if (question.contains("min_separation") &&
      !read_exact_number(question["min_separation"], options.min_separation)) {
    return Status::invalid_argument;
  }
  const FeaturePair pair =
      kind == "vertex_face" ? FeaturePair::vertex_face : FeaturePair::edge_edge;
  FeatureImpact impact;
  const Status status = feature_impact(pair, start, end, impact, options);
  if (status != Status::ok) return status;
  answer["status"] = to_string(status);
  answer["hit"] = impact.hit;
  answer["time"] = number_to_json(impact.time);
  return status;
}

}  // namespace winnow::bench
