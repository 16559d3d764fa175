#pragma once

#include "report/page.h"
#include "report/results.h"

namespace winnow::bench {

/// Where all volumes are compared.
inline constexpr const char* kVolumesPartition = "LinearBvh";

/// The plots and tables of what the section has measured.
void show_volumes(const Results& results, ReportPage& page);

}  // namespace winnow::bench
