#pragma once

#include <winnow/pipeline/feature_impacts.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Kinds of motion of two mesh features in a step.
enum class FeatureSteps {
  random,    ///< all points anywhere in a unit cube, at the start and at the end
  small,     ///< start anywhere in a unit cube, and move by a hundredth
  touching,  ///< touch exactly at kTouchTime, perhaps also earlier
  passing,   ///< pass at a distance of 1e-11 to 1e-4 without touching
};
inline constexpr std::array kFeatureSteps{FeatureSteps::random, FeatureSteps::small,
                                          FeatureSteps::touching, FeatureSteps::passing};
[[nodiscard]] constexpr std::string_view to_text(FeatureSteps steps) noexcept {
  constexpr std::array<std::string_view, 4> kNames{"random", "small steps", "touching exactly",
                                                   "passing by 1e-11 to 1e-4"};
  return kNames[static_cast<std::size_t>(steps)];
}
inline constexpr double kTouchTime = 0.5;

inline constexpr std::array kFeaturePairs{FeaturePair::vertex_face, FeaturePair::edge_edge};
[[nodiscard]] constexpr std::string_view to_text(FeaturePair kind) noexcept {
  return kind == FeaturePair::vertex_face ? "vertex-face" : "edge-edge";
}

/// Steps in columns.
struct FeatureStepSet {
  std::size_t count = 0;
  /// Indexed by point, axis and pair; points 4 to 7 are the end positions.
  std::array<std::array<std::vector<double>, 3>, 8> column;

  [[nodiscard]] FeatureColumns columns() const;
};

[[nodiscard]] FeatureStepSet make_feature_steps(FeaturePair kind, FeatureSteps steps,
                                                std::size_t count, std::uint64_t seed);

}  // namespace winnow::bench
