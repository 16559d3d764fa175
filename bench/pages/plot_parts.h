#pragma once

namespace winnow::bench {

// The files of this folder, compiled in so that the tool can be moved.
extern const char* const kPlotStyle;
extern const char* const kPlotScript;
/// The licence of Chart.js, which goes with every copy.
extern const char* const kChartJsNotice;
/// Where the library was found when the tool was configured, or where Debian would put it.
extern const char* const kChartJsFile;

}  // namespace winnow::bench
