// Benchmarks of single operations, run by Google Benchmark. Each source of this folder registers
// one family; main.cpp calls all of them. A name is a path: words, and parameters "key:value". The
// path is stable, because results of two commits are compared by name.

#pragma once

#include <benchmark/benchmark.h>
#include "bench/common/arena.h"
#include "bench/measure/isa_guard.h"
#include "bench/peers/peers.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace winnow::bench::micro {

void add_kernels();                                          // kernel/ and memory/
void add_pairs();                                            // pair/
void add_errors();                                           // error/ and stability/
void add_motion();                                           // toi/ and continuous/
void add_features();                                         // feature/
void add_partitions(const std::vector<NamedScene>& scenes);  // partition/
void add_keys();                                             // keys/
void add_changes();                                          // churn/, events/ and worlds/
void add_filters(const std::vector<NamedScene>& scenes);     // filter/
void add_volumes(const std::vector<NamedScene>& scenes);     // volume/
void add_meshes();                                           // mesh/
void add_scenes();                                           // scene/

using Body = std::function<void(benchmark::State&)>;

/// Registers a benchmark. If its body throws, the benchmark is reported as failed, with the text.
benchmark::internal::Benchmark* add(const std::string& name, Body body);

/// Registers a benchmark that several threads of oneTBB run; it is timed by the wall clock.
benchmark::internal::Benchmark* add(const std::string& name, int threads, Body body);

/// Throws std::runtime_error with the text unless `right`.
void check(bool right, const std::string& text);

/// Number of values of each type that `prepared_by` keeps: all while benchmarks run in random order
/// (about 5 GB for all benchmarks), or as many as one benchmark may use if each runs only once.
inline std::size_t most_prepared = std::numeric_limits<std::size_t>::max();

/// Returns the value stored under `key`. The first call makes and stores it, so that repetitions of
/// a benchmark, and benchmarks on the same input, share it.
template <typename Value, typename Make>
Value& prepared_by(const std::string& key, Make&& make) {
  static std::deque<std::pair<std::string, std::unique_ptr<Value>>> all;
  const auto at = std::ranges::find(all, key, [](const auto& one) { return one.first; });
  if (at != all.end()) return *at->second;
  if (all.size() >= most_prepared) all.pop_front();
  return *all.emplace_back(key, make()).second;
}
/// As above for a value that is made from the arguments.
template <typename Value, typename... Arguments>
Value& prepared(const std::string& key, const Arguments&... arguments) {
  return prepared_by<Value>(key, [&] { return std::make_unique<Value>(arguments...); });
}
/// As above for an engine that `make` returns and that is started with the input.
template <typename Interface, typename Make, typename Input>
Interface& started(const std::string& key, Make&& make, const Input& input) {
  return prepared_by<Interface>(key, [&] {
    std::unique_ptr<Interface> engine = make();
    engine->start(input);
    return engine;
  });
}

/// Calls `visit(engine, make)` for each other library; `make` makes another such engine.
template <typename Interface, typename Visit>
void each_peer(Visit&& visit) {
  const auto peers = make_peers<Interface>();
  for (std::size_t i = 0; i < peers.size(); ++i) {
    visit(*peers[i], [i] { return std::move(make_peers<Interface>()[i]); });
  }
}

/// Calls `work` for each iteration, inside an arena of `threads` threads.
template <typename Work>
void run(benchmark::State& state, int threads, Work&& work) {
  static Arenas arenas(2);
  arenas.run(threads, [&] {
    for (auto iteration : state) {
      static_cast<void>(iteration);
      work();
    }
  });
}

/// Sets the counter `name` to nanoseconds for each of `count` equal parts of an iteration.
void count_ns(benchmark::State& state, const std::string& name, std::size_t count);

/// Sets a counter to a number, or to a number for each of several parts.
void count(benchmark::State& state, const std::string& name, double value);
void count(benchmark::State& state, const std::string& name, std::size_t value,
           std::size_t parts = 1);

}  // namespace winnow::bench::micro
