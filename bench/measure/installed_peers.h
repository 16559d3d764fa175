#pragma once

#include "bench/contenders/engine.h"
#include "bench/contenders/narrow_engine.h"
#include "bench/contenders/query_engine.h"
#include "bench/contenders/scene_engine.h"

#include <memory>
#include <vector>

namespace winnow::bench {

// The other libraries that the tool was built with, see bench/peers/peers.h; none if without.

[[nodiscard]] bool has_peers() noexcept;
[[nodiscard]] std::vector<std::unique_ptr<Engine>> frame_peers(int threads);
[[nodiscard]] std::vector<std::unique_ptr<QueryEngine>> query_peers();
[[nodiscard]] std::vector<std::unique_ptr<NarrowEngine>> narrow_peers();
[[nodiscard]] std::vector<std::unique_ptr<SceneEngine>> scene_peers();
[[nodiscard]] std::vector<std::unique_ptr<MeshEngine>> mesh_peers();

}  // namespace winnow::bench
