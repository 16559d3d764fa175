#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// AutoPartition's choice after some frames of a scene, judged by times measured on another
/// machine.
struct FigureCheck {
  std::string scene;
  std::size_t objects = 0;
  std::string chosen;
  std::string best;
  double times_best = 0.0;  ///< time of the chosen structure over the best
};

/// Checks each scene and number of objects of a CSV table with a header line; it must have the
/// columns scene, objects, threads, kind and median_ms. Rows with more than 1 thread, and rows of
/// structures that AutoPartition cannot choose, are ignored. The choice depends only on counts, so
/// it equals the choice on the machine of the table. Throws ArgumentError with the line number if
/// the table is malformed.
[[nodiscard]] std::vector<FigureCheck> check_figures(const std::string& path, std::size_t frames);

}  // namespace winnow::bench
