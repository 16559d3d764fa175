#include "bench/questions/hard_cases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow::bench {
namespace {

/// NaN for what is no number, which no comparison below accepts.
double number(const Json& value) {
  double result = std::nan("");
  static_cast<void>(read_number(value, result));
  return result;
}

Eigen::Vector3d vector(const Json& value) {
  return {number(value[0]), number(value[1]), number(value[2])};
}

/// The largest length that a shape is made of.
double size_of(const Json& shape) {
  double size = shape.value("rounding", 0.0);
  for (const char* name : {"radius", "half_length"}) {
    if (shape.contains(name)) size += number(shape[name]);
  }
  if (shape.contains("half")) size += vector(shape["half"]).norm();
  if (shape.contains("v")) {
    for (const Json& v : shape["v"]) size = std::max(size, vector(v).norm());
  }
  return size;
}

/// Sine of 0.01 degrees.
constexpr double kNormalError = 1.7453292430883947e-4;

std::string fault_of_normal(const Json& expect, const Json& answer) {
  const Eigen::Vector3d n = vector(answer["normal"]);
  if (!(std::abs(n.norm() - 1.0) <= 1e-5)) return "normal not unit";
  if (!expect.contains("normal")) return {};
  const Eigen::Vector3d expected = vector(expect["normal"]);
  return n.cross(expected).norm() <= kNormalError && n.dot(expected) > 0.0 ? "" : "normal";
}

/// Numbers of the answer against what is true and allowed.
std::string fault_of_numbers(const Json& question, const Json& answer, double promised,
                             CaseVerdict& verdict) {
  const Json& expect = question["expect"];
  const double truth = number(expect["distance"]);
  // The truth in the file is rounded to the nearest double, at least.
  const double slack = expect.value("tolerance", 0.0) + 0x1p-52 * std::abs(truth);
  const double scale = size_of(question["a"]) + size_of(question["b"]) + std::abs(truth);
  const double error = std::abs(number(answer["distance"]) - truth);
  const double allowed = promised * scale + slack;
  if (scale > 0.0) verdict.error = error / scale;
  if (allowed > 0.0) verdict.over_allowed = error / allowed;
  if (answer["overlap"] != expect["overlap"]) {
    return expect["overlap"] ? kContactLost : kFalseContact;
  }
  if (std::isnan(error)) return "no distance";
  if (!(error <= allowed)) return "distance";
  if (!(error <= number(answer["error_bound"]) + slack)) return "error above its bound";
  return fault_of_normal(expect, answer);
}

std::string fault_of_ray(const Json& question, const Json& answer) {
  const Json& expect = question["expect"];
  if (answer["hit"] != expect["hit"]) return expect["hit"] ? "hit lost" : "false hit";
  if (!expect["hit"]) return {};
  const double truth = number(expect["t"]);
  const double error = std::abs(number(answer["t"]) - truth);
  if (!(error <= 1e-14 * std::abs(truth) + expect.value("tolerance", 0.0))) return "t";
  return fault_of_normal(expect, answer);
}

}  // namespace

CaseVerdict judge_case(const Json& question, const Json& answer, double promised) {
  const Json& expect = question["expect"];
  const std::string status = expect.value("status", "ok");
  CaseVerdict verdict;
  if (answer["id"] != question["id"]) {
    verdict.fault = "id";
  } else if (answer["status"] != status) {
    verdict.fault = "status";
  } else if (status != "ok") {
    verdict.fault = answer.size() == 2 ? "" : "says more than the status";
  } else if (question.contains("ray")) {
    verdict.fault = fault_of_ray(question, answer);
  } else {
    verdict.fault = fault_of_numbers(question, answer, promised, verdict);
  }
  return verdict;
}

double promised_error(NarrowTier tier) {
  switch (tier) {
    case NarrowTier::fast:
      return 1e-4;
    case NarrowTier::robust:
      return 4e-7;
    case NarrowTier::reference:
      return 1e-12;
  }
  return 0.0;
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
