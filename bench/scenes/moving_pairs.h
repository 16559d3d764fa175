#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include "bench/scenes/pair_set.h"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// How the bodies of moving pairs turn on their way.
enum class PairTurn { none, little, whirl };
inline constexpr std::array kPairTurns{PairTurn::none, PairTurn::little, PairTurn::whirl};
inline constexpr std::array<std::string_view, 3> kPairTurnNames{"none", "up to 1 radian",
                                                                "up to 2 turns"};
[[nodiscard]] constexpr std::string_view to_text(PairTurn turn) noexcept {
  return kPairTurnNames[static_cast<std::size_t>(turn)];
}

/// The pairs of a set as they pass: each body is in the middle of its motion where the set has it,
/// so that every second pair overlaps there. At the start all are apart.
struct MovingPairSet {
  std::unique_ptr<PairSet> middle;
  PairTurn turn{};
  std::vector<RigidMotion> motions;  ///< by body
};

/// Bodies of a pair travel past each other by 2.5 to 5 times the sum of their radii, in a random
/// direction, each half of it, and turn about random axes.
[[nodiscard]] MovingPairSet make_moving_pairs(const PairKind& kind, PairTurn turn,
                                              const PairSetOptions& options);

}  // namespace winnow::bench
