#pragma once

#include "bench/common/counting_resource.h"
#include "bench/common/sample.h"
#include "bench/simulation/granular_flow.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace winnow::bench {

/// The phases are timed in one of this many steps.
inline constexpr std::size_t kProfiledSteps = 16;

struct FlowPhase {
  const char* name;
  double FlowTimes::*ms;
};
inline constexpr std::array<FlowPhase, 5> kFlowPhases{{{"handing over poses", &FlowTimes::move},
                                                       {"broad phase", &FlowTimes::broad},
                                                       {"mid phase", &FlowTimes::mid},
                                                       {"narrow phase", &FlowTimes::narrow},
                                                       {"solver", &FlowTimes::solver}}};

/// Figures of all steps of a flow.
class FlowHistory {
 public:
  /// Records the flow's last step.
  void add(const GranularFlow& flow) { samples_.push_back(flow.last()); }

  [[nodiscard]] const std::vector<FlowSample>& samples() const noexcept { return samples_; }

  /// Returns the largest rise of the balance above an earlier value, relative to the largest
  /// kinetic energy. A rise is energy created by contacts, or an integration error.
  [[nodiscard]] double greatest_rise() const {
    double least = samples_.empty() ? 0.0 : samples_.front().balance();
    double rise = 0.0;
    double kinetic = 0.0;
    for (const FlowSample& sample : samples_) {
      least = std::min(least, sample.balance());
      rise = std::max(rise, sample.balance() - least);
      kinetic = std::max(kinetic, sample.energy.kinetic);
    }
    return kinetic > 0.0 ? rise / kinetic : rise;
  }

  [[nodiscard]] double deepest() const {
    double most = 0.0;
    for (const FlowSample& sample : samples_) most = std::max(most, sample.deepest);
    return most;
  }

  /// Returns one member of the times of the profiled steps, from step `first` on.
  [[nodiscard]] std::vector<double> phase_ms(double FlowTimes::*phase,
                                             std::size_t first = 0) const {
    std::vector<double> ms;
    for (std::size_t i = first; i < samples_.size(); ++i) {
      if (samples_[i].times.profiled) ms.push_back(samples_[i].times.*phase);
    }
    return ms;
  }

 private:
  std::vector<FlowSample> samples_;
};

/// Counts allocations in steps in which no count of pairs or contacts exceeds its previous maximum;
/// such a step must not allocate.
class SteadyAllocations {
 public:
  /// Records a step; `allocations` is the total number so far.
  void note(const GranularFlow& flow, std::size_t allocations) {
    const Contacts& contacts = flow.contacts();
    const SceneStatistics& statistics = flow.scene().statistics();
    const std::array<std::size_t, 6> now{statistics.body_pairs, statistics.primitive_pairs,
                                         contacts.size(),       contacts.manifolds(),
                                         contacts.points(),     contacts.ended().size()};
    bool is_more = false;
    for (std::size_t i = 0; i < now.size(); ++i) {
      is_more = is_more || now[i] > most_[i];
      most_[i] = std::max(most_[i], now[i]);
    }
    if (!is_more) count_ += allocations - before_;
    before_ = allocations;
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::array<std::size_t, 6> most_{};
  std::size_t before_ = 0;
  std::size_t count_ = 0;
};

/// Differences between a flow's contacts and contacts found by testing every pair.
struct FlowFaults {
  std::size_t compared = 0;  ///< contacts: pairs of bodies, and of a body and a triangle
  std::size_t lost = 0;
  std::size_t invented = 0;
  std::size_t doubled = 0;

  [[nodiscard]] std::size_t total() const noexcept { return lost + invented + doubled; }
  FlowFaults& operator+=(const FlowFaults& other) noexcept {
    compared += other.compared;
    lost += other.lost;
    invented += other.invented;
    doubled += other.doubled;
    return *this;
  }
};

/// Collides every pair of bodies, and of a body and a mesh triangle, by the narrow phase: without a
/// partition, tree or scene. If there are more than 4e6 pairs, only every n-th body is tested
/// against all others. The flow must keep contact poses.
[[nodiscard]] FlowFaults check_contacts(const GranularFlow& flow, const Contacts& contacts);
[[nodiscard]] inline FlowFaults check_contacts(const GranularFlow& flow) {
  return check_contacts(flow, flow.contacts());
}

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
