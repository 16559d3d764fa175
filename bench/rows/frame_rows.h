#pragma once

#include "bench/measure/race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// After so many frames the fingerprint of a row is taken: engines that run fewer frames than
/// others still show that they found the same.
inline constexpr std::size_t kFingerprintFrames = 3;

/// throughput, and what is derived of it: throughput_growth, throughput_simd, throughput_threads,
/// throughput_skipped.
void declare_frames(Results& results);

/// Races on a scene, whose name and recording go into the options, and adds a row of `throughput`
/// for each run; with `only_peers`, for those of other libraries alone. Throws std::runtime_error
/// after that if not all found the same pairs.
Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers = false);

/// What was left out of a race.
void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  bool peers);

/// Adds what follows from the rows of one scene and size: how much faster wider instruction sets
/// and more threads are, and how the time grows from size to size.
void derive_frames(Results& results, const std::string& scene, std::size_t objects);

/// keys: nanoseconds of operations on keys, in bulk and singly.
void declare_keys(Results& results);
void add_key_costs(Results& results, const std::string& partition, std::size_t objects,
                   bool random_order);

/// limits: the fastest partition over what memory alone asks of a frame, see FrameLimit.
void declare_limits(Results& results);
/// Of the fastest partition on one thread among the rows of `throughput` of the active instruction
/// set; nothing if there are none.
void add_limit(Results& results, const std::string& scene, std::size_t objects);

}  // namespace winnow::bench
