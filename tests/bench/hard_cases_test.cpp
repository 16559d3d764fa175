// Questions whose answers are known by reasoning, tests/hard_cases/*.json, asked as `winnow query`
// asks them. A case may also say "expect": a "status" other than ok, or what the answer is, with a
// "tolerance" where that had to be rounded.

#include <gtest/gtest.h>
#include <winnow/simd/isa.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../support/config.h"
#include "query/questions.h"

#if WINNOW_HAVE_ORACLE
#include "oracle/oracle.h"
#endif

namespace winnow::bench {
namespace {

using Path = std::filesystem::path;

std::vector<Path> case_files() {
  std::vector<Path> files;
  for (const auto& entry : std::filesystem::directory_iterator(WINNOW_HARD_CASES)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Json read_cases(const Path& file) {
  std::ifstream in(file);
  return Json::parse(in);
}

double number(const Json& value) {
  double result = std::nan("");
  EXPECT_TRUE(read_number(value, result)) << value;
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

struct Tier {
  NarrowTier tier;
  const char* name;
  double error;
};
constexpr Tier kFast{NarrowTier::fast, "fast", 1e-4};
constexpr Tier kRobust{NarrowTier::robust, "robust", 4e-7};
constexpr Tier kReference{NarrowTier::reference, "reference", 1e-12};
/// Sine of 0.01 degrees.
constexpr double kNormalError = 1.7453292430883947e-4;

std::string fault_of_normal(const Json& expect, const Json& answer, double sign) {
  const Eigen::Vector3d n = vector(answer["normal"]);
  if (!(std::abs(n.norm() - 1.0) <= 1e-5)) return "normal not unit";
  if (!expect.contains("normal")) return {};
  const Eigen::Vector3d expected = sign * vector(expect["normal"]);
  return n.cross(expected).norm() <= kNormalError && n.dot(expected) > 0.0 ? "" : "normal";
}

std::string fault_of_pair(const Json& question, const Json& answer, const Tier& tier, double sign) {
  const Json& expect = question["expect"];
  if (answer["overlap"] != expect["overlap"]) {
    return expect["overlap"] ? "contact lost" : "false contact";
  }
  const double truth = number(expect["distance"]);
  const double distance = number(answer["distance"]);
  const double bound = number(answer["error_bound"]);
  // The truth in the file is rounded to the nearest double, at least.
  const double slack = expect.value("tolerance", 0.0) + 0x1p-52 * std::abs(truth);
  const double size = size_of(question["a"]) + size_of(question["b"]);
  const double error = std::abs(distance - truth);
  if (!(error <= tier.error * (size + std::abs(truth)) + slack)) return "distance";
  if (!(error <= bound + slack)) return "error above its bound";
  return fault_of_normal(expect, answer, sign);
}

std::string fault_of_ray(const Json& question, const Json& answer) {
  const Json& expect = question["expect"];
  if (answer["hit"] != expect["hit"]) return expect["hit"] ? "hit lost" : "false hit";
  if (!expect["hit"]) return {};
  const double truth = number(expect["t"]);
  const double error = std::abs(number(answer["t"]) - truth);
  if (!(error <= 1e-14 * std::abs(truth) + expect.value("tolerance", 0.0))) return "t";
  return fault_of_normal(expect, answer, 1.0);
}

/// Empty if the answer is as expected.
std::string fault(const Json& question, const Json& answer, const Tier& tier, double sign) {
  const Json& expect = question["expect"];
  if (answer["id"] != question["id"]) return "id";
  const std::string status = expect.value("status", "ok");
  if (answer["status"] != status) return "status";
  if (status != "ok") return answer.size() == 2 ? "" : "says more than the status";
  return question.contains("ray") ? fault_of_ray(question, answer)
                                  : fault_of_pair(question, answer, tier, sign);
}

/// The faults of all cases, asked as they stand (sign 1) or with a and b exchanged (sign -1).
int count_faults(const Json& cases, const Tier& tier, double sign, bool report) {
  Json questions = cases;
  for (Json& question : questions) {
    if (sign < 0.0 && question.contains("a") && question.contains("b")) {
      std::swap(question["a"], question["b"]);
    }
  }
  const Json answers = answer(questions, tier.tier);
  EXPECT_EQ(answers.size(), cases.size());
  int faults = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::string what = fault(questions[i], answers[i], tier, sign);
    if (what.empty()) continue;
    ++faults;
    if (report) {
      ADD_FAILURE() << what << ", tier " << tier.name << (sign < 0.0 ? ", exchanged" : "") << "\n"
                    << questions[i].dump().substr(0, 1000) << "\n"
                    << answers[i];
    }
  }
  return faults;
}

class HardCases : public testing::TestWithParam<Path> {};

TEST_P(HardCases, are_right_in_robust_and_reference) {
  const Json cases = read_cases(GetParam());
  for (const Isa isa : available_isas()) {
    const test::IsaScope scope(isa);
    for (const Tier& tier : {kRobust, kReference}) {
      for (const double sign : {1.0, -1.0}) {
        EXPECT_EQ(count_faults(cases, tier, sign, isa == available_isas().front()), 0)
            << tier.name << " on " << to_string(isa);
      }
    }
  }
}

#if WINNOW_HAVE_ORACLE
/// What was reasoned is true.
TEST_P(HardCases, agree_with_the_oracle) {
  for (const Json& question : read_cases(GetParam())) {
    if (question["expect"].contains("status") || question.contains("ray")) continue;
    ShapePool pool;
    ShapeId shape[2];
    Pose pose[2];
    ASSERT_EQ(read_shape(question["a"], pool, shape[0], pose[0]), Status::ok) << question["id"];
    ASSERT_EQ(read_shape(question["b"], pool, shape[1], pose[1]), Status::ok) << question["id"];
    const auto truth = oracle::solve(pool.tables(), shape[0], pose[0], shape[1], pose[1]);
    if (!truth.known) continue;
    const Json& expect = question["expect"];
    const double distance = number(expect["distance"]);
    EXPECT_EQ(truth.overlap, expect["overlap"].get<bool>()) << question["id"];
    EXPECT_NEAR(static_cast<double>(truth.distance), distance,
                expect.value("tolerance", 0.0) + 0x1p-52 * std::abs(distance))
        << question["id"];
    if (!expect.contains("normal")) continue;
    const Eigen::Vector3d n(truth.normal[0], truth.normal[1], truth.normal[2]);
    EXPECT_LT((n - vector(expect["normal"])).norm(), 1e-4) << question["id"];
  }
}
#endif

std::string family_of(const testing::TestParamInfo<Path>& file) {
  return file.param.stem().string();
}

INSTANTIATE_TEST_SUITE_P(Families, HardCases, testing::ValuesIn(case_files()), family_of);

TEST(HardCaseTable, fast_is_printed) {
  std::size_t total = 0;
  std::size_t right = 0;
  for (const Path& file : case_files()) {
    const Json cases = read_cases(file);
    const auto faults = static_cast<std::size_t>(count_faults(cases, kFast, 1.0, false));
    std::printf("fast  %-22s %3zu of %3zu right\n", file.stem().c_str(), cases.size() - faults,
                cases.size());
    total += cases.size();
    right += cases.size() - faults;
  }
  std::printf("fast  %-22s %3zu of %3zu right\n", "all", right, total);
  EXPECT_GE(total, 150U);
}

}  // namespace
}  // namespace winnow::bench
