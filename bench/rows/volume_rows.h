#pragma once

#include "bench/measure/volume_race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace winnow::bench {

/// The partition in which all volumes are compared.
inline constexpr const char* kVolumesPartition = "LinearBvh";

/// A race of volumes on one setting.
struct VolumeRowOptions {
  std::string setting{};  ///< see volume_setting_names()
  NamedScene scene{};     ///< for the setting "scene"
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  std::string partition = kVolumesPartition;
  double step = -1.0;  ///< negative: the setting's own step
  std::size_t frames = 9;
};

/// Adds a row for each volume; `margins` gets only rows of boxes. Throws std::runtime_error after
/// that if a volume missed overlapping pairs.
void add_volumes(Results& results, const VolumeRowOptions& options,
                 const std::string& table = "volumes");

}  // namespace winnow::bench
