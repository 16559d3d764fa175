#pragma once

#include "simulation/flow_history.h"

#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

/// Facts about a run, as they are printed: what and how much.
using FlowFacts = std::vector<std::pair<std::string, std::string>>;

/// An HTML page with the facts and plots of energy, penetration, contacts and time over the run. It
/// needs nothing else: no network, no script.
[[nodiscard]] std::string flow_page(const FlowHistory& history, const FlowFacts& facts);

}  // namespace winnow::bench
