#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// What the automatic choice holds after some frames of a scene, judged by times that were taken
/// elsewhere.
struct FigureCheck {
  std::string scene;
  std::size_t objects = 0;
  std::string chosen;
  std::string best;
  double times_best = 0.0;  ///< what was chosen over the best
};

/// Of each scene and number of objects in a table of comma-separated values with a line of names,
/// among them scene, objects, threads, kind and median_ms; what ran on one thread counts. The
/// choice follows counts alone, so it is the one that was made where the table comes from. Throws
/// ArgumentError, naming the line, for what is no such table.
[[nodiscard]] std::vector<FigureCheck> check_figures(const std::string& path, std::size_t frames);

}  // namespace winnow::bench
