#pragma once

#include <memory>
#include <vector>

namespace winnow::bench {

/// Makes the engines of other libraries, in the order in which reports list them, each with its
/// best settings for at most `threads` threads; none if the tool was built without them.
/// `Interface` is Engine (broad phases), QueryEngine, NarrowEngine, ImpactEngine, SceneEngine,
/// RayEngine or MeshEngine. All but broad phases and queries use one thread.
template <typename Interface>
[[nodiscard]] std::vector<std::unique_ptr<Interface>> make_peers(int threads = 1);

}  // namespace winnow::bench
