#include "bench/scenes/moving_pairs.h"

#include "bench/scenes/random_shapes.h"

#include <numbers>

namespace winnow::bench {
namespace {

double most_turn(PairTurn turn) {
  constexpr double kTurns[] = {0.0, 1.0, 4.0 * std::numbers::pi};
  return kTurns[static_cast<std::size_t>(turn)];
}

/// Returns a motion that passes through the pose at half its time.
RigidMotion through(const Pose& middle, const Eigen::Vector3d& travel,
                    const Eigen::Vector3d& turn) {
  RigidMotion back = RigidMotion::stationary(middle);
  RigidMotion motion = back;
  for (int i = 0; i < 3; ++i) {
    back.travel[i] = -0.5 * travel[i];
    back.turn[i] = -0.5 * turn[i];
    motion.travel[i] = travel[i];
    motion.turn[i] = turn[i];
  }
  motion.start = back.at(1.0);
  return motion;
}

}  // namespace

MovingPairSet make_moving_pairs(const PairKind& kind, PairTurn turn,
                                const PairSetOptions& options) {
  MovingPairSet set{make_pair_set(kind, options), turn, {}};
  const PairSet& middle = *set.middle;
  Random random(options.seed ^ 0x51D3ULL);
  set.motions.resize(middle.poses.size());
  for (const BodyPair& pair : middle.pairs) {
    const auto at = [&](std::uint32_t i) { return as_eigen(middle.poses[i].position); };
    const double reach = middle.radius[pair.a] + middle.radius[pair.b];
    Eigen::Vector3d way = random.in(2.5, 5.0) * reach * random_unit(random);
    // Chooses the sign for which the bodies start farther apart.
    if (way.dot(at(pair.b) - at(pair.a)) > 0.0) way = -way;
    for (const auto& [body, share] : {std::pair{pair.a, -0.5}, {pair.b, 0.5}}) {
      const Eigen::Vector3d axis = random_unit(random);
      set.motions[body] =
          through(middle.poses[body], share * way, random.in(0.0, most_turn(turn)) * axis);
    }
  }
  return set;
}

}  // namespace winnow::bench
