// Tests of the tool's commands: the lists of --help, misspelt commands, and the help and messages
// of `winnow query`.

#include "bench/questions/query_format.h"
#include "bench/questions/questions.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

struct Ending {
  int status = -1;
  std::string out;
  std::string errors;
};

class ToolCommands : public testing::Test {
 protected:
  ToolCommands() { std::filesystem::create_directories(folder_); }
  ~ToolCommands() override { std::filesystem::remove_all(folder_); }
  ToolCommands(const ToolCommands&) = delete;
  ToolCommands& operator=(const ToolCommands&) = delete;

  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string text_of(const char* name) const {
    std::ostringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
  [[nodiscard]] Ending run(const std::string& arguments,
                           const std::string& tool = WINNOW_TOOL) const {
    const std::string command = "'" + tool + "' " + arguments + " >'" + path("out.txt") + "' 2>'" +
                                path("errors.txt") + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of("out.txt"),
            text_of("errors.txt")};
  }
  /// Answers a file with this text.
  [[nodiscard]] Ending query(const std::string& text) const {
    std::ofstream(path("given.json")) << text;
    return run("query '" + path("given.json") + "'");
  }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("winnow_commands_" + std::to_string(::getpid()));
};

/// Returns the first words of the lines below the heading, up to an empty line.
std::vector<std::string> listed_below(const std::string& heading, const std::string& help) {
  std::istringstream lines(help.substr(std::min(help.find(heading), help.size())));
  std::vector<std::string> names;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty()) {
    std::istringstream words(line);
    std::string name;
    // Descriptions continue at a greater indentation.
    if (line.find_first_not_of(' ') == 2 && words >> name) names.push_back(name);
  }
  return names;
}

TEST_F(ToolCommands, help_lists_ten_commands_and_dev) {
  const Ending help = run("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(listed_below("Subcommands:", help.out),
            (std::vector<std::string>{"report", "advise", "view", "replay", "record", "query",
                                      "simulate", "cluster", "micro", "scenes"}));
  EXPECT_EQ(listed_below("For work on winnow:", help.out), std::vector<std::string>{"dev"});
  EXPECT_EQ(run("").out, help.out);
}

TEST_F(ToolCommands, dev_help_lists_all_other_commands) {
  const Ending help = run("dev --help");
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(
      listed_below("Subcommands:", help.out),
      (std::vector<std::string>{"fit", "throughput", "cold", "hosts", "footprint", "pipeline"}));
  EXPECT_EQ(run("dev").out, help.out);
}

TEST_F(ToolCommands, dev_commands_run) {
  const Ending measured = run(
      "dev throughput --scene uniform --objects 50 --partition LinearBvh --threads 1 --frames 2");
  EXPECT_EQ(measured.status, 0) << measured.errors;
  EXPECT_NE(measured.out.find("LinearBvh"), std::string::npos) << measured.out;
}

TEST_F(ToolCommands, misspelt_command_is_refused) {
  for (const char* word : {"qurey", "throughput"}) {
    for (const char* before : {"", "dev "}) {
      if (std::string(before) + word == "dev throughput") continue;
      const Ending ending = run(std::string(before) + word);
      EXPECT_EQ(ending.status, 2) << before << word;
      EXPECT_EQ(ending.out, "") << before << word;
      EXPECT_NE(ending.errors.find(word), std::string::npos) << ending.errors;
    }
  }
}

TEST_F(ToolCommands, micro_without_its_program_names_the_build_command) {
  std::filesystem::copy_file(WINNOW_TOOL, path("winnow"));
  const Ending ending = run("micro --benchmark_filter=x", path("winnow"));
  EXPECT_EQ(ending.status, 2);
  EXPECT_NE(ending.errors.find("winnow_micro is not built"), std::string::npos) << ending.errors;
  EXPECT_NE(ending.errors.find("bench/run micro"), std::string::npos) << ending.errors;
}

TEST_F(ToolCommands, micro_passes_all_arguments_and_the_exit_status) {
  std::filesystem::copy_file(WINNOW_TOOL, path("winnow"));
  std::ofstream(path("winnow_micro")) << "#!/bin/sh\necho \"$@\"\nexit 3\n";
  std::filesystem::permissions(path("winnow_micro"), std::filesystem::perms::owner_all);
  const Ending ending = run("micro --help --benchmark_filter=x report", path("winnow"));
  EXPECT_EQ(ending.out, "--help --benchmark_filter=x report\n") << ending.errors;
  EXPECT_EQ(ending.status, 3);
}

TEST_F(ToolCommands, example_of_query_help_is_answered) {
  const std::string help = run("query --help").out;
  ASSERT_NE(help.find(kQueryExample), std::string::npos) << help;
  const Ending ending = query(kQueryExample);
  EXPECT_EQ(ending.status, 0) << ending.errors;
  for (const Json& one : Json::parse(ending.out)) EXPECT_EQ(one["status"], "ok") << one;
}

TEST(QueryFormat, example_and_help_have_every_member) {
  for (const std::string& word : query_words()) {
    const bool is_place = word == "query" || word == "pair";
    EXPECT_TRUE(is_place || std::string(kQueryExample).find('"' + word + '"') != std::string::npos)
        << word;
    EXPECT_NE(query_format().find(word), std::string::npos) << word;
  }
}

