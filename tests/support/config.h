#pragma once

#include <gtest/gtest.h>
#include <winnow/partitions/partition.h>
#include <winnow/simd/isa.h>

#if WINNOW_HAVE_TBB
#include <tbb/task_arena.h>
#endif

#include <memory_resource>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/support/hosts.h"

namespace winnow::test {

/// Returns the names of all structures, in the order of `all_structures()`.
[[nodiscard]] std::vector<std::string_view> structure_names();

/// The threads that run tasks: the caller only (1), threads of an arena, or threads of a host.
struct Workers {
  int threads = 1;
  std::string_view host{};

  [[nodiscard]] Execution execution() const {
    if (threads == 1) return Execution::serial();
    if (host.empty()) return Execution::parallel();
    return Execution::on(jobs_of(host, static_cast<std::size_t>(threads)));
  }
};

[[nodiscard]] std::string to_string(const Workers& workers);

/// Returns each number of threads of an arena, and every host.
[[nodiscard]] std::vector<Workers> all_workers();

/// A structure, an instruction set, a number of threads (1 means Execution::serial()), the build
/// budget of a refresh, and the host that runs the threads, empty for an arena.
struct Config {
  std::string partition;
  Isa isa{};
  int threads = 1;
  std::size_t build_budget = 0;
  std::string_view host{};

  [[nodiscard]] Execution execution() const { return Workers{threads, host}.execution(); }
  [[nodiscard]] Partition make(
      std::pmr::memory_resource* memory = std::pmr::get_default_resource()) const {
    return Partition(structure_named(partition),
                     {.memory = memory, .execution = execution(), .build_budget = build_budget});
  }
};

[[nodiscard]] std::string to_string(const Config& config);
inline void PrintTo(const Config& config, std::ostream* out) {
  *out << to_string(config);
}

/// Returns every structure on every instruction set of this machine with 1, 2 and 8 threads, and on
/// the widest instruction set with every host. Reduced runs test one host for each structure, and
/// several threads only on the widest instruction set. Quick runs also leave out 8 threads, and all
/// instruction sets but the narrowest and the widest.
[[nodiscard]] std::vector<Config> all_configs();

/// Returns the configurations of partitions that report only true pairs. In large scenes the false
/// pairs of other partitions would make tests slow without testing more.
[[nodiscard]] std::vector<Config> exact_configs();

/// Returns the numbers of threads that tests use.
[[nodiscard]] std::vector<int> thread_counts();

/// Selects an instruction set for one scope.
class IsaScope {
 public:
  explicit IsaScope(Isa isa) : before_(active_isa()) { EXPECT_EQ(set_isa(isa), Status::ok); }
  ~IsaScope() { EXPECT_EQ(set_isa(before_), Status::ok); }
  IsaScope(const IsaScope&) = delete;
  IsaScope& operator=(const IsaScope&) = delete;

 private:
  Isa before_;
};

/// Runs functions on a number of threads: directly, or inside an arena of that size. Without oneTBB
/// there are no arenas, and work for them is serial.
class Threads {
#if WINNOW_HAVE_TBB
 public:
  explicit Threads(int count) : count_(count), arena_(count) {}

  template <typename Body>
  auto run(Body&& body) {
    if (count_ == 1) return body();
    return arena_.execute(std::forward<Body>(body));
  }

 private:
  int count_;
  tbb::task_arena arena_;
#else
 public:
  explicit Threads(int) {}

  template <typename Body>
  auto run(Body&& body) {
    return body();
  }
#endif
};

/// Base of all conformance tests: the instruction set of the config is active during a test.
class Conformance : public testing::TestWithParam<Config> {
 protected:
  [[nodiscard]] const Config& config() const { return GetParam(); }

 private:
  IsaScope isa_{GetParam().isa};
};

}  // namespace winnow::test
