#include "bench/scenes/pair_kind.h"

namespace winnow::bench {
namespace {

using enum ShapeKind;

constexpr std::size_t kMainKinds = 11;

constexpr std::array<PairKind, 66> kKinds{{{"sphere-sphere", sphere, sphere},
                                           {"sphere-capsule", sphere, capsule},
                                           {"capsule-capsule", capsule, capsule},
                                           {"sphere-box", sphere, box},
                                           {"sphere-triangle", sphere, triangle},
                                           {"capsule-triangle", capsule, triangle},
                                           {"box-box", box, box},
                                           {"box-triangle", box, triangle},
                                           {"triangle-triangle", triangle, triangle},
                                           {"hull16-hull16", hull, hull, 16},
                                           {"hull64-hull64", hull, hull, 64},
                                           {"sphere-cylinder", sphere, cylinder},
                                           {"sphere-cone", sphere, cone},
                                           {"sphere-hull16", sphere, hull, 16},
                                           {"sphere-half_space", sphere, half_space},
                                           {"capsule-box", capsule, box},
                                           {"capsule-cylinder", capsule, cylinder},
                                           {"capsule-cone", capsule, cone},
                                           {"capsule-hull16", capsule, hull, 16},
                                           {"capsule-half_space", capsule, half_space},
                                           {"box-cylinder", box, cylinder},
                                           {"box-cone", box, cone},
                                           {"box-hull16", box, hull, 16},
                                           {"box-half_space", box, half_space},
                                           {"cylinder-cylinder", cylinder, cylinder},
                                           {"cylinder-cone", cylinder, cone},
                                           {"cylinder-hull16", cylinder, hull, 16},
                                           {"cylinder-triangle", cylinder, triangle},
                                           {"cylinder-half_space", cylinder, half_space},
                                           {"cone-cone", cone, cone},
                                           {"cone-hull16", cone, hull, 16},
                                           {"cone-triangle", cone, triangle},
                                           {"cone-half_space", cone, half_space},
                                           {"hull16-triangle", hull, triangle, 16},
                                           {"hull16-half_space", hull, half_space, 16},
                                           {"triangle-half_space", triangle, half_space},
                                           {"sphere-ellipsoid", sphere, ellipsoid},
                                           {"capsule-ellipsoid", capsule, ellipsoid},
                                           {"box-ellipsoid", box, ellipsoid},
                                           {"cylinder-ellipsoid", cylinder, ellipsoid},
                                           {"cone-ellipsoid", cone, ellipsoid},
                                           {"hull16-ellipsoid", hull, ellipsoid, 16},
                                           {"ellipsoid-ellipsoid", ellipsoid, ellipsoid},
                                           {"ellipsoid-triangle", ellipsoid, triangle},
                                           {"ellipsoid-half_space", ellipsoid, half_space},
                                           {"sphere-taper", sphere, tapered_capsule},
                                           {"capsule-taper", capsule, tapered_capsule},
                                           {"box-taper", box, tapered_capsule},
                                           {"cylinder-taper", cylinder, tapered_capsule},
                                           {"cone-taper", cone, tapered_capsule},
                                           {"hull16-taper", hull, tapered_capsule, 16},
                                           {"ellipsoid-taper", ellipsoid, tapered_capsule},
                                           {"taper-taper", tapered_capsule, tapered_capsule},
                                           {"taper-triangle", tapered_capsule, triangle},
                                           {"taper-half_space", tapered_capsule, half_space},
                                           {"sphere-own", sphere, support},
                                           {"capsule-own", capsule, support},
                                           {"box-own", box, support},
                                           {"cylinder-own", cylinder, support},
                                           {"cone-own", cone, support},
                                           {"hull16-own", hull, support, 16},
                                           {"ellipsoid-own", ellipsoid, support},
                                           {"taper-own", tapered_capsule, support},
                                           {"own-own", support, support},
                                           {"own-triangle", support, triangle},
                                           {"own-half_space", support, half_space}}};

}  // namespace

std::span<const PairKind> main_pair_kinds() noexcept {
  return std::span(kKinds).first(kMainKinds);
}

std::span<const PairKind> pair_kinds() noexcept {
  return kKinds;
}

const PairKind* find_pair_kind(std::string_view name) noexcept {
  for (const PairKind& kind : kKinds) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

}  // namespace winnow::bench
