#pragma once

#include "bench/measure/footprint.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Who tells how much it is.
inline constexpr const char* kByFootprint = "footprint()";
inline constexpr const char* kByResource = "memory resource";
inline constexpr const char* kByResident = "resident set";

/// memory, memory_check (told in three ways), memory_ratio.
void declare_memory(Results& results);

/// Shows a scene to each partition and adds what it holds. `resident` is right if
/// keep_resident_set_exact was called before. Throws std::runtime_error after that if a footprint
/// does not equal what was allocated.
void add_footprints(Results& results, const NamedScene& scene, std::size_t objects,
                    std::uint64_t seed, const std::vector<std::string>& partitions, int threads);

/// The same in a process of its own, whose memory nothing else disturbs.
void add_footprints_apart(Results& results, const NamedScene& scene, std::size_t objects,
                          std::uint64_t seed, int threads);

}  // namespace winnow::bench
