#pragma once

#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <winnow/partitions/partition.h>
#include <winnow/simd/isa.h>

#include <memory_resource>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace winnow::test {

/// Names of all structures, in the order of `all_structures()`.
[[nodiscard]] std::vector<std::string_view> structure_names();

/// A structure, an instruction set, a number of threads (1 means Execution::serial()), and how much
/// of a build a refresh may plan.
struct Config {
  std::string partition;
  Isa isa{};
  int threads = 1;
  std::size_t build_budget = 0;

  [[nodiscard]] Execution execution() const {
    return threads == 1 ? Execution::serial() : Execution::parallel();
  }
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

/// Every partition on every instruction set of this machine on 1, 2 and 8 threads; in a quick run
/// on the narrowest and the widest on 1 and 2 threads.
[[nodiscard]] std::vector<Config> all_configs();

/// Those of partitions that report only true pairs. The others report so many that large scenes
/// take long and show nothing.
[[nodiscard]] std::vector<Config> exact_configs();

/// The number of threads that tests run on.
[[nodiscard]] std::vector<int> thread_counts();

/// Chooses an instruction set for one scope.
class IsaScope {
 public:
  explicit IsaScope(Isa isa) : before_(active_isa()) { EXPECT_EQ(set_isa(isa), Status::ok); }
  ~IsaScope() { EXPECT_EQ(set_isa(before_), Status::ok); }
  IsaScope(const IsaScope&) = delete;
  IsaScope& operator=(const IsaScope&) = delete;

 private:
  Isa before_;
};

/// Runs functions on a number of threads: directly, or inside an arena of that size.
class Threads {
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
};

/// Base of all conformance tests: the config's instruction set is active while a test runs.
class Conformance : public testing::TestWithParam<Config> {
 protected:
  [[nodiscard]] const Config& config() const { return GetParam(); }

 private:
  IsaScope isa_{GetParam().isa};
};

}  // namespace winnow::test
