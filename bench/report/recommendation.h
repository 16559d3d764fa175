#pragma once

#include "bench/rows/results.h"

#include <optional>
#include <string>

namespace winnow::bench {

/// What a report says to who reads nothing else: which partition to take for all scenes that were
/// measured, and why. Sentences without a full stop; empty where there is nothing to say.
struct Recommendation {
  std::string take;     ///< the partition
  std::string because;  ///< how often it was the fastest, and how far behind it ever was
  std::string price;    ///< frame, first frame and memory at the most objects on the fewest threads
  std::string next;     ///< the one that comes after it, and by how much
  std::string varying;  ///< how far behind the one is that chooses by itself
  std::string others;   ///< other libraries beside it, fastest of each scene
  std::string code;     ///< the line that makes it
};

/// Of the table of advice: the partition whose frames take the least multiple of the fastest one's,
/// in the geometric mean over all races. None if no race was run.
[[nodiscard]] std::optional<Recommendation> recommend(const Results& results);

}  // namespace winnow::bench
