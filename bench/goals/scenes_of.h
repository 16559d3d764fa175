#pragma once

#include "bench/goals/measurement_cache.h"
#include "bench/rows/named_scene.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Returns the scenes of the options: a "scene", several "scenes", or all recordings of a "folder"
/// relative to the working directory. If there are none, marks the measurement as absent.
[[nodiscard]] inline std::vector<NamedScene> scenes_of(const Json& options, Measured& measured) {
  std::vector<std::string> names;
  if (options.contains("scene")) names = {options["scene"].get<std::string>()};
  if (options.contains("scenes")) names = options["scenes"].get<std::vector<std::string>>();
  if (options.contains("folder")) names = recordings_in(options["folder"]);
  measured.absent = names.empty();
  return named_scenes(names);
}

}  // namespace winnow::bench
