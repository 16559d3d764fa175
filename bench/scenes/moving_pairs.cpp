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
RigidMotion through(const Pose& middle, const Vec3d& travel, const Vec3d& turn) {
  const RigidMotion back{middle, -0.5 * travel, -0.5 * turn};
  return {back.at(1.0), travel, turn};
}

}  // namespace

MovingPairSet make_moving_pairs(const PairKind& kind, PairTurn turn,
                                const PairSetOptions& options) {
  MovingPairSet set{make_pair_set(kind, options), turn, {}};
  const PairSet& middle = *set.middle;
  Random random(options.seed ^ 0x51D3ULL);
  set.motions.resize(middle.poses.size());
  for (const BodyPair& pair : middle.pairs) {
    const double reach = middle.radius[pair.a] + middle.radius[pair.b];
    Vec3d way = random.in(2.5, 5.0) * reach * random_unit(random);
    // Chooses the sign for which the bodies start farther apart.
    if (way.dot(middle.poses[pair.b].position - middle.poses[pair.a].position) > 0.0) way = -way;
    for (const auto& [body, share] : {std::pair{pair.a, -0.5}, {pair.b, 0.5}}) {
      const Eigen::Vector3d axis = random_unit(random);
      set.motions[body] =
          through(middle.poses[body], share * way, random.in(0.0, most_turn(turn)) * axis);
    }
  }
  return set;
}

}  // namespace winnow::bench
