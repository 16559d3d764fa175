#pragma once

namespace winnow::bench {

// The files of this folder, embedded so that the tool does not depend on its source folder.
extern const char* const kPlotStyle;
extern const char* const kPlotScript;
/// The licence of Chart.js, which each page must include.
extern const char* const kChartJsNotice;
/// The file of Chart.js found at configure time, or its path on Debian.
extern const char* const kChartJsFile;

}  // namespace winnow::bench
