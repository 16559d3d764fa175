// Tests of `winnow dev goals`: how a goal is computed from rows, and that the file of goals can be
// read.

#include "bench/goals/evaluate.h"
#include "bench/goals/goal_entries.h"
#include "bench/goals/measurements.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// Declares two kinds at two levels, and another library for one of them.
void measure_example(const Json& options, MeasurementCache& /*measurement_cache*/,
                     Measured& measured) {
  if (options.contains("refuse")) throw std::runtime_error("refused");
  measured.absent = options.contains("absent");
  measured.machine_ms = 46.0;  // twice as slow as the machine of the other libraries
  measured.results.declare(
      {"times", "s", "t", {"kind", "level", "engine"}, {{"ns", "time", "ns"}}});
  const auto add = [&](const char* kind, const char* level, const char* engine, double ns) {
    measured.results.add("times",
                         {{"kind", kind}, {"level", level}, {"engine", engine}, {"ns", ns}});
  };
  add("box", "low", "own", 10.0);
  add("box", "high", "own", 40.0);
  add("ball", "low", "own", 2.0);
  add("ball", "high", "own", 3.0);
  add("box", "low", "Bullet", 50.0);
}

std::vector<Goal> goals_of(const std::string& members) {
  const auto entries =
      parse_goals(R"({"lists": {}, "goals": [{"topic": "engine", "what": "{kind}",)"
                  R"( "unit": "ns", "measure": {"example": {}}, )" +
                  members + "}]}");
  MeasurementCache measurement_cache;
  return evaluate(entries.at(0), measurement_cache);
}

TEST(Goals, goal_computes_the_least_most_and_sum) {
  const std::string own = R"("of": "times", "where": {"peer": false}}, "at_most": 10)";
  EXPECT_EQ(goals_of(R"("value": {"least": "ns", )" + own).at(0).measured, 2.0);
  EXPECT_EQ(goals_of(R"("value": {"most": "ns", )" + own).at(0).measured, 40.0);
  EXPECT_EQ(goals_of(R"("value": {"sum": "ns", )" + own).at(0).measured, 55.0);
  EXPECT_TRUE(goals_of(R"("value": {"least": "ns", )" + own).at(0).holds());
  EXPECT_FALSE(goals_of(R"("value": {"sum": "ns", )" + own).at(0).holds());
}

TEST(Goals, goals_by_key_take_the_worst_of_others) {
  const auto goals = goals_of(
      R"("value": {"the": "ns", "of": "times", "where": {"engine": "own", "level": "high"}},
         "over": {"the": "ns", "of": "times", "where": {"engine": "own", "level": "low"}},
         "at_most": 3, "by": ["kind"])");
  ASSERT_EQ(goals.size(), 2U);
  EXPECT_EQ(goals[0].what, "box");
  EXPECT_EQ(goals[0].measured, 4.0);
  EXPECT_FALSE(goals[0].holds());
  EXPECT_EQ(goals[1].measured, 1.5);
  const auto worst = goals_of(
      R"("value": {"most": "ns", "of": "times", "where": {"engine": "own"}},
         "over": {"least": "ns", "of": "times", "where": {"engine": "own"}},
         "at_least": 3, "worst_by": ["kind"])");
  ASSERT_EQ(worst.size(), 1U);
  EXPECT_EQ(worst[0].measured, 1.5);
  EXPECT_FALSE(worst[0].holds());
}

TEST(Goals, median_is_taken_over_the_values_by_key) {
  const auto goals = goals_of(
      R"("value": {"the": "ns", "of": "times", "where": {"engine": "own", "kind": "box"}},
         "at_most": 30, "median_by": ["level"])");
  ASSERT_EQ(goals.size(), 1U);
  EXPECT_EQ(goals[0].measured, 25.0);
  EXPECT_TRUE(goals[0].holds());
}

TEST(Goals, times_of_another_machine_are_scaled) {
  const std::string value = R"("value": {"least": "ns", "of": "times"}, "at_most": )";
  EXPECT_EQ(goals_of(value + R"({"existing": 6, "divided_by": 3})").at(0).bound, 4.0);
  EXPECT_EQ(goals_of(value + R"({"least_of": [{"existing": 30},
                              {"least": "ns", "of": "times", "where": {"peer": true}}]})")
                .at(0)
                .bound,
            50.0);
  EXPECT_EQ(goals_of(value + R"({"least": "ns", "of": "times", "where": {"engine": "FCL"},
                              "else_existing": 7})")
                .at(0)
                .bound,
            14.0);
}

TEST(Goals, goal_without_rows_fails_unless_optional) {
  const std::string without_rows =
      R"("value": {"the": "ns", "of": "times", "where": {"engine": "FCL"}}, "at_most": 1)";
  ASSERT_EQ(goals_of(without_rows).size(), 1U);
  EXPECT_FALSE(goals_of(without_rows).at(0).holds());
  EXPECT_TRUE(goals_of(without_rows + R"(, "optional": true)").empty());
  MeasurementCache measurement_cache;
  Json entry{{"topic", "engine"}, {"what", ""}, {"unit", ""}, {"value", 1}, {"at_least", 0}};
  entry["measure"] = {{"example", {{"refuse", true}}}};
  EXPECT_FALSE(evaluate(entry, measurement_cache).at(0).holds());
  entry["measure"] = {{"example", {{"absent", true}}}};
  EXPECT_TRUE(evaluate(entry, measurement_cache).empty());
}

TEST(GoalEntries, entries_with_lists_expand_to_all_combinations) {
  const auto entries = parse_goals(R"({"lists": {"sizes": [{"objects": 1000}, {"objects": 20}]},
    "goals": [{"topic": "engine", "each": ["sizes", [{"threads": 1}, {"threads": 2}]],
              "only": {"objects": [1000]}, "what": "{objects} objects, {threads}", "unit": "",
              "measure": {"example": {"objects": "{objects}"}}, "value": 1, "at_most": 1}]})");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[1]["what"], "1,000 objects, 2 threads");
  EXPECT_EQ(entries[1]["measure"]["example"]["objects"], 1000);
}

TEST(GoalEntries, entries_of_the_goals_file_are_read) {
  EXPECT_GT(parse_goals(kGoalsJson).size(), 300U);
  EXPECT_THROW((void)parse_goals(R"({"lists": {}, "goals": [{"topic": "none"}]})"),
               std::runtime_error);
}

}  // namespace

const Measurer* find_measurer(const std::string& name) {
  static const Measurer kExample = measure_example;
  return name == "example" ? &kExample : nullptr;
}

}  // namespace winnow::bench
