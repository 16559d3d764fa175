#include "bench/questions/hard_cases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow::bench {
namespace {

/// Returns NaN if the value is not a number; every comparison below then fails.
double number(const Json& value) {
  double result = std::nan("");
  static_cast<void>(read_number(value, result));
  return result;
}

bool is_true(const Json& value) {
  return value.is_boolean() && value.get<bool>();
}

Eigen::Vector3d vector(const Json& value) {
  return {number(element(value, 0)), number(element(value, 1)), number(element(value, 2))};
}

/// Returns the shape's size, to which errors are relative: the sum of its lengths, or the distance
/// of its farthest vertex from the origin.
double size_of(const Json& shape) {
  double size = 0.0;
  for (const char* name : {"rounding", "radius", "half_length"}) {
    if (shape.contains(name)) size += number(shape[name]);
  }
  for (const Json& radius : member(shape, "radii")) size += number(radius);
  if (shape.contains("half")) size += vector(shape["half"]).norm();
  for (const Json& v : member(shape, "v")) size = std::max(size, vector(v).norm());
  return size;
}

double tolerance(const Json& expect) {
  return expect.contains("tolerance") ? number(member(expect, "tolerance")) : 0.0;
}

/// Sine of 0.01 degrees.
constexpr double kNormalError = 1.7453292430883947e-4;

std::string fault_of_normal(const Json& expect, const Json& answer) {
  const Eigen::Vector3d n = vector(member(answer, "normal"));
  if (!(std::abs(n.norm() - 1.0) <= 1e-5)) return "normal not unit";
  if (!expect.contains("normal")) return {};
  const Eigen::Vector3d expected = vector(member(expect, "normal"));
  return n.cross(expected).norm() <= kNormalError && n.dot(expected) > 0.0 ? "" : "normal";
}

/// Compares distance, overlap, error bound and normal of an answer with the expected values.
std::string fault_of_numbers(const Json& question, const Json& answer, double promised,
                             CaseVerdict& verdict) {
  const Json& expect = member(question, "expect");
  const double truth = number(member(expect, "distance"));
  // The expected distance in the file is itself rounded to the nearest double.
  const double slack = tolerance(expect) + 0x1p-52 * std::abs(truth);
  const double scale =
      size_of(member(question, "a")) + size_of(member(question, "b")) + std::abs(truth);
  const double error = std::abs(number(member(answer, "distance")) - truth);
  const double allowed = promised * scale + slack;
  if (scale > 0.0) verdict.error = error / scale;
  if (allowed > 0.0) verdict.over_allowed = error / allowed;
  if (member(answer, "overlap") != member(expect, "overlap")) {
    return is_true(member(expect, "overlap")) ? kContactLost : kFalseContact;
  }
  if (std::isnan(error)) return "no distance";
  if (!(error <= allowed)) return "distance";
  if (!(error <= number(member(answer, "error_bound")) + slack)) return "error above its bound";
  return fault_of_normal(expect, answer);
}

std::string fault_of_ray(const Json& question, const Json& answer) {
  const Json& expect = member(question, "expect");
  if (member(answer, "hit") != member(expect, "hit"))
    return is_true(member(expect, "hit")) ? "hit lost" : "false hit";
  if (!is_true(member(expect, "hit"))) return {};
  const double truth = number(member(expect, "t"));
  const double error = std::abs(number(member(answer, "t")) - truth);
  if (!(error <= 1e-14 * std::abs(truth) + tolerance(expect))) return "t";
  return fault_of_normal(expect, answer);
}

}  // namespace

CaseVerdict check_hard_case(const Json& question, const Json& answer, double promised) {
  const Json& expect = member(question, "expect");
  const Json status = expect.contains("status") ? expect["status"] : Json("ok");
  CaseVerdict verdict;
  if (member(answer, "id") != member(question, "id")) {
    verdict.fault = "id";
  } else if (member(answer, "status") != status) {
    verdict.fault = "status";
  } else if (status != "ok") {
    verdict.fault = answer.size() == 2 ? "" : "members besides the status";
  } else if (question.contains("ray")) {
    verdict.fault = fault_of_ray(question, answer);
  } else {
    verdict.fault = fault_of_numbers(question, answer, promised, verdict);
  }
  return verdict;
}

double guaranteed_error(NarrowTier tier) {
  return tier == NarrowTier::robust ? 4e-7 : 1e-12;
}

Json exchanged(const Json& questions) {
  Json turned = questions;
  for (Json& question : turned) {
    if (!question.contains("a") || !question.contains("b")) continue;
    std::swap(question["a"], question["b"]);
    if (!question.contains("expect") || !question["expect"].contains("normal")) continue;
    for (Json& n : question["expect"]["normal"]) n = number_to_json(-number(n));
  }
  return turned;
}

}  // namespace winnow::bench
