#pragma once

#include "bench/goals/lab.h"

#include <string>

namespace winnow::bench {

/// Makes rows of some options of an ask.
using Measurer = void (*)(const Json& options, Lab& lab, Measured& measured);

/// Null if there is none of the name. Where an option is a folder, it is given from where the tool
/// is started, and what is not there is absent.
[[nodiscard]] const Measurer* find_measurer(const std::string& name);

// By what they measure; the names are those of their tables in goals.json.

// frame_measurements.cpp: partitions on scenes.
void measure_frames(const Json& options, Lab& lab, Measured& measured);
void measure_turns(const Json& options, Lab& lab, Measured& measured);
void measure_isas(const Json& options, Lab& lab, Measured& measured);
void measure_bytes(const Json& options, Lab& lab, Measured& measured);
void measure_key_costs_of(const Json& options, Lab& lab, Measured& measured);
void measure_same_pairs(const Json& options, Lab& lab, Measured& measured);
void measure_limits(const Json& options, Lab& lab, Measured& measured);
void measure_growth(const Json& options, Lab& lab, Measured& measured);
void measure_kernels(const Json& options, Lab& lab, Measured& measured);

// choice_measurements.cpp: what AutoPartition loses to the best.
void measure_first_frames(const Json& options, Lab& lab, Measured& measured);
void measure_recorded_choice(const Json& options, Lab& lab, Measured& measured);
void measure_changes(const Json& options, Lab& lab, Measured& measured);

// other_measurements.cpp: questions, pairs of shapes, whole scenes.
void measure_queries_of(const Json& options, Lab& lab, Measured& measured);
void measure_frusta(const Json& options, Lab& lab, Measured& measured);
void measure_second_rounds_of(const Json& options, Lab& lab, Measured& measured);
void measure_churn_of(const Json& options, Lab& lab, Measured& measured);
void measure_pair_events(const Json& options, Lab& lab, Measured& measured);
void measure_worlds_of(const Json& options, Lab& lab, Measured& measured);
void measure_pairs(const Json& options, Lab& lab, Measured& measured);
void measure_errors(const Json& options, Lab& lab, Measured& measured);
void measure_turned_cases(const Json& options, Lab& lab, Measured& measured);
void measure_scenes(const Json& options, Lab& lab, Measured& measured);
void measure_tori(const Json& options, Lab& lab, Measured& measured);
void measure_flow_frames(const Json& options, Lab& lab, Measured& measured);
void measure_flow_soak(const Json& options, Lab& lab, Measured& measured);

// report_measurements.cpp: reports that this tool makes in other processes.
void measure_default_report(const Json& options, Lab& lab, Measured& measured);
void measure_lone_report(const Json& options, Lab& lab, Measured& measured);
void measure_killed_report(const Json& options, Lab& lab, Measured& measured);

}  // namespace winnow::bench
