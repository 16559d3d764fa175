#pragma once

#include "bench/common/json.h"
#include "bench/contenders/partition_engine.h"
#include "bench/recordings/recording.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

struct PictureOptions {
  std::size_t most_objects = 200'000;  ///< limit of drawn objects, evenly selected; objects hit by
                                       ///< a query are always drawn
  int max_depth = 64;
  std::vector<Ray> rays;
  std::vector<Aabb> boxes;
};

/// Returns the last frame of an engine, with everything that the page shows of it, in the form that
/// page/data.js reads. The member "counts" has the numbers of things in the picture: the tool
/// prints them, and the page must draw as many. `contacts` are the contacts of this frame. Throws
/// std::runtime_error if the partition returns an error.
[[nodiscard]] Json picture_of(const std::string& scene, std::size_t frame,
                              const PartitionEngine& engine, const PictureOptions& options,
                              std::span<const RecordedContact> contacts);

}  // namespace winnow::bench
