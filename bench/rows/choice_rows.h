#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>

namespace winnow::bench {

/// Adds the sum of AutoPartition's first frames, and of those of the best partition.
void add_first_frames(Results& results, const NamedScene& scene, std::size_t objects, int threads);

/// Adds how many frames AutoPartition loses in the frames after a scene turns into another one.
void add_changes(Results& results, std::size_t objects, std::size_t frames_each);

/// Adds the worst of many frames over the median one (`ratio`), and over the median of the frames
/// around it (`hitch`), of frames in which something moves, after settling.
void add_worst_frames(Results& results, const NamedScene& scene, std::size_t objects,
                      std::size_t frames);

}  // namespace winnow::bench
