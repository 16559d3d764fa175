#include "bench/peers/peers.h"

#include "bench/peers/registry.h"

namespace winnow::bench {

template <typename Interface>
std::vector<std::unique_ptr<Interface>> make_peers(int threads) {
  std::vector<std::unique_ptr<Interface>> engines;
  for (const auto make : registered_peers<Interface>()) engines.push_back(make(threads));
  return engines;
}

template std::vector<std::unique_ptr<Engine>> make_peers(int);
template std::vector<std::unique_ptr<Yardstick>> make_peers(int);
template std::vector<std::unique_ptr<QueryEngine>> make_peers(int);
template std::vector<std::unique_ptr<NarrowEngine>> make_peers(int);
template std::vector<std::unique_ptr<ImpactEngine>> make_peers(int);
template std::vector<std::unique_ptr<SceneEngine>> make_peers(int);
template std::vector<std::unique_ptr<RayEngine>> make_peers(int);
template std::vector<std::unique_ptr<MeshEngine>> make_peers(int);

}  // namespace winnow::bench
