#include "bench/rows/own_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace winnow::bench {

TemporaryFolder::TemporaryFolder() {
  std::string path = (std::filesystem::temp_directory_path() / "winnow-XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

OwnProcess::OwnProcess(std::vector<std::string> arguments, bool quiet) {
  arguments.insert(arguments.begin(), "winnow");
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (quiet) posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t apart;
  posix_spawnattr_init(&apart);
  if (!quiet) posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP);
  const int failed =
      posix_spawn(&process_, "/proc/self/exe", &actions, &apart, words.data(), environ);
  posix_spawnattr_destroy(&apart);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start this tool once more");
}

int OwnProcess::wait() {
  if (process_ == 0) return -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void OwnProcess::kill() {
  if (process_ == 0) return;
  ::kill(process_, SIGKILL);
  (void)wait();
}

bool OwnProcess::runs() {
  if (process_ != 0 && ::waitpid(process_, nullptr, WNOHANG) == process_) process_ = 0;
  return process_ != 0;
}

Json run_own(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "rows.json").string();
  arguments.insert(arguments.end(), {"--json", path});
  OwnProcess(arguments).wait();
  std::ifstream written(path);
  Json json = Json::parse(written, nullptr, false);
  if (json.is_discarded()) throw std::runtime_error(arguments.front() + " wrote nothing");
  return json;
}

}  // namespace winnow::bench
