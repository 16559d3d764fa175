#pragma once

#include <winnow/winnow.h>

#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// Two bodies by their client data, the smaller first.
using Names = std::pair<ClientData, ClientData>;

[[nodiscard]] inline Names names(ClientData a, ClientData b) {
  return {a < b ? a : b, a < b ? b : a};
}

/// Bodies of all convex kinds in a cube, about six near each, and what a scene is told of them.
/// Client data are places in `bodies`.
struct SceneWorld {
  explicit SceneWorld(std::size_t count, std::uint64_t seed = 1);

  /// Gives every body a new place no farther than `step` and another turn.
  void stir(double step);
  [[nodiscard]] Pose random_pose();
  [[nodiscard]] const BodyDefinition& body(ClientData name) const {
    return bodies[static_cast<std::size_t>(name)];
  }
  [[nodiscard]] Key key(ClientData name) const { return keys[static_cast<std::size_t>(name)]; }

  /// Pairs that may touch by their sets and filters, judged one by one by the solver. Names and
  /// distances of those no farther apart than `margin`.
  [[nodiscard]] std::map<Names, double> touching(double margin = 0.0) const;

  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<BodyDefinition> bodies;
  std::vector<Key> keys;
  std::vector<bool> removed;
  Random random;
  double side;
};

[[nodiscard]] Status add_all(Scene& scene, SceneWorld& world);
[[nodiscard]] Status move_all(Scene& scene, const SceneWorld& world);

/// Every pair that contacts show.
[[nodiscard]] std::set<Names> shown(const Contacts& contacts);

/// Everything that contacts show, as numbers to be compared bit by bit.
[[nodiscard]] std::vector<std::uint64_t> digest(const Contacts& contacts);

}  // namespace winnow::test
