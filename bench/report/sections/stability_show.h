#pragma once

#include "report/page.h"

namespace winnow::bench {

/// What the page shows of the tables hard_cases* and stability_curves.
void show_stability(const Results& results, ReportPage& page);

}  // namespace winnow::bench