/// Calls `visit` with each value within `value`, which it may change.
template <typename Visit>
void visit_values(Json& value, const std::string& path, Visit&& visit) {
  if (!path.empty()) visit(value, path);
  for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) {
    visit_values(value[i], path + "[" + std::to_string(i) + "]", visit);
  }
  if (!value.is_object()) return;
  for (const auto& [name, member] : value.items()) {
    if (name == "id") continue;
    visit_values(member, path.empty() ? name : path + "." + name, visit);
  }
}

TEST(QueryFormat, each_wrong_value_is_refused_and_named) {
  Json queries = Json::parse(kQueryExample);
  for (Json& query : queries) {
    EXPECT_FALSE(fault_of(query)) << query;
    visit_values(query, "", [&](Json& value, const std::string& path) {
      Json kept = "wrong";
      kept.swap(value);
      EXPECT_NE(answer(Json::array({query}), NarrowTier::robust)[0]["status"], "ok") << path;
      const auto fault = fault_of(query);
      ASSERT_TRUE(fault) << path;
      EXPECT_EQ(fault->member, path);
      EXPECT_EQ(fault->given, "\"wrong\"");
      kept.swap(value);
    });
  }
}

TEST_F(ToolCommands, wrong_query_names_file_index_and_member) {
  const auto message = [&](const std::string& query_text) {
    const Ending ending = query(R"([{"a": {"type": "sphere", "radius": 1},
                                     "b": {"type": "sphere", "radius": 1}}, )" +
                                query_text + "]");
    EXPECT_EQ(ending.status, 1);
    const Json answers = Json::parse(ending.out);
    EXPECT_EQ(answers[0]["status"], "ok");
    EXPECT_NE(answers[1]["status"], "ok");
    const std::string start = "winnow: " + path("given.json") + ": [1]";
    EXPECT_EQ(ending.errors.substr(0, start.size()), start);
    return ending.errors.substr(std::min(start.size(), ending.errors.size()));
  };
  const std::string ball = R"({"type": "sphere", "radius": 1})";
  EXPECT_EQ(message(R"({"a": {"type": "sphere", "radius": "wide"}, "b": )" + ball + "}"),
            ".a.radius: expected a finite number >= 0, given \"wide\" (invalid_argument)\n");
  EXPECT_EQ(message(R"({"a": {"type": "sphere", "radius": -2}, "b": )" + ball + "}"),
            ".a.radius: expected a finite number >= 0, given -2 (invalid_shape)\n");
  EXPECT_EQ(message(R"({"a": {"type": "capsule", "radius": 1}, "b": )" + ball + "}"),
            ".a.half_length: expected a finite number >= 0, given nothing (invalid_argument)\n");
  EXPECT_EQ(message("{\"a\": " + ball + R"(, "b": {"type": "box", "half": [1, 2]}})"),
            ".b.half: expected three numbers >= 0, given [1,2] (invalid_argument)\n");
  EXPECT_EQ(
      message("{\"a\": " + ball + R"(, "b": {"type": "hull", "v": [[0, 0, 0], [1, "x", 2]]}})"),
      ".b.v[1][1]: expected a finite number, given \"x\" (invalid_argument)\n");
  EXPECT_EQ(message("{\"a\": " + ball + "}"),
            ".b: expected a shape, {\"type\": ...}, given nothing (invalid_argument)\n");
  EXPECT_EQ(
      message("{\"a\": " + ball +
              R"(, "b": {"type": "sphere", "radius": 1, "pose": {"orientation": [0, 0, 0, 0]}}})"),
      ".b.pose.orientation: expected four numbers [w, x, y, z], not all 0, given [0,0,0,0] "
      "(invalid_pose)\n");
  EXPECT_EQ(
      message(R"({"ray": {"origin": [0, 0, 0], "direction": [0, 0, 0]}, "target": )" + ball + "}"),
      ".ray.direction: expected three numbers [x, y, z], not all 0, given [0,0,0] "
      "(invalid_argument)\n");
  EXPECT_EQ(message(R"({"motion": {"kind": "face"}})"),
            ".motion.kind: expected \"vertex_face\" or \"edge_edge\", given \"face\" "
            "(invalid_argument)\n");
  EXPECT_EQ(message("3"), ": expected an object, given 3 (invalid_argument)\n");
  const std::string moving = R"(, "end_pose": {"position": [1, 0, 0]}, )";
  EXPECT_EQ(message(R"({"a": {"type": "mesh")" + moving +
                    R"("v": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 3]]}, "b": )" +
                    ball + "}"),
            ".a.triangles[0]: expected indices below 3, given [0,1,3] (invalid_shape)\n");
  const std::string types = message(R"({"a": {"type": "spere", "radius": 1}, "b": )" + ball + "}");
  EXPECT_EQ(types.find(".a.type: expected one of sphere, capsule"), 0U) << types;
  EXPECT_NE(types.find("given \"spere\""), std::string::npos) << types;
}

}  // namespace
}  // namespace winnow::bench
