// Usage: winnow_digests [--check FILE | --check-once FILE]
//
// Prints a digest of every kind of result, one per line, in each floating-point mode that a host
// may have set. Each digest is computed on every instruction set of the machine and on 1 to 32
// threads: arenas of oneTBB, if winnow is built with it, and a thread pool of this program. If a
// digest differs from the first, its line names the instruction set and the threads. With --check
// the program prints only the lines that differ from the file, and returns 1 if there are any.
// --check-once uses only the best instruction set and one thread. The inputs are computed without
// the mathematical library, because its last digits depend on its version.

#if WINNOW_HAVE_TBB
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#endif
#include <winnow/winnow.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/digests/digest.h"
#include "tests/support/float_modes.h"

// WASI has no threads.
#if !defined(__wasi__)
#include "bench/common/thread_pool.h"
#endif

namespace winnow::test {
namespace {

constexpr FloatMode kModes[] = {{FE_TONEAREST},
#ifdef FE_DOWNWARD
                                {FE_DOWNWARD},
                                {FE_UPWARD},
                                {FE_TOWARDZERO},
#endif
                                {FE_TONEAREST, true, true}};

/// The name in the file of digests.
const char* name_of(const FloatMode& mode) {
  return mode.results_flushed ? "flushed" : direction_of(mode);
}

/// The threads of a computation: the caller only (1), an arena, or a pool.
struct Workers {
  int threads;
  bool is_pool = false;
};
#if WINNOW_HAVE_TBB
constexpr Workers kWorkers[] = {{1}, {2}, {8}, {32}, {3, true}};
#elif defined(__wasi__)
constexpr Workers kWorkers[] = {{1}};
#else
constexpr Workers kWorkers[] = {{1}, {2, true}, {8, true}, {32, true}};
#endif

JobSystem pool_of([[maybe_unused]] int threads) {
#if defined(__wasi__)
  return {};
#else
  static std::map<int, bench::ThreadPool> pools;
  return pools.try_emplace(threads, static_cast<std::size_t>(threads)).first->second.jobs();
#endif
}

std::uint64_t digest_of(const FloatMode& mode, const Work& work, const Workers& workers) {
  Digest digest;
  const auto run = [&](const Execution& execution) {
    const FloatModeScope scope(mode);
    work.run(execution, digest);
  };
  if (workers.threads == 1) {
    run(Execution::serial());
  } else if (workers.is_pool) {
    run(Execution::on(pool_of(workers.threads)));
  } else {
#if WINNOW_HAVE_TBB
    tbb::task_arena(workers.threads).execute([&] { run(Execution::parallel()); });
#endif
  }
  return digest.value();
}

/// If `once`, computes the digest only on one thread and on the current instruction set.
std::string line_of(const FloatMode& mode, const Work& work, bool once) {
  std::ostringstream line;
  line << name_of(mode) << ' ' << work.name << ' ';
  if (once) {
    line << std::hex << digest_of(mode, work, {1});
    return line.str();
  }
  std::uint64_t first = 0;
  bool any = false;
  for (const Isa isa : available_isas()) {
    if (set_isa(isa) != Status::ok) continue;
    for (const Workers& workers : kWorkers) {
      const std::uint64_t digest = digest_of(mode, work, workers);
      if (!any) line << std::hex << (first = digest) << std::dec;
      any = true;
      if (digest == first) continue;
      line << ", not on " << to_string(isa) << ' ' << workers.threads
           << (workers.is_pool ? " of a pool" : "");
    }
  }
  return line.str();
}

/// Returns the lines of the file, by the text before the digest.
std::map<std::string, std::string> lines_of(const std::string& path) {
  std::map<std::string, std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    lines[line.substr(0, line.find(' ', line.find(' ') + 1))] = line;
  }
  return lines;
}

}  // namespace
}  // namespace winnow::test

int main(int argc, char** argv) {
  using namespace winnow::test;
#if WINNOW_HAVE_TBB
  const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 33U);
#endif
  const std::string option = argc == 3 ? argv[1] : "";
  const bool once = option == "--check-once";
  const bool checks = option == "--check" || once;
  const auto expected = checks ? lines_of(argv[2]) : std::map<std::string, std::string>();
  std::size_t compared = 0;
  std::size_t other = 0;
  for (const FloatMode& mode : kModes) {
    for (const Work& work : all_work()) {
      const auto known = expected.find(std::string(name_of(mode)) + ' ' + work.name);
      if (checks && known == expected.end()) continue;
      const std::string line = line_of(mode, work, once);
      ++compared;
      if (checks && line == known->second) continue;
      std::cout << line << std::endl;
      ++other;
    }
  }
  if (!checks) return 0;
  std::cerr << compared - other << " of " << compared << " digests are as they should be\n";
  return other == 0 ? 0 : 1;
}
