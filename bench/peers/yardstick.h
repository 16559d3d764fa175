#pragma once

#include "bench/contenders/engine.h"

#include <memory>
#include <string_view>

namespace winnow::bench {

inline constexpr std::string_view kYardstickName = "yardstick";

/// A prototype of a blocked sweep for AVX-512 that keeps no data between frames: any structure
/// should be faster. It uses at most two threads, each with its own array of pairs. Returns null if
/// the tool was built without the folder of the prototype, see WINNOW_YARDSTICK.
[[nodiscard]] std::unique_ptr<Engine> make_yardstick(int threads);

}  // namespace winnow::bench
