#pragma once

#include "report/section.h"

#include <vector>

namespace winnow::bench {

// Parts of the section, one file each.

/// Whole scenes and meshes, beside other libraries.
void declare_whole_scenes(Results& results);
[[nodiscard]] std::vector<ReportStep> plan_whole_scenes(const ReportOptions& options);
void show_whole_scenes(const Results& results, ReportPage& page);

/// Granular flow: where the time of a step goes, and whether the simulation stays sound.
void declare_flows(Results& results);
[[nodiscard]] std::vector<ReportStep> plan_flows(const ReportOptions& options);
void show_flows(const Results& results, ReportPage& page);

}  // namespace winnow::bench
