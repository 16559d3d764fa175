#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

namespace winnow::bench {

/// Registers `body` once per instruction set of this machine, named "<name>/<isa>"; the instruction
/// set is chosen before each run.
void add_per_isa(const std::string& name, std::function<void(benchmark::State&)> body);

// One per file of benchmarks.
void add_flat_kernels();
void add_tree_kernels();
void add_cell_kernels();
void add_partitions();
void add_narrow_kernels();

}  // namespace winnow::bench
