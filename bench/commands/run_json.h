#pragma once

#include "bench/common/json.h"
#include "bench/measure/race.h"

#include <string>

namespace winnow::bench {

/// Returns the values of one member of each element.
template <typename Element, typename Get>
[[nodiscard]] Json list_of(const std::vector<Element>& elements, Get&& get) {
  Json values = Json::array();
  for (const Element& one : elements) values.push_back(get(one));
  return values;
}

/// Returns one element of the list that `replay` and `cluster` write.
[[nodiscard]] inline Json run_json(const Run& run, const std::string& scene, std::size_t objects) {
  const Spread spread = run.frame_spread();
  return {
      {"scene", scene},
      {"objects", objects},
      {"frames", run.frame_ms.size()},
      {"partition", run.engine},
      {"threads", run.threads},
      {"isa", to_string(run.isa)},
      {"build_ms", run.frame_ms.empty() ? 0.0 : run.frame_ms.front()},
      {"min_ms", spread.min},
      {"median_ms", spread.median},
      {"max_ms", spread.max},
      {"frame_ms", run.frame_ms},
      {"update_ms", run.update_ms},
      {"pairs", list_of(run.pairs, [](const PairSummary& frame) { return frame.pairs; })},
      {"reported", list_of(run.pairs, [](const PairSummary& frame) { return frame.reported; })},
      {"fingerprint", list_of(run.pairs, [](auto& frame) { return to_hex(frame.fingerprint); })},
      {"bytes", run.bytes},
      {"bytes_per_object", static_cast<double>(run.bytes) / static_cast<double>(objects)}};
}

}  // namespace winnow::bench
