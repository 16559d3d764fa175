#pragma once

#include "bench/rows/results.h"
#include "bench/simulation/flow_run.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace winnow::bench {

/// Parameters of a flow.
struct FlowRowOptions {
  std::string shape = "mixed";  ///< see flow_shape_names()
  std::size_t objects = 500;
  std::size_t steps = 3000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::size_t check = 0;  ///< see FlowRun
};

[[nodiscard]] FlowOptions flow_options(const FlowRowOptions& row_options);
/// Adds the rows of a flow that has run, and of its checks if they are declared.
void add_flow(Results& results, const FlowRowOptions& row_options, const FlowRun& run);
/// Runs a flow and adds its rows.
void add_flow(Results& results, const FlowRowOptions& row_options);

[[nodiscard]] std::vector<std::string> flow_shape_names();
/// Throws std::invalid_argument if there is no shape of this name.
[[nodiscard]] FlowShape flow_shape_named(const std::string& name);

}  // namespace winnow::bench
