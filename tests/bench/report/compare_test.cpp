// Tests of `winnow dev compare`: its verdicts (worse, better, noise, other pairs) and its exit
// status.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::ordered_json;

struct Times {
  double min;
  double median;
  double max;
  int samples = 11;
};

/// Returns a report of one row, which the tests modify.
Json report() {
  return Json::parse(R"({"format": "winnow report 1", "complete": true,
    "machine": {"processor": "some", "cores": 2, "isa": "wide", "reference_sweep_ms": 20.0},
    "settings": {"seed": 1, "quick": false, "objects": [100]},
    "missing": [], "problems": [], "sections": [],
    "tables": [{"name": "speed", "section": "s", "title": "t", "keys": ["engine"],
      "values": [{"name": "frame_ms", "label": "", "unit": "ms", "better": "less", "format": "number"},
                 {"name": "rate", "label": "", "unit": "1/s", "better": "more", "format": "number"},
                 {"name": "bytes", "label": "", "unit": "bytes", "better": "less", "format": "number"},
                 {"name": "worst_error", "label": "", "unit": "", "better": "less", "format": "number"},
                 {"name": "pairs", "label": "", "unit": "", "better": "neither", "format": "number"},
                 {"name": "fingerprint", "label": "", "unit": "", "better": "neither", "format": "number"}],
      "rows": [{"id": "speed/Grid", "engine": "Grid", "command": "bench/run x"}]}]})");
}

Json& row(Json& of) {
  return of["tables"][0]["rows"][0];
}

Json value(const Times& times) {
  return {
      {"min", times.min}, {"median", times.median}, {"max", times.max}, {"samples", times.samples}};
}

Json with(const std::string& name, const Json& set) {
  Json changed = report();
  row(changed)[name] = set;
  return changed;
}

struct Outcome {
  int status = -1;
  Json found;

  /// Returns the verdict on the only value that both reports have.
  [[nodiscard]] std::string verdict() const {
    return found["changes"].size() == 1 ? found["changes"][0]["verdict"].get<std::string>()
                                        : "not one change";
  }
  [[nodiscard]] double ratio() const { return found["changes"][0]["ratio"]; }
};

/// Runs the tool on two files with these texts.
Outcome compared(const std::string& before, const std::string& after,
                 const std::string& options = "") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("winnow_compare_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "old.json") << before;
  std::ofstream(folder / "new.json") << after;
  const std::string command = std::string("'") + WINNOW_TOOL + "' dev compare '" +
                              (folder / "old.json").string() + "' '" +
                              (folder / "new.json").string() + "' --json '" +
                              (folder / "out.json").string() + "' " + options + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, {}};
  if (std::ifstream file(folder / "out.json"); file) outcome.found = Json::parse(file);
  std::filesystem::remove_all(folder);
  return outcome;
}

Outcome compared(const Json& before, const Json& after, const std::string& options = "") {
  return compared(before.dump(), after.dump(), options);
}

Outcome compared_ms(const Times& before, const Times& after, const std::string& options = "") {
  return compared(with("frame_ms", value(before)), with("frame_ms", value(after)), options);
}

TEST(Compare, equal_reports_have_no_difference) {
  Json both = with("frame_ms", value({1.0, 1.1, 1.2}));
  row(both)["fingerprint"] = "0123";
  const Outcome outcome = compared(both, both);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.verdict(), "same");
  EXPECT_EQ(outcome.found["summaries"][0]["geometric_mean"], 1.0);
}

TEST(Compare, time_is_worse_if_all_samples_are) {
  const Outcome outcome = compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6});
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_NEAR(outcome.ratio(), 1.5 / 1.1, 1e-12);
  EXPECT_EQ(outcome.status, 1);
  const Outcome reverse = compared_ms({1.4, 1.5, 1.6}, {1.0, 1.1, 1.2});
  EXPECT_EQ(reverse.verdict(), "better");
  EXPECT_EQ(reverse.status, 0);
}

TEST(Compare, time_is_noise_if_the_best_sample_stays) {
  const Outcome outcome = compared_ms({1.0, 1.1, 1.2}, {1.0, 1.5, 3.0});
  EXPECT_EQ(outcome.verdict(), "noise");
  EXPECT_EQ(outcome.status, 0);
}

TEST(Compare, few_samples_are_noise) {
  EXPECT_EQ(compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6, 4}).verdict(), "noise");
  EXPECT_EQ(compared(with("frame_ms", 1.0), with("frame_ms", 2.0)).verdict(), "noise");
}

TEST(Compare, times_of_a_quick_report_are_noise) {
  Json quick = with("frame_ms", value({1.4, 1.5, 1.6}));
  quick["settings"]["quick"] = true;
  const Outcome outcome = compared(with("frame_ms", value({1.0, 1.1, 1.2})), quick);
  EXPECT_EQ(outcome.verdict(), "noise");
  EXPECT_FALSE(outcome.found["remarks"].empty());
}

TEST(Compare, threshold_given_by_option_decides) {
  EXPECT_EQ(compared_ms({1.0, 1.01, 1.02}, {1.08, 1.09, 1.1}).verdict(), "same");
  EXPECT_EQ(compared_ms({1.0, 1.01, 1.02}, {1.08, 1.09, 1.1}, "--threshold 1.05").verdict(),
            "worse");
  EXPECT_EQ(compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6}, "--threshold 1.5").verdict(), "same");
}

TEST(Compare, lower_rate_is_worse) {
  const Outcome outcome =
      compared(with("rate", value({10.0, 11.0, 12.0})), with("rate", value({5.0, 5.5, 6.0})));
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_NEAR(outcome.ratio(), 2.0, 1e-12);
}

