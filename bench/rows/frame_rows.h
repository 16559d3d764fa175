#pragma once

#include "bench/measure/race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// A row's fingerprint covers this many frames, so that engines that ran fewer frames than others
/// can be compared.
inline constexpr std::size_t kFingerprintFrames = 3;

/// Declares throughput and the tables that are derived from it: throughput_growth, throughput_simd,
/// throughput_threads, throughput_skipped.
void declare_frames(Results& results);

/// Runs a race on a scene, whose name and recording are written to the options, and adds a row of
/// `throughput` for each run, with `only_peers` only for runs of other libraries. Throws
/// std::runtime_error after that if not all found the same pairs.
Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers = false);

/// Adds rows about the partitions that were left out of a race.
void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  bool peers);

/// Adds the rows derived from one scene and size: speedups of wider instruction sets and of more
/// threads, and the growth of the time with size.
void derive_frames(Results& results, const std::string& scene, std::size_t objects);

/// Declares limits: the fastest partition compared with the time that memory access requires, see
/// FrameLimit.
void declare_limits(Results& results);
/// Adds the row of the fastest partition on one thread among the rows of `throughput` of the active
/// instruction set; adds nothing if there are no such rows.
void add_limit(Results& results, const std::string& scene, std::size_t objects);

}  // namespace winnow::bench
