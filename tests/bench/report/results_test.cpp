// Tests of `winnow dev results`: it writes the figures of a report into a readme and leaves all
// other text of the readme unchanged.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace {

using TableJson = nlohmann::json;

/// A readme and a report in one folder, which is deleted after the test.
class Documents : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write_results(1.5);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Writes rows of one engine on two scenes and of another engine on one scene.
  void write_results(double ms) const {
    TableJson rows = TableJson::array();
    const auto add = [&](const char* scene, const char* engine, double median) {
      rows.push_back(
          {{"id", std::string(scene) + engine},
           {"scene", scene},
           {"objects", 10000},
           {"partition", engine},
           {"threads", 1},
           {"isa", "wide"},
           {"frame_ms", {{"min", 0.1}, {"median", median}, {"max", 9.0}, {"samples", 5}}},
           {"bytes_per_object", median + 100.0}});
    };
    add("uniform", "FlatGrid", ms);
    add("pile", "FlatGrid", 0.0571);
    add("uniform", "Embree", 12.345);
    TableJson column{{"label", ""}, {"unit", ""}, {"better", "less"}, {"format", "number"}};
    TableJson columns{column, column};
    columns[0]["name"] = "frame_ms";
    columns[1]["name"] = "bytes_per_object";
    columns[1]["label"] = "bytes";
    const TableJson document{{"format", "winnow report 1"},
                             {"complete", true},
                             {"machine", {{"isa", "wide"}, {"reference_sweep_ms", 20.0}}},
                             {"settings", {{"seed", 1}}},
                             {"missing", TableJson::array()},
                             {"problems", TableJson::array()},
                             {"sections", TableJson::array()},
                             {"tables",
                              {{{"name", "throughput"},
                                {"section", "s"},
                                {"title", "t"},
                                {"keys", {"scene", "objects", "partition", "threads", "isa"}},
                                {"values", columns},
                                {"rows", rows}}}}};
    std::ofstream(folder_ / "results.json") << document;
  }
  void write_readme(const std::string& text) const { std::ofstream(folder_ / "readme.md") << text; }
  [[nodiscard]] std::string text(const char* name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] int run(const std::string& option = "") const {
    const auto path = [&](const char* name) { return " '" + (folder_ / name).string() + "' "; };
    const std::string command = std::string("'") + WINNOW_TOOL + "' dev results " + option +
                                path("results.json") + "--out" + path("RESULTS.md") + "--readme" +
                                path("readme.md") + ">/dev/null 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("winnow_results_" + std::to_string(::getpid()));
};

constexpr const char* kEmpty = "before\n<!-- figures -->\nold\n<!-- end -->\nafter 1 2 3\n";

TEST_F(Documents, readme_shows_the_medians_of_the_report) {
  write_readme(kEmpty);
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(text("readme.md"),
            "before\n<!-- figures -->\n"
            "One run of `bench/run --with-peers report` (unknown, unknown cores, wide, commit "
            "unknown).\n"
            "Other libraries run at their best settings: Embree on all threads, CGAL too if that "
            "is faster, the others on\none. The yardstick is a blocked sweep without state between "
            "frames.\n\n"
            "| 10,000 objects, 1 thread | uniform | pile | most bytes |\n"
            "|---|---|---|---|\n"
            "| FlatGrid | 1.50 | 0.0571 | 102 |\n"
            "| Embree | 12.3 | - | 112 |\n"
            "\n<!-- end -->\nafter 1 2 3\n");
  EXPECT_NE(text("RESULTS.md")
                .find("| uniform, 10,000 boxes, 1 thread | ms a frame | 1.50 (FlatGrid) "
                      "| 12.3 (Embree) | 8.23 |\n"),
            std::string::npos);
  EXPECT_NE(text("RESULTS.md")
                .find("| 10,000 objects, 1 thread, ms a frame | uniform | pile |\n|---|---|---|\n"
                      "| FlatGrid | **1.50** | 0.0571 |\n| Embree | 12.3 | - |\n"),
            std::string::npos);
}

TEST_F(Documents, readme_that_differs_from_the_report_fails) {
  write_readme(kEmpty);
  EXPECT_EQ(run("--check"), 1);
  EXPECT_EQ(text("readme.md"), kEmpty);
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(run("--check"), 0);
  write_results(1.51);
  EXPECT_EQ(run("--check"), 1);
}

TEST_F(Documents, readme_without_markers_is_unchanged) {
  write_readme("no figures\n");
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(text("readme.md"), "no figures\n");
  EXPECT_EQ(run("--check"), 0);
}

TEST_F(Documents, readme_with_an_unclosed_marker_is_refused) {
  write_readme("<!-- figures -->\nwithout an end\n");
  EXPECT_EQ(run(), 2);
  EXPECT_EQ(text("readme.md"), "<!-- figures -->\nwithout an end\n");
}

}  // namespace
