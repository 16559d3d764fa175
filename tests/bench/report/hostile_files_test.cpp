// Invalid input files from any source: the tool names the file and its fault, and exits with 2.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

struct Ending {
  int status = -1;
  std::string message;
};

class HostileFiles : public testing::Test {
 protected:
  HostileFiles() { std::filesystem::create_directories(folder_); }
  ~HostileFiles() override { std::filesystem::remove_all(folder_); }
  HostileFiles(const HostileFiles&) = delete;
  HostileFiles& operator=(const HostileFiles&) = delete;

  /// Runs the tool on a file with this text; FILE in the arguments is replaced by its path.
  Ending run(std::string arguments, const std::string& text) {
    const std::string file = (folder_ / "given.json").string();
    std::ofstream(file) << text;
    for (std::size_t at = 0; (at = arguments.find("FILE")) != std::string::npos;) {
      arguments.replace(at, 4, "'" + file + "'");
    }
    const std::string out = (folder_ / "stderr.txt").string();
    const std::string command =
        std::string("'") + WINNOW_TOOL + "' " + arguments + " >/dev/null 2>'" + out + "'";
    const int status = std::system(command.c_str());
    std::ostringstream message;
    message << std::ifstream(out).rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, message.str()};
  }
  void expect_refused(const std::string& arguments, const std::string& text) {
    const Ending ending = run(arguments, text);
    EXPECT_EQ(ending.status, 2) << text.substr(0, 200);
    EXPECT_NE(ending.message.find("given.json"), std::string::npos) << ending.message;
    EXPECT_EQ(ending.message.find("json.exception"), std::string::npos) << ending.message;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("winnow_hostile_" + std::to_string(::getpid()));
};

const char* const kCommands[] = {"query FILE", "query --judge FILE",
                                 "report --from FILE --out /nowhere"};

TEST_F(HostileFiles, invalid_json_is_refused) {
  for (const char* command : kCommands) {
    for (const char* text : {"", "[", "[1,]", "{\"a\":}", "\xFF", "[\"\xC0\x80\"]", "nul"}) {
      expect_refused(command, text);
    }
  }
}

TEST_F(HostileFiles, deeply_nested_json_is_refused) {
  for (const std::size_t depth : {201U, 100'000U}) {
    const std::string open(depth, '[');
    const std::string close(depth, ']');
    for (const char* command : kCommands) {
      expect_refused(command, open + close);
      expect_refused(command, open);
      expect_refused(command, "[{\"id\":" + open + close + "}]");
    }
  }
}

TEST_F(HostileFiles, brackets_in_strings_are_read) {
  const std::string ball = R"({"type": "sphere", "radius": 1})";
  const Ending ending = run("query FILE", "[{\"id\":\"\\\"" + std::string(1000, '[') +
                                              "\", \"a\": " + ball + ", \"b\": " + ball + "}]");
  EXPECT_EQ(ending.status, 0) << ending.message;
}

// Each question is wrong in a different member. No question may lead to a read out of bounds.
TEST_F(HostileFiles, wrong_hard_cases_are_judged_or_refused) {
  const std::string a = R"("id": 1, "a": {"type": "sphere", "radius": 1, "half": [1], "v": [[]]})";
  const std::string b = R"("b": {"type": "triangle", "v": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]})";
  const std::string ray = R"("id": 1, "ray": {"origin": [0, 0, 9], "direction": [0, 0, -1]})";
  for (const std::string& question : {
           "{" + a + ", " + b + R"(, "expect": {"status": "ok"}})",
           "{" + a + ", " + b + R"(, "expect": {"status": 7}})",
           "{" + a + ", " + b + R"(, "expect": {"overlap": true, "distance": []}})",
           "{" + a + ", " + b + R"(, "expect": {"overlap": true, "distance": 0, "normal": []}})",
           "{" + a + ", " + b + R"(, "expect": {"overlap": true, "distance": 0, "normal": "x"}})",
           "{" + a + ", " + b +
               R"(, "expect": {"overlap": true, "distance": 0, "tolerance": "x"}})",
           "{" + a + R"(, "b": {"type": "box", "half": [1, 1, "x"]}, "expect": {"overlap": true,)" +
               R"( "distance": 0}})",
           "{" + ray +
               R"(, "target": {"type": "sphere", "radius": 1}, "expect": {"status": "ok"}})",
           "{" + ray + R"(, "target": 3, "expect": {"hit": true, "t": {}}})",
           "{" + ray + R"(, "expect": {"hit": false}})",
           std::string(R"({"id": 1, "expect": {"overlap": true}})"),
           std::string("{}"),
           std::string("7"),
       }) {
    const Ending ending = run("query --judge FILE", "[" + question + "]");
    EXPECT_TRUE(ending.status == 0 || ending.status == 2) << question << '\n' << ending.message;
    EXPECT_EQ(ending.message.find("json.exception"), std::string::npos) << ending.message;
  }
}

}  // namespace