TEST(Compare, bytes_are_compared_with_a_fixed_threshold) {
  EXPECT_EQ(compared(with("bytes", 100), with("bytes", 120)).verdict(), "worse");
  EXPECT_EQ(compared(with("bytes", 100), with("bytes", 105)).verdict(), "same");
  EXPECT_EQ(compared(with("bytes", 120), with("bytes", 100)).verdict(), "better");
}

TEST(Compare, any_error_above_zero_is_worse) {
  const Outcome outcome = compared(with("worst_error", 0.0), with("worst_error", 1e-17));
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(compared(with("worst_error", 0.0), with("worst_error", 0.0)).verdict(), "same");
  EXPECT_EQ(compared(with("worst_error", 1e-3), with("worst_error", 0.0)).verdict(), "better");
}

TEST(Compare, value_without_a_direction_is_not_compared) {
  const Outcome outcome = compared(with("pairs", 5), with("pairs", 50));
  EXPECT_TRUE(outcome.found["changes"].empty());
  EXPECT_EQ(outcome.status, 0);
}

TEST(Compare, other_pairs_from_one_command_fail) {
  const Outcome outcome = compared(with("fingerprint", "01"), with("fingerprint", "02"));
  EXPECT_EQ(outcome.found["other_pairs"].size(), 1U);
  EXPECT_EQ(outcome.status, 1);
}

TEST(Compare, other_settings_may_have_other_pairs) {
  Json other_seed = with("fingerprint", "02");
  other_seed["settings"]["seed"] = 2;
  EXPECT_EQ(compared(with("fingerprint", "01"), other_seed).status, 0);
  Json other_command = with("fingerprint", "02");
  row(other_command)["command"] = "bench/run y";
  EXPECT_EQ(compared(with("fingerprint", "01"), other_command).status, 0);
}

TEST(Compare, settings_that_differ_are_named) {
  Json other = report();
  other["settings"]["objects"] = {100, 200};
  const Outcome outcome = compared(report(), other);
  ASSERT_EQ(outcome.found["remarks"].size(), 1U);
  EXPECT_NE(outcome.found["remarks"][0].get<std::string>().find("objects"), std::string::npos);
}

TEST(Compare, other_libraries_and_derived_values_are_not_counted) {
  for (const bool derived : {false, true}) {
    Json before = with("bytes", 100);
    Json after = with("bytes", 200);
    for (Json* report : {&before, &after}) {
      if (derived)
        row(*report)["from"] = {{"value", "bytes"}};
      else
        row(*report)["engine"] = "Bullet dbvt";
    }
    const Outcome outcome = compared(before, after);
    EXPECT_EQ(outcome.verdict(), "worse");
    EXPECT_EQ(outcome.found["changes"][0]["counts"], false);
    EXPECT_EQ(outcome.status, 0);
  }
}

TEST(Compare, measured_value_beside_a_derived_one_is_counted) {
  Json before = with("bytes", 100);
  Json after = with("bytes", 200);
  for (Json* report : {&before, &after}) row(*report)["from"] = {{{"value", "share"}}};
  EXPECT_EQ(compared(before, after).status, 1);
}

TEST(Compare, rows_in_only_one_report_are_counted) {
  Json more = with("bytes", 100);
  more["tables"][0]["rows"].push_back({{"id", "speed/Tree"}, {"engine", "Tree"}, {"bytes", 1}});
  const Outcome outcome = compared(with("bytes", 100), more);
  EXPECT_EQ(outcome.found["only_after"], 1);
  EXPECT_EQ(outcome.found["only_before"], 0);
  EXPECT_EQ(compared(more, with("bytes", 100)).found["only_before"], 1);
  EXPECT_EQ(compared(with("bytes", 100), report()).found["values_gone"], 1);
}

TEST(Compare, times_of_different_machines_are_scaled) {
  Json slow = with("frame_ms", value({2.0, 2.2, 2.4}));
  row(slow)["bytes"] = 100;
  slow["machine"] = {
      {"processor", "other"}, {"cores", 2}, {"isa", "wide"}, {"reference_sweep_ms", 40.0}};
  Json fast = with("frame_ms", value({1.0, 1.1, 1.2}));
  row(fast)["bytes"] = 100;
  const Outcome scaled = compared(fast, slow);
  EXPECT_EQ(scaled.found["scale"], 2.0);
  EXPECT_EQ(scaled.status, 0);
  EXPECT_EQ(scaled.found["changes"][0]["ratio"], 1.0);
  EXPECT_EQ(scaled.found["changes"][1]["ratio"], 1.0);
  EXPECT_EQ(compared(fast, slow, "--scale off").status, 1);
  slow["machine"]["processor"] = "some";
  EXPECT_EQ(compared(fast, slow).found["scale"], 1.0);
  EXPECT_EQ(compared(fast, slow, "--scale on").found["scale"], 2.0);
}

TEST(Compare, file_that_is_no_report_ends_with_two) {
  const std::string good = report().dump();
  EXPECT_EQ(compared(good, good).status, 0);
  std::vector<Json> wrong(6, with("frame_ms", value({1.0, 1.1, 1.2})));
  wrong[0]["tables"][0].erase("rows");
  wrong[1]["tables"][0]["values"][0] = Json::object();
  wrong[2]["complete"] = 1;
  row(wrong[3])["frame_ms"].erase("min");
  row(wrong[4]).erase("engine");
  wrong[5]["problems"] = {1};
  std::vector<std::string> texts{"", good.substr(0, good.size() / 2), "[]", "{}"};
  for (const Json& document : wrong) texts.push_back(document.dump());
  for (const std::string& bad : texts) {
    EXPECT_EQ(compared(good, bad).status, 2) << bad;
    EXPECT_EQ(compared(bad, good).status, 2) << bad;
  }
}

}  // namespace
