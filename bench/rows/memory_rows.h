#pragma once

#include "bench/measure/footprint.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Sources of a byte count.
inline constexpr const char* kByFootprint = "footprint()";
inline constexpr const char* kByResource = "memory resource";
inline constexpr const char* kByResident = "resident set";

/// Runs a scene in each partition and adds the memory that the partition has allocated. The rows by
/// resident set are correct only if keep_resident_set_exact was called before. Throws
/// std::runtime_error after that if a footprint differs from the allocated bytes.
void add_footprints(Results& results, const NamedScene& scene, std::size_t objects,
                    std::uint64_t seed, const std::vector<std::string>& partitions, int threads);

/// As above, in a separate process, whose memory nothing else changes.
void add_footprints_apart(Results& results, const NamedScene& scene, std::size_t objects,
                          std::uint64_t seed, int threads);

}  // namespace winnow::bench
