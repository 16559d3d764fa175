#include "bench/goals/measurements.h"

#include <map>

namespace winnow::bench {

const Measurer* find_measurer(const std::string& name) {
  static const std::map<std::string, Measurer> all{{"frames", measure_frames},
                                                   {"turns", measure_turns},
                                                   {"isas", measure_isas},
                                                   {"bytes", measure_bytes},
                                                   {"keys", measure_key_costs_of},
                                                   {"same_pairs", measure_same_pairs},
                                                   {"limits", measure_limits},
                                                   {"growth", measure_growth},
                                                   {"kernels", measure_kernels},
                                                   {"first_frames", measure_first_frames},
                                                   {"recorded_choice", measure_recorded_choice},
                                                   {"changes", measure_changes},
                                                   {"queries", measure_queries_of},
                                                   {"frusta", measure_frusta},
                                                   {"second_rounds", measure_second_rounds_of},
                                                   {"churn", measure_churn_of},
                                                   {"pair_events", measure_pair_events},
                                                   {"worlds", measure_worlds_of},
                                                   {"pairs", measure_pairs},
                                                   {"errors", measure_errors},
                                                   {"turned_cases", measure_turned_cases},
                                                   {"scenes", measure_scenes},
                                                   {"tori", measure_tori},
                                                   {"flow_frames", measure_flow_frames},
                                                   {"flow_soak", measure_flow_soak},
                                                   {"default_report", measure_default_report},
                                                   {"lone_report", measure_lone_report},
                                                   {"killed_report", measure_killed_report}};
  const auto at = all.find(name);
  return at == all.end() ? nullptr : &at->second;
}

}  // namespace winnow::bench
