#pragma once

#include "bench/contenders/engine.h"

#include <memory>
#include <string_view>

namespace winnow::bench {

inline constexpr std::string_view kYardstickName = "yardstick";

/// A blocked sweep that keeps nothing from frame to frame, a prototype for AVX-512: what any
/// structure has to be worth. It uses at most two threads, which write pairs to an array each. Null
/// if the tool was built without the folder with the prototype, see WINNOW_YARDSTICK.
[[nodiscard]] std::unique_ptr<Engine> make_yardstick(int threads);

}  // namespace winnow::bench
