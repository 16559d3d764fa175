// `winnow compare`: what it calls worse, better, noise and other pairs, and how it ends.

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

/// A report of one row, which a test changes.
Json report() {
  return Json::parse(R"({"format": "winnow report 1", "complete": true,
    "machine": {"processor": "some", "cores": 2, "isa": "wide", "reference_sweep_ms": 20.0},
    "settings": {"seed": 1, "quick": false, "objects": [100]},
    "missing": [], "problems": [], "sections": [],
    "tables": [{"name": "speed", "section": "s", "title": "t", "keys": ["who"],
      "values": [{"name": "frame_ms", "label": "", "unit": "ms", "better": "less", "format": "number"},
                 {"name": "rate", "label": "", "unit": "1/s", "better": "more", "format": "number"},
                 {"name": "bytes", "label": "", "unit": "bytes", "better": "less", "format": "number"},
                 {"name": "worst_error", "label": "", "unit": "", "better": "less", "format": "number"},
                 {"name": "pairs", "label": "", "unit": "", "better": "neither", "format": "number"},
                 {"name": "fingerprint", "label": "", "unit": "", "better": "neither", "format": "number"}],
      "rows": [{"id": "speed/Grid", "who": "Grid", "command": "bench/run x"}]}]})");
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

  /// Of the only value that both have.
  [[nodiscard]] std::string verdict() const {
    return found["changes"].size() == 1 ? found["changes"][0]["verdict"].get<std::string>()
                                        : "not one change";
  }
  [[nodiscard]] double ratio() const { return found["changes"][0]["ratio"]; }
};

/// Runs the tool on two files of these texts.
Outcome compared(const std::string& before, const std::string& after,
                 const std::string& options = "") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("winnow_compare_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "old.json") << before;
  std::ofstream(folder / "new.json") << after;
  const std::string command = std::string("'") + WINNOW_TOOL + "' compare '" +
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

TEST(Compare, finds_nothing_in_a_report_and_itself) {
  Json both = with("frame_ms", value({1.0, 1.1, 1.2}));
  row(both)["fingerprint"] = "0123";
  const Outcome outcome = compared(both, both);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.verdict(), "same");
  EXPECT_EQ(outcome.found["summaries"][0]["geometric_mean"], 1.0);
}

TEST(Compare, calls_a_time_worse_if_all_of_its_samples_are) {
  const Outcome outcome = compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6});
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_NEAR(outcome.ratio(), 1.5 / 1.1, 1e-12);
  EXPECT_EQ(outcome.status, 1);
  const Outcome reverse = compared_ms({1.4, 1.5, 1.6}, {1.0, 1.1, 1.2});
  EXPECT_EQ(reverse.verdict(), "better");
  EXPECT_EQ(reverse.status, 0);
}

TEST(Compare, calls_it_noise_if_the_best_sample_has_not_changed) {
  const Outcome outcome = compared_ms({1.0, 1.1, 1.2}, {1.0, 1.5, 3.0});
  EXPECT_EQ(outcome.verdict(), "noise");
  EXPECT_EQ(outcome.status, 0);
}

TEST(Compare, calls_it_noise_if_few_samples_were_taken) {
  EXPECT_EQ(compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6, 4}).verdict(), "noise");
  EXPECT_EQ(compared(with("frame_ms", 1.0), with("frame_ms", 2.0)).verdict(), "noise");
}

TEST(Compare, lets_no_time_of_a_quick_report_count) {
  Json quick = with("frame_ms", value({1.4, 1.5, 1.6}));
  quick["settings"]["quick"] = true;
  const Outcome outcome = compared(with("frame_ms", value({1.0, 1.1, 1.2})), quick);
  EXPECT_EQ(outcome.verdict(), "noise");
  EXPECT_FALSE(outcome.found["remarks"].empty());
}

TEST(Compare, takes_the_threshold_that_it_is_given) {
  EXPECT_EQ(compared_ms({1.0, 1.01, 1.02}, {1.08, 1.09, 1.1}).verdict(), "same");
  EXPECT_EQ(compared_ms({1.0, 1.01, 1.02}, {1.08, 1.09, 1.1}, "--threshold 1.05").verdict(),
            "worse");
  EXPECT_EQ(compared_ms({1.0, 1.1, 1.2}, {1.4, 1.5, 1.6}, "--threshold 1.5").verdict(), "same");
}

TEST(Compare, knows_that_more_of_a_rate_is_better) {
  const Outcome outcome =
      compared(with("rate", value({10.0, 11.0, 12.0})), with("rate", value({5.0, 5.5, 6.0})));
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_NEAR(outcome.ratio(), 2.0, 1e-12);
}

