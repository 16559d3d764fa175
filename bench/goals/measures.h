#pragma once

#include "goals/asks.h"
#include "goals/lab.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// One line of the report: what is asked, and what it measures now.
struct Goal {
  enum class Sense { at_most, at_least };

  std::string topic{};
  std::string what{};
  std::string unit{};
  Sense sense = Sense::at_most;
  double asked = 0.0;
  double measured = 0.0;
  std::string detail{};  ///< who was measured, what the ask was made from

  [[nodiscard]] bool holds() const noexcept {
    return sense == Sense::at_most ? measured <= asked : measured >= asked;
  }
};

/// Measures one ask; some kinds make several goals of one. `all` are the asks it may refer to.
[[nodiscard]] std::vector<Goal> measure_ask(const Ask& ask, const std::vector<Ask>& all, Lab& lab);

}  // namespace winnow::bench
