#include "bench/rows/own_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// An empty file with a unique name, removed by the destructor.
struct TemporaryFile {
  TemporaryFile() : path((std::filesystem::temp_directory_path() / "winnow-XXXXXX").string()) {
    const int file = mkstemp(path.data());
    if (file < 0) throw std::runtime_error("cannot make a temporary file");
    ::close(file);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { ::unlink(path.c_str()); }

  std::string path;
};

}  // namespace

Json run_own(std::vector<std::string> arguments) {
  const TemporaryFile file;
  const std::string command = arguments.front();
  arguments.insert(arguments.begin(), "winnow");
  arguments.insert(arguments.end(), {"--json", file.path});
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t apart;
  posix_spawnattr_init(&apart);
  posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP);
  pid_t process = 0;
  const int failed =
      posix_spawn(&process, "/proc/self/exe", &actions, &apart, words.data(), environ);
  posix_spawnattr_destroy(&apart);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start this tool once more");
  while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
  std::ifstream written(file.path);
  Json json = Json::parse(written, nullptr, false);
  if (json.is_discarded()) throw std::runtime_error(command + " wrote nothing");
  return json;
}

}  // namespace winnow::bench