TEST(Compare, takes_bytes_and_errors_as_they_are) {
  EXPECT_EQ(compared(with("bytes", 100), with("bytes", 120)).verdict(), "worse");
  EXPECT_EQ(compared(with("bytes", 100), with("bytes", 105)).verdict(), "same");
  EXPECT_EQ(compared(with("bytes", 120), with("bytes", 100)).verdict(), "better");
}

TEST(Compare, calls_an_error_worse_as_soon_as_it_is_not_zero) {
  const Outcome outcome = compared(with("worst_error", 0.0), with("worst_error", 1e-17));
  EXPECT_EQ(outcome.verdict(), "worse");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(compared(with("worst_error", 0.0), with("worst_error", 0.0)).verdict(), "same");
  EXPECT_EQ(compared(with("worst_error", 1e-3), with("worst_error", 0.0)).verdict(), "better");
}

TEST(Compare, does_not_compare_what_has_no_better_way) {
  const Outcome outcome = compared(with("pairs", 5), with("pairs", 50));
  EXPECT_TRUE(outcome.found["changes"].empty());
  EXPECT_EQ(outcome.status, 0);
}

TEST(Compare, fails_if_the_same_command_found_other_pairs) {
  const Outcome outcome = compared(with("fingerprint", "01"), with("fingerprint", "02"));
  EXPECT_EQ(outcome.found["other_pairs"].size(), 1U);
  EXPECT_EQ(outcome.status, 1);
}

TEST(Compare, does_not_hold_other_questions_against_other_pairs) {
  Json other_seed = with("fingerprint", "02");
  other_seed["settings"]["seed"] = 2;
  EXPECT_EQ(compared(with("fingerprint", "01"), other_seed).status, 0);
  Json other_command = with("fingerprint", "02");
  row(other_command)["command"] = "bench/run y";
  EXPECT_EQ(compared(with("fingerprint", "01"), other_command).status, 0);
}

TEST(Compare, says_which_settings_differ) {
  Json other = report();
  other["settings"]["objects"] = {100, 200};
  const Outcome outcome = compared(report(), other);
  ASSERT_EQ(outcome.found["remarks"].size(), 1U);
  EXPECT_NE(outcome.found["remarks"][0].get<std::string>().find("objects"), std::string::npos);
}

TEST(Compare, counts_neither_other_libraries_nor_values_made_from_other_rows) {
  for (const bool derived : {false, true}) {
    Json before = with("bytes", 100);
    Json after = with("bytes", 200);
    for (Json* report : {&before, &after}) {
      if (derived)
        row(*report)["from"] = {{"value", "bytes"}};
      else
        row(*report)["who"] = "Bullet dbvt";
    }
    const Outcome outcome = compared(before, after);
    EXPECT_EQ(outcome.verdict(), "worse");
    EXPECT_EQ(outcome.found["changes"][0]["counts"], false);
    EXPECT_EQ(outcome.status, 0);
  }
}

TEST(Compare, counts_what_was_measured_in_a_row_that_has_a_value_made_from_others) {
  Json before = with("bytes", 100);
  Json after = with("bytes", 200);
  for (Json* report : {&before, &after}) row(*report)["from"] = {{{"value", "share"}}};
  EXPECT_EQ(compared(before, after).status, 1);
}

TEST(Compare, counts_rows_that_only_one_has) {
  Json more = with("bytes", 100);
  more["tables"][0]["rows"].push_back({{"id", "speed/Tree"}, {"who", "Tree"}, {"bytes", 1}});
  const Outcome outcome = compared(with("bytes", 100), more);
  EXPECT_EQ(outcome.found["only_after"], 1);
  EXPECT_EQ(outcome.found["only_before"], 0);
  EXPECT_EQ(compared(more, with("bytes", 100)).found["only_before"], 1);
  EXPECT_EQ(compared(with("bytes", 100), report()).found["values_gone"], 1);
}

TEST(Compare, scales_times_if_the_machines_differ) {
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

TEST(Compare, ends_with_two_if_a_file_is_no_report) {
  const std::string good = report().dump();
  EXPECT_EQ(compared(good, good).status, 0);
  std::vector<Json> wrong(6, with("frame_ms", value({1.0, 1.1, 1.2})));
  wrong[0]["tables"][0].erase("rows");
  wrong[1]["tables"][0]["values"][0] = Json::object();
  wrong[2]["complete"] = 1;
  row(wrong[3])["frame_ms"].erase("min");
  row(wrong[4]).erase("who");
  wrong[5]["problems"] = {1};
  std::vector<std::string> texts{"", good.substr(0, good.size() / 2), "[]", "{}"};
  for (const Json& document : wrong) texts.push_back(document.dump());
  for (const std::string& bad : texts) {
    EXPECT_EQ(compared(good, bad).status, 2) << bad;
    EXPECT_EQ(compared(bad, good).status, 2) << bad;
  }
}

}  // namespace
