#pragma once

#include "report/page.h"

namespace winnow::bench {

/// What the page shows of the tables narrow_*.
void show_narrow(const Results& results, ReportPage& page);

}  // namespace winnow::bench
