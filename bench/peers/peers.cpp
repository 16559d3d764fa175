#include "bench/peers/peers.h"

#include "bench/peers/adapters.h"

namespace winnow::bench {

std::vector<std::unique_ptr<Engine>> make_peers([[maybe_unused]] int threads) {
  std::vector<std::unique_ptr<Engine>> peers;
#ifdef WINNOW_PEER_BULLET
  peers.push_back(make_bullet());
  peers.push_back(make_bullet_sweep());
#endif
#ifdef WINNOW_PEER_FCL
  peers.push_back(make_fcl());
#endif
#ifdef WINNOW_PEER_CGAL
  peers.push_back(make_cgal(threads));
#endif
#ifdef WINNOW_PEER_EMBREE
  peers.push_back(make_embree());
#endif
#ifdef WINNOW_PEER_ODE
  peers.push_back(make_ode());
#endif
  return peers;
}

std::vector<std::unique_ptr<QueryEngine>> make_query_peers() {
  std::vector<std::unique_ptr<QueryEngine>> peers;
#ifdef WINNOW_PEER_EMBREE
  peers.push_back(make_embree_queries());
#endif
  return peers;
}

std::vector<std::unique_ptr<NarrowEngine>> make_narrow_peers() {
  std::vector<std::unique_ptr<NarrowEngine>> peers;
#ifdef WINNOW_PEER_BULLET
  peers.push_back(make_bullet_narrow());
#endif
#ifdef WINNOW_PEER_FCL
  peers.push_back(make_fcl_libccd());
  peers.push_back(make_fcl_indep());
#endif
#ifdef WINNOW_PEER_LIBCCD
  peers.push_back(make_libccd_gjk());
  peers.push_back(make_libccd_mpr());
#endif
  return peers;
}

std::vector<std::unique_ptr<ImpactEngine>> make_impact_peers() {
  std::vector<std::unique_ptr<ImpactEngine>> peers;
#ifdef WINNOW_PEER_BULLET
  peers.push_back(make_bullet_continuous());
  peers.push_back(make_bullet_sub_simplex());
#endif
#ifdef WINNOW_PEER_FCL
  peers.push_back(make_fcl_impacts());
#endif
  return peers;
}

std::vector<std::unique_ptr<SceneEngine>> make_scene_peers() {
  std::vector<std::unique_ptr<SceneEngine>> peers;
#ifdef WINNOW_PEER_BULLET
  peers.push_back(make_bullet_scene());
#endif
#ifdef WINNOW_PEER_FCL
  peers.push_back(make_fcl_scene());
#endif
  return peers;
}

std::vector<std::unique_ptr<RayEngine>> make_ray_peers() {
  std::vector<std::unique_ptr<RayEngine>> peers;
#ifdef WINNOW_PEER_EMBREE
  peers.push_back(make_embree_rays(false));
  peers.push_back(make_embree_rays(true));
#endif
  return peers;
}

std::vector<std::unique_ptr<MeshEngine>> make_mesh_peers() {
  std::vector<std::unique_ptr<MeshEngine>> peers;
#ifdef WINNOW_PEER_FCL
  peers.push_back(make_fcl_mesh());
#endif
  return peers;
}

}  // namespace winnow::bench
