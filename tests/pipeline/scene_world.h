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

/// The client data of two bodies, the smaller first.
using Names = std::pair<ClientData, ClientData>;

[[nodiscard]] inline Names names(ClientData a, ClientData b) {
  return {a < b ? a : b, a < b ? b : a};
}

/// Bodies of all convex kinds in a cube, each with about six neighbours, and their definitions.
/// Client data are indices of `bodies`.
struct SceneWorld {
  explicit SceneWorld(std::size_t count, std::uint64_t seed = 1);

  /// Moves every body by up to `step` and gives it a new orientation.
  void stir(double step);
  [[nodiscard]] Pose random_pose();
  [[nodiscard]] const BodyDefinition& body(ClientData name) const {
    return bodies[static_cast<std::size_t>(name)];
  }
  [[nodiscard]] Key key(ClientData name) const { return keys[static_cast<std::size_t>(name)]; }

  /// Returns the pairs that states and filters admit and that are no farther apart than `margin`,
  /// with their distances, by calling the solver for each pair.
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

/// Returns all pairs in the contacts.
[[nodiscard]] std::set<Names> shown(const Contacts& contacts);

/// Returns all results in the contacts as numbers that can be compared bit by bit.
[[nodiscard]] std::vector<std::uint64_t> digest(const Contacts& contacts);

}  // namespace winnow::test
