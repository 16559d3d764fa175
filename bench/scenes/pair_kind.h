#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shapes.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace winnow::bench {

/// A kind of pair that is measured. `a` precedes `b` in the order of the kinds, except that
/// triangles and half-spaces are last.
struct PairKind {
  std::string name{};
  ShapeKind a{};
  ShapeKind b{};
  /// Number of vertices of the pair's hulls, if any: points on an ellipsoid, all of which are
  /// vertices.
  std::uint32_t hull_vertices = 0;
};

/// Returns the kinds that every benchmark uses, cheapest first.
[[nodiscard]] std::span<const PairKind> main_pair_kinds();
/// Returns all kinds: the main ones, then all remaining pairs of sphere, capsule, box, cylinder,
/// cone, hull, ellipsoid, tapered capsule ("taper" in names), lens ("own" in names: a user shape),
/// triangle and half-space.
[[nodiscard]] std::span<const PairKind> pair_kinds();
/// Returns null if there is no kind of this name.
[[nodiscard]] const PairKind* find_pair_kind(std::string_view name);

/// Levels of a narrow-phase query.
inline constexpr std::array kLevels{ContactLevel::boolean, ContactLevel::distance,
                                    ContactLevel::manifold};
inline constexpr std::array<std::string_view, 3> kLevelNames{"boolean", "distance", "manifold"};
inline constexpr std::array kTiers{NarrowTier::robust, NarrowTier::reference};
inline constexpr std::array<std::string_view, 2> kTierNames{"robust", "reference"};

[[nodiscard]] constexpr std::string_view to_text(ContactLevel level) noexcept {
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    if (kLevels[i] == level) return kLevelNames[i];
  }
  return "pairs";
}
[[nodiscard]] constexpr std::string_view to_text(NarrowTier tier) noexcept {
  return kTierNames[static_cast<std::size_t>(tier)];
}

}  // namespace winnow::bench
