#include "bench/measure/installed_peers.h"

#if WINNOW_HAVE_PEERS
#include "bench/peers/peers.h"
#endif

namespace winnow::bench {

#if WINNOW_HAVE_PEERS

bool has_peers() noexcept {
  return true;
}
std::vector<std::unique_ptr<Engine>> frame_peers(int threads) {
  return make_peers(threads);
}
std::vector<std::unique_ptr<QueryEngine>> query_peers() {
  return make_query_peers();
}
std::vector<std::unique_ptr<NarrowEngine>> narrow_peers() {
  return make_narrow_peers();
}
std::vector<std::unique_ptr<SceneEngine>> scene_peers() {
  return make_scene_peers();
}
std::vector<std::unique_ptr<MeshEngine>> mesh_peers() {
  return make_mesh_peers();
}

#else

bool has_peers() noexcept {
  return false;
}
std::vector<std::unique_ptr<Engine>> frame_peers(int /*threads*/) {
  return {};
}
std::vector<std::unique_ptr<QueryEngine>> query_peers() {
  return {};
}
std::vector<std::unique_ptr<NarrowEngine>> narrow_peers() {
  return {};
}
std::vector<std::unique_ptr<SceneEngine>> scene_peers() {
  return {};
}
std::vector<std::unique_ptr<MeshEngine>> mesh_peers() {
  return {};
}

#endif

}  // namespace winnow::bench
