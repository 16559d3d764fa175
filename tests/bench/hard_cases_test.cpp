// Tests the cases of tests/hard_cases/*.json through the interface of `winnow query`.

#include "bench/questions/hard_cases.h"
#include <winnow/simd/isa.h>
#include "bench/questions/questions.h"
#include "tests/support/config.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#if WINNOW_HAVE_ORACLE
#include "bench/oracle/oracle.h"
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

const char* name_of(NarrowTier tier) {
  return tier == NarrowTier::robust ? "robust" : "reference";
}

int count_faults(const Json& questions, NarrowTier tier, bool report) {
  const Json answers = answer(questions, tier);
  EXPECT_EQ(answers.size(), questions.size());
  int faults = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const std::string what =
        check_hard_case(questions[i], answers[i], guaranteed_error(tier)).fault;
    if (what.empty()) continue;
    ++faults;
    if (report) {
      ADD_FAILURE() << what << ", tier " << name_of(tier) << "\n"
                    << questions[i].dump().substr(0, 1000) << "\n"
                    << answers[i];
    }
  }
  return faults;
}

class HardCases : public testing::TestWithParam<Path> {};

TEST_P(HardCases, robust_and_reference_tiers_have_no_faults) {
  const Json cases = read_cases(GetParam());
  for (const Isa isa : available_isas()) {
    const test::IsaScope scope(isa);
    for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
      for (const Json& questions : {cases, exchanged(cases)}) {
        EXPECT_EQ(count_faults(questions, tier, isa == available_isas().front()), 0)
            << name_of(tier) << " on " << to_string(isa);
      }
    }
  }
}

#if WINNOW_HAVE_ORACLE
/// Checks the expected values of the files, which were derived by hand, against the oracle.
TEST_P(HardCases, expected_values_agree_with_the_oracle) {
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
    const double distance = expect["distance"].get<double>();
    EXPECT_EQ(truth.overlap, expect["overlap"].get<bool>()) << question["id"];
    EXPECT_NEAR(static_cast<double>(truth.distance), distance,
                expect.value("tolerance", 0.0) + 0x1p-52 * std::abs(distance))
        << question["id"];
    if (!expect.contains("normal")) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(truth.normal[axis], expect["normal"][axis].get<double>(), 1e-4) << question["id"];
    }
  }
}
#endif

TEST(HardCaseFiles, compiled_cases_equal_the_files) {
  Json read = Json::object();
  for (const Path& file : case_files()) read[file.stem().string()] = read_cases(file);
  EXPECT_EQ(hard_cases(), read);
}

TEST(HardCaseVerdicts, verdict_reports_the_size_of_the_error) {
  const Json question = {{"id", 1},
                         {"a", {{"type", "sphere"}, {"radius", 1.0}}},
                         {"b", {{"type", "sphere"}, {"radius", 1.0}}},
                         {"expect", {{"overlap", false}, {"distance", 2.0}}}};
  Json reported = {{"id", 1},
                   {"status", "ok"},
                   {"overlap", false},
                   {"distance", 2.0 + 4e-3},
                   {"normal", {1, 0, 0}},
                   {"error_bound", "inf"}};
  const CaseVerdict verdict = check_hard_case(question, reported, 1e-4);
  EXPECT_EQ(verdict.fault, "distance");
  EXPECT_NEAR(verdict.error, 1e-3, 1e-12);
  EXPECT_NEAR(verdict.over_allowed, 10.0, 1e-9);
  reported["overlap"] = true;
  EXPECT_EQ(check_hard_case(question, reported, 1e-2).fault, kFalseContact);
  reported["distance"] = "nan";
  reported["overlap"] = false;
  EXPECT_EQ(check_hard_case(question, reported, 1e-2).fault, "no distance");
}

std::string family_of(const testing::TestParamInfo<Path>& file) {
  return file.param.stem().string();
}

INSTANTIATE_TEST_SUITE_P(Families, HardCases, testing::ValuesIn(case_files()), family_of);

}  // namespace
}  // namespace winnow::bench
