// The program winnow_micro: registers all benchmarks and passes the arguments on to Google
// Benchmark. Its own flag is --scene, which adds scenes or recordings for the benchmarks of
// partitions, filters and volumes.

#include "bench/micro/micro.h"

#include <winnow/simd/isa.h>
#include "bench/rows/machine.h"

#include <algorithm>
#include <iostream>

namespace winnow::bench::micro {

benchmark::internal::Benchmark* add(const std::string& name, Body body) {
  return benchmark::RegisterBenchmark(name.c_str(), [body = std::move(body)](auto& state) {
    const IsaGuard guard;
    try {
      body(state);
    } catch (const std::exception& error) {
      state.SkipWithError(error.what());
    }
  });
}

benchmark::internal::Benchmark* add(const std::string& name, int threads, Body body) {
  auto* const added = add(name, std::move(body));
  return threads == 1 ? added : added->UseRealTime();
}

void check(bool right, const std::string& text) {
  if (!right) throw std::runtime_error(text);
}

void count_ns(benchmark::State& state, const std::string& name, std::size_t count) {
  using benchmark::Counter;
  state.counters[name] = Counter(1e-9 * static_cast<double>(count),
                                 Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void count(benchmark::State& state, const std::string& name, double value) {
  state.counters[name] = value;
}
void count(benchmark::State& state, const std::string& name, std::size_t value, std::size_t parts) {
  state.counters[name] = static_cast<double>(value) / static_cast<double>(parts);
}

namespace {

/// Takes the arguments "--scene=..." out of the list and returns the default scenes and these.
std::vector<NamedScene> take_scenes(std::vector<std::string>& arguments) {
  std::vector<std::string> scenes{"uniform", "mixed"};
  std::erase_if(arguments, [&](const std::string& argument) {
    constexpr std::string_view kFlag = "--scene=";
    if (!argument.starts_with(kFlag)) return false;
    scenes.push_back(argument.substr(kFlag.size()));
    return true;
  });
  return named_scenes(scenes);
}

/// Describes the machine and the build in the context of the results.
void add_context() {
  const Json facts = machine_facts();
  for (const auto& [key, value] : facts.items()) {
    // Google Benchmark adds these.
    if (key == "date" || key == "executable" || key == "num_cpus") continue;
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_array()) std::erase_if(text, [](char c) { return c == '"'; });
    benchmark::AddCustomContext(key, text);
  }
}

/// The reporter that --benchmark_format selects. Google Benchmark adds "s" to counters that are
/// times of one part, but these are in ns, as their names state.
class CountersWithoutUnit final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override { return shown_->ReportContext(context); }
  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<Run> plain = runs;
    for (Run& one : plain) {
      for (auto& [name, counter] : one.counters) counter.flags = benchmark::Counter::kDefaults;
    }
    shown_->ReportRuns(plain);
  }
  void Finalize() override { shown_->Finalize(); }

 private:
  BenchmarkReporter* shown_ = benchmark::CreateDefaultDisplayReporter();
};

int run_benchmarks(int argc, char** argv) {
  std::vector<std::string> arguments(argv, argv + argc);
  const std::vector<NamedScene> scenes = take_scenes(arguments);
  // Flags of the caller come later and override these.
  arguments.insert(arguments.begin() + 1,
                   {"--benchmark_enable_random_interleaving=true", "--benchmark_repetitions=3",
                    "--benchmark_min_time=0.1"});
  constexpr std::string_view kInOrder = "--benchmark_enable_random_interleaving=false";
  if (std::ranges::find(arguments, kInOrder) != arguments.end()) most_prepared = 16;
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  int size = static_cast<int>(pointers.size());
  benchmark::Initialize(&size, pointers.data());
  if (benchmark::ReportUnrecognizedArguments(size, pointers.data())) return 2;
  add_kernels();
  add_pairs();
  add_errors();
  add_motion();
  add_features();
  add_partitions(scenes);
  add_keys();
  add_changes();
  add_filters(scenes);
  add_volumes(scenes);
  add_meshes();
  add_scenes();
  add_context();
  CountersWithoutUnit reporter;
  return benchmark::RunSpecifiedBenchmarks(&reporter) == 0 ? 1 : 0;
}

}  // namespace
}  // namespace winnow::bench::micro

int main(int argc, char** argv) {
  try {
    return winnow::bench::micro::run_benchmarks(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "winnow_micro: " << error.what() << '\n';
    return 2;
  }
}
