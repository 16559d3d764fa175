#pragma once

#include "bench/contenders/engine.h"
#include "bench/contenders/impact_engine.h"
#include "bench/contenders/narrow_engine.h"
#include "bench/contenders/query_engine.h"
#include "bench/contenders/ray_engine.h"
#include "bench/contenders/scene_engine.h"

#include <memory>

// One factory per adapter; each is defined only if its library is installed.
namespace winnow::bench {

[[nodiscard]] std::unique_ptr<Engine> make_bullet();
[[nodiscard]] std::unique_ptr<Engine> make_bullet_sweep();
[[nodiscard]] std::unique_ptr<Engine> make_fcl();
[[nodiscard]] std::unique_ptr<Engine> make_cgal(int threads);
[[nodiscard]] std::unique_ptr<Engine> make_embree();
[[nodiscard]] std::unique_ptr<Engine> make_ode();

[[nodiscard]] std::unique_ptr<QueryEngine> make_embree_queries();
[[nodiscard]] std::unique_ptr<RayEngine> make_embree_rays(bool robust);

[[nodiscard]] std::unique_ptr<NarrowEngine> make_bullet_narrow();
[[nodiscard]] std::unique_ptr<NarrowEngine> make_fcl_libccd();
[[nodiscard]] std::unique_ptr<NarrowEngine> make_fcl_indep();
[[nodiscard]] std::unique_ptr<NarrowEngine> make_libccd_gjk();
[[nodiscard]] std::unique_ptr<NarrowEngine> make_libccd_mpr();

[[nodiscard]] std::unique_ptr<ImpactEngine> make_bullet_continuous();
[[nodiscard]] std::unique_ptr<ImpactEngine> make_bullet_sub_simplex();
[[nodiscard]] std::unique_ptr<ImpactEngine> make_fcl_impacts();

[[nodiscard]] std::unique_ptr<SceneEngine> make_bullet_scene();
[[nodiscard]] std::unique_ptr<SceneEngine> make_fcl_scene();
[[nodiscard]] std::unique_ptr<MeshEngine> make_fcl_mesh();

}  // namespace winnow::bench
