#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include "bench/scenes/pair_set.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Rotation of the bodies of moving pairs.
enum class PairTurn { none, little, whirl };
inline constexpr std::array kPairTurns{PairTurn::none, PairTurn::little, PairTurn::whirl};
inline constexpr std::array<std::string_view, 3> kPairTurnNames{"none", "up to 1 radian",
                                                                "up to 2 turns"};
[[nodiscard]] constexpr std::string_view to_text(PairTurn turn) noexcept {
  return kPairTurnNames[static_cast<std::size_t>(turn)];
}

/// Pairs of bodies that pass each other. Halfway through its motion each body has its pose in
/// `middle`, in which every second pair overlaps. All pairs are separate at the start.
struct MovingPairSet {
  std::unique_ptr<PairSet> middle;
  PairTurn turn{};
  std::vector<RigidMotion> motions;  ///< by body
};

/// Returns pairs whose bodies pass each other in a random direction by 2.5 to 5 times the sum of
/// their radii, half of it each, and rotate about random axes.
[[nodiscard]] MovingPairSet make_moving_pairs(const PairKind& kind, PairTurn turn,
                                              const PairSetOptions& options);

}  // namespace winnow::bench
