#pragma once

#include "bench/rows/results.h"
#include "bench/simulation/flow_run.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace winnow::bench {

/// One flow, of which rows are made.
struct FlowQuestion {
  std::string shape = "mixed";  ///< see flow_shape_names()
  std::size_t objects = 500;
  std::size_t steps = 3000;
  std::uint64_t seed = 1;
  int threads = 1;
  std::size_t check = 0;  ///< see FlowRun
};

/// phases, flows and flow (one row in so many steps).
void declare_flows(Results& results);
/// flow_checks: memory, and contacts against those of all pairs.
void declare_flow_checks(Results& results);

[[nodiscard]] FlowOptions flow_options(const FlowQuestion& asked);
/// Of one that has run; its checks, if they are declared.
void add_flow(Results& results, const FlowQuestion& asked, const FlowRun& run);
/// Runs it.
void add_flow(Results& results, const FlowQuestion& asked);

[[nodiscard]] std::vector<std::string> flow_shape_names();
/// Throws std::invalid_argument if there is none of the name.
[[nodiscard]] FlowShape flow_shape_named(const std::string& name);

}  // namespace winnow::bench
