#pragma once

#include "bench/common/counting_resource.h"
#include "bench/simulation/flow_check.h"
#include "bench/simulation/flow_history.h"

#include <cstddef>

namespace winnow::bench {

/// Runs a flow step by step and records its figures.
class FlowRun {
 public:
  /// `steps` is the intended number of steps, half of which are the warm-up. In one of `check`
  /// steps the contacts are compared with a test of all pairs; 0: never.
  FlowRun(const FlowOptions& options, std::size_t steps, std::size_t check)
      : flow_(with_memory(options)), warm_up_(steps / 2), check_(check) {
    if (check_ != 0) flow_.keep_contact_poses();
  }

  void step() {
    const std::size_t i = flow_.steps();
    if (i == warm_up_) {
      allocations_before_ = memory_.allocations();
      steady_before_ = steady_.count();
    }
    flow_.step(i % kProfiledSteps == 0);
    history_.add(flow_);
    steady_.note(flow_, memory_.allocations());
    if (check_ != 0 && i % check_ == 0) faults_ += check_contacts(flow_);
  }

  [[nodiscard]] const GranularFlow& flow() const { return flow_; }
  [[nodiscard]] const FlowHistory& history() const { return history_; }
  // Counted after the warm-up.
  [[nodiscard]] std::size_t allocations() const {
    return memory_.allocations() - allocations_before_;
  }
  /// Returns the allocations in steps without more contacts than before.
  [[nodiscard]] std::size_t steady_allocations() const { return steady_.count() - steady_before_; }
  /// Returns the sums over all checks.
  [[nodiscard]] const FlowFaults& faults() const { return faults_; }

 private:
  FlowOptions with_memory(FlowOptions options) {
    options.memory = &memory_;
    return options;
  }

  CountingResource memory_;
  GranularFlow flow_;
  FlowHistory history_;
  std::size_t warm_up_;
  std::size_t check_;
  FlowFaults faults_;
  SteadyAllocations steady_;
  std::size_t allocations_before_ = 0;
  std::size_t steady_before_ = 0;
};

}  // namespace winnow::bench
