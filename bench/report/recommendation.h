#pragma once

#include "bench/rows/results.h"

#include <optional>
#include <string>

namespace winnow::bench {

/// Summary of a report: the partition to use for all measured scenes, and why. The members are
/// sentences without a full stop, empty if there is nothing to report.
struct Recommendation {
  std::string take;     ///< the partition
  std::string because;  ///< how often it was the fastest, and its largest ratio to the fastest
  std::string price;  ///< times of a frame and of the first frame, and memory, for the most objects
                      ///< on the fewest threads
  std::string next;   ///< the second best partition, and by how much it is slower
  std::string varying;  ///< how much slower AutoPartition is
  std::string others;   ///< the fastest other library of each scene, compared
  std::string code;     ///< the line of code that creates the partition
};

/// Returns the partition whose frame times, relative to the fastest of each race, have the least
/// geometric mean over all races. Returns nothing if no race was run.
[[nodiscard]] std::optional<Recommendation> recommend(const Results& results);

}  // namespace winnow::bench
