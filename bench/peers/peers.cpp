#include "bench/peers/peers.h"

#include "bench/peers/registry.h"

namespace winnow::bench {
namespace {

template <typename Engine>
std::vector<std::unique_ptr<Engine>> make_all(int threads = 1) {
  std::vector<std::unique_ptr<Engine>> engines;
  for (const MakePeer<Engine> make : registered_peers<Engine>()) engines.push_back(make(threads));
  return engines;
}

}  // namespace

std::vector<std::unique_ptr<Engine>> make_peers(int threads) {
  return make_all<Engine>(threads);
}
std::vector<std::unique_ptr<QueryEngine>> make_query_peers() {
  return make_all<QueryEngine>();
}
std::vector<std::unique_ptr<NarrowEngine>> make_narrow_peers() {
  return make_all<NarrowEngine>();
}
std::vector<std::unique_ptr<ImpactEngine>> make_impact_peers() {
  return make_all<ImpactEngine>();
}
std::vector<std::unique_ptr<SceneEngine>> make_scene_peers() {
  return make_all<SceneEngine>();
}
std::vector<std::unique_ptr<RayEngine>> make_ray_peers() {
  return make_all<RayEngine>();
}
std::vector<std::unique_ptr<MeshEngine>> make_mesh_peers() {
  return make_all<MeshEngine>();
}

}  // namespace winnow::bench
