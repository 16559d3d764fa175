#include "tests/support/config.h"

#if WINNOW_HAVE_TBB
#include <tbb/global_control.h>
#endif

#include <cstdlib>
#include <memory>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr int kHostThreads = 3;

// Allows oneTBB as many workers as the tests use: by default it starts at most one for each core,
// and a test on 8 threads needs 8. Also sets the environment variable from which rapidcheck reads
// its seed.
class Process : public testing::Environment {
 public:
  void SetUp() override {
#if WINNOW_HAVE_TBB
    workers_ =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, 9U);
#endif
    const std::string parameters =
        "seed=" + std::to_string(base_seed()) + " max_success=" + std::to_string(scaled(60));
#ifdef _WIN32
    ::_putenv_s("RC_PARAMS", parameters.c_str());
#else
    ::setenv("RC_PARAMS", parameters.c_str(), 0);
#endif
  }

#if WINNOW_HAVE_TBB
  void TearDown() override {
    workers_.reset();
  }

 private:
  std::unique_ptr<tbb::global_control> workers_;
#endif
};

const testing::Environment* const kProcess = testing::AddGlobalTestEnvironment(new Process);

}  // namespace

std::string to_string(const Workers& workers) {
  return std::to_string(workers.threads) + (workers.threads == 1 ? "_thread" : "_threads") +
         (workers.host.empty() ? "" : "_of_" + std::string(workers.host));
}

std::string to_string(const Config& config) {
  return config.partition + "_" + winnow::to_string(config.isa) + "_" +
         to_string(Workers{config.threads, config.host});
}

std::vector<int> thread_counts() {
#if !WINNOW_HAVE_TBB
  return {1};
#endif
  if (is_quick()) return {1, 2};
  return {1, 2, 8};
}

std::vector<Workers> all_workers() {
  std::vector<Workers> all;
  for (const int threads : thread_counts()) all.push_back({threads});
  for (const std::string_view host : kHosts) all.push_back({kHostThreads, host});
  return all;
}

std::vector<std::string_view> structure_names() {
  std::vector<std::string_view> names;
  for (const StructureKind kind : all_structures()) names.push_back(kind.name());
  return names;
}

namespace {

/// Returns every instruction set; in quick runs only the narrowest and the widest.
std::vector<Isa> tested_isas() {
  const auto isas = available_isas();
  if (is_quick() && isas.size() > 2) return {isas.front(), isas.back()};
  return {isas.begin(), isas.end()};
}

/// Returns the hosts on which a partition is tested; in reduced runs one host for each partition.
std::vector<std::string_view> tested_hosts(std::size_t partition) {
  if (is_reduced()) return {kHosts[partition % kHosts.size()]};
  return {kHosts.begin(), kHosts.end()};
}

}  // namespace

std::vector<Config> all_configs() {
  std::vector<Config> configs;
  const std::vector<Isa> isas = tested_isas();
  const std::vector<std::string_view> names = structure_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view partition = names[i];
    for (const Isa isa : isas) {
      for (const int threads : thread_counts()) {
        // Reduced runs combine several threads only with the widest instruction set.
        if (is_reduced() && threads > 1 && isa != isas.back()) continue;
        configs.push_back({std::string(partition), isa, threads});
      }
    }
    for (const std::string_view host : tested_hosts(i)) {
      configs.push_back({.partition = std::string(partition),
                         .isa = isas.back(),
                         .threads = kHostThreads,
                         .host = host});
    }
  }
  return configs;
}

std::vector<Config> exact_configs() {
  std::vector<Config> configs;
  for (const Config& config : all_configs()) {
    if (config.make().is_exact()) configs.push_back(config);
  }
  return configs;
}

}  // namespace winnow::test
