#include "bench/scenes/pair_kind.h"

namespace winnow::bench {
namespace {

using enum ShapeKind;

constexpr std::array<PairKind, 11> kKinds{{{"sphere-sphere", sphere, sphere},
                                           {"sphere-capsule", sphere, capsule},
                                           {"capsule-capsule", capsule, capsule},
                                           {"sphere-box", sphere, box},
                                           {"sphere-triangle", sphere, triangle},
                                           {"capsule-triangle", capsule, triangle},
                                           {"box-box", box, box},
                                           {"box-triangle", box, triangle},
                                           {"triangle-triangle", triangle, triangle},
                                           {"hull16-hull16", hull, hull, 16},
                                           {"hull64-hull64", hull, hull, 64}}};

}  // namespace

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
