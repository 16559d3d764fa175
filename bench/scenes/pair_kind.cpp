#include "bench/scenes/pair_kind.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

using enum ShapeKind;

/// Names of the kinds, in the order in which they are in pairs.
constexpr std::pair<const char*, ShapeKind> kShapes[] = {{"sphere", sphere},
                                                         {"capsule", capsule},
                                                         {"box", box},
                                                         {"cylinder", cylinder},
                                                         {"cone", cone},
                                                         {"hull16", hull},
                                                         {"ellipsoid", ellipsoid},
                                                         {"taper", tapered_capsule},
                                                         {"own", support},
                                                         {"triangle", triangle},
                                                         {"half_space", half_space}};
/// The main kinds, cheapest first.
constexpr std::array<std::string_view, 11> kMain{
    "sphere-sphere",     "sphere-capsule",   "capsule-capsule", "sphere-box",
    "sphere-triangle",   "capsule-triangle", "box-box",         "box-triangle",
    "triangle-triangle", "hull16-hull16",    "hull64-hull64"};

std::vector<PairKind> make_kinds() {
  std::vector<PairKind> kinds{{"hull64-hull64", hull, hull, 64}};
  for (std::size_t i = 0; i < std::size(kShapes); ++i) {
    for (std::size_t k = i; k < std::size(kShapes); ++k) {
      const auto& [name_a, a] = kShapes[i];
      const auto& [name_b, b] = kShapes[k];
      if (a == half_space) continue;  // two half-spaces
      kinds.push_back(
          {std::string(name_a) + "-" + name_b, a, b, a == hull || b == hull ? 16U : 0U});
    }
  }
  std::ranges::stable_sort(
      kinds, {}, [](const PairKind& kind) { return std::ranges::find(kMain, kind.name); });
  return kinds;
}

}  // namespace

std::span<const PairKind> pair_kinds() {
  static const std::vector<PairKind> kinds = make_kinds();
  return kinds;
}

std::span<const PairKind> main_pair_kinds() {
  return pair_kinds().first(kMain.size());
}

const PairKind* find_pair_kind(std::string_view name) {
  const auto at = std::ranges::find(pair_kinds(), name, &PairKind::name);
  return at == pair_kinds().end() ? nullptr : &*at;
}

}  // namespace winnow::bench
