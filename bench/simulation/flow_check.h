#pragma once

#include "bench/simulation/granular_flow.h"

#include <cstddef>

namespace winnow::bench {

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

}  // namespace winnow::bench
