#pragma once

#include "bench/contenders/engines.h"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace winnow::bench {

/// Makes the engines of other libraries, in the order in which reports list them, each with its
/// best settings for at most `threads` threads; none if the tool was built without them.
/// `Interface` is Engine (broad phases), QueryEngine, NarrowEngine, ImpactEngine, SceneEngine,
/// RayEngine or MeshEngine. All but broad phases and queries use one thread.
template <typename Interface>
[[nodiscard]] std::vector<std::unique_ptr<Interface>> make_peers(int threads = 1);

inline constexpr std::string_view kYardstickName = "yardstick";

/// A prototype of a blocked sweep for AVX-512 that keeps no data between frames: any structure
/// should be faster. It uses at most two threads, each with its own array of pairs. It is raced
/// apart from the other libraries and therefore has an interface of its own.
class Yardstick : public Engine {};

/// Returns null if the tool was built without the folder of the prototype, see WINNOW_YARDSTICK.
[[nodiscard]] inline std::unique_ptr<Engine> make_yardstick(int threads) {
  auto found = make_peers<Yardstick>(threads);
  return found.empty() ? nullptr : std::move(found.front());
}

}  // namespace winnow::bench
