#pragma once

#include "bench/goals/measurement_cache.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Makes the rows of a goal from its options.
using Measurer = void (*)(const Json& options, MeasurementCache& measurement_cache,
                          Measured& measured);

/// Returns null if there is none of that name.
[[nodiscard]] const Measurer* find_measurer(const std::string& name);

// choice_measurements.cpp: AutoPartition compared with the best partition, and worst frames with
// the median.
void measure_first_frames(const Json& options, MeasurementCache& measurement_cache,
                          Measured& measured);
void measure_changes(const Json& options, MeasurementCache& measurement_cache, Measured& measured);
void measure_worst_frames(const Json& options, MeasurementCache& measurement_cache,
                          Measured& measured);

// report_measurements.cpp: reports that this tool makes in other processes.
void measure_default_report(const Json& options, MeasurementCache& measurement_cache,
                            Measured& measured);
void measure_lone_report(const Json& options, MeasurementCache& measurement_cache,
                         Measured& measured);
void measure_killed_report(const Json& options, MeasurementCache& measurement_cache,
                           Measured& measured);

}  // namespace winnow::bench
