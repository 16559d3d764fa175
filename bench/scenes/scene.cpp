#include "bench/scenes/scene.h"

#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/scenes/drifting.h"
#include "bench/scenes/growing.h"
#include "bench/scenes/incoherent.h"
#include "bench/scenes/nearly_still.h"
#include "bench/scenes/resting.h"

#include <algorithm>
#include <array>

namespace winnow::bench {
namespace {

using Maker = std::unique_ptr<FrameSource> (*)(std::size_t objects, std::uint64_t seed);

constexpr std::array<SceneInfo, 18> kInfos{{
    {"uniform", "unit cubes spread evenly over a cube of side cbrt(2N), all in straight flight"},
    {"sleepy", "as uniform, but in each frame only another random 5 % of the objects move"},
    {"mixed", "cubes with edges log-uniform from 0.1 to 10 in a cube of volume 14.2 N"},
    {"clustered", "N/500 Gaussian clusters (deviation 3.5) of unit cubes, side 2 cbrt(2N)"},
    {"pile", "four layers of unit cubes that shiver and overlap, on one ground box (row 0)"},
    {"wall", "unit cubes of which all overlap on x; y and z spread over a side of sqrt(2N)"},
    {"brownian", "as uniform, but every object takes a new random step in every frame"},
    {"free_fall", "unit cubes fall, bounce and come to rest in a heap a quarter as high"},
    {"gravity", "unit cubes fall to the centre of the world, bounce and come to rest there"},
    {"mixed_1000", "cubes with edges log-uniform from 0.01 to 10 in a cube of volume 8 N"},
    {"teleport", "as uniform, but in each frame every object is somewhere else"},
    {"teleport_mixed", "as mixed, but in each frame every object is somewhere else"},
    {"respawn", "as uniform, but in each frame another tenth of the objects is somewhere else"},
    {"shear", "as uniform, but objects go along x, by a fifth of their y, and round the world"},
    {"jumps", "as uniform, but in each frame every object jumps by two edges, anywhere"},
    {"few_movers", "as uniform, but only seven objects move, however many there are"},
    {"jitter",
     "as uniform, but 99 of 100 jitter by 1e-5 about fixed positions, and no pair changes"},
    {"growth", "as uniform, but it begins with N/1000 objects, and has all after 60 frames"},
}};

constexpr std::array<Maker, kInfos.size()> kMakers{
    make_uniform,    make_sleepy,         make_mixed,     make_clustered, make_pile,
    make_wall,       make_brownian,       make_free_fall, make_gravity,   make_mixed_1000,
    make_teleport,   make_teleport_mixed, make_respawn,   make_shear,     make_jumps,
    make_few_movers, make_jitter,         make_growth};

}  // namespace

std::span<const SceneInfo> scene_infos() noexcept {
  return kInfos;
}

std::unique_ptr<FrameSource> make_scene(std::string_view name, std::size_t objects,
                                        std::uint64_t seed) {
  for (std::size_t i = 0; i < kInfos.size(); ++i) {
    if (kInfos[i].name == name) return kMakers[i](objects, seed);
  }
  return nullptr;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneInfo& info : kInfos) names.emplace_back(info.name);
  return names;
}

std::vector<std::string> main_scenes() {
  std::vector<std::string> names = scene_names();
  names.resize(kMainScenes);
  return names;
}

bool is_built_in(const std::string& name) {
  return std::any_of(kInfos.begin(), kInfos.end(),
                     [&](const SceneInfo& info) { return info.name == name; });
}

std::unique_ptr<FrameSource> scene_or_error(const std::string& name, std::size_t objects,
                                            std::uint64_t seed) {
  auto scene = make_scene(name, objects, seed);
  if (!scene)
    throw ArgumentError("there is no scene " + name + "; there are " + listed(scene_names()));
  return scene;
}

}  // namespace winnow::bench
