#include "bench/questions/motion_json.h"

#include <winnow/pipeline/feature_impacts.h>
#include "bench/questions/query_format.h"
#include "bench/questions/shape_json.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>

namespace winnow::bench {
namespace {

/// Reads a hexadecimal number such as "0x1.8p+1", with or without a sign, that fills the whole
/// text.
bool read_hexadecimal(const std::string& text, double& out) {
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  if (text.compare(sign, 2, "0x") != 0 && text.compare(sign, 2, "0X") != 0) return false;
  char* end = nullptr;
  out = std::strtod(text.c_str(), &end);
  return end == text.c_str() + text.size() && std::isfinite(out);
}

std::array<Vec3d, 4> four_points(const Json& value) {
  std::array<Vec3d, 4> points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      static_cast<void>(read_exact_number(value[k][axis], points[k][axis]));
    }
  }
  return points;
}

}  // namespace

bool read_exact_number(const Json& value, double& out) {
  return read_number(value, out) ||
         (value.is_string() && read_hexadecimal(value.get_ref<const std::string&>(), out));
}

Status answer_motion(const Json& question, Json& answer) {
  if (!is_readable(question, QueryPart::motion)) return Status::invalid_argument;
  const Json& motion = question["motion"];
  const FeaturePair pair =
      motion["kind"] == "vertex_face" ? FeaturePair::vertex_face : FeaturePair::edge_edge;
  FeatureImpactOptions options;
  static_cast<void>(read_exact_number(member(question, "min_separation"), options.min_separation));
  FeatureImpact impact;
  const Status status = feature_impact(pair, four_points(motion["start"]),
                                       four_points(motion["end"]), impact, options);
  if (status != Status::ok) return status;
  answer["status"] = to_string(status);
  answer["hit"] = impact.hit;
  answer["time"] = number_to_json(impact.time);
  return status;
}

}  // namespace winnow::bench
