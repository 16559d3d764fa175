#pragma once

#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// Shapes of many kinds for the bodies of a world.
struct WorldShapes {
  WorldShapes();

  ShapePool shapes;
  CompositePool composites{shapes};
  std::vector<ShapeId> movable;  ///< of size about 1: convex shapes and a compound
  std::vector<ShapeId> ground;   ///< half-space, mesh, height field, compound
};

/// All results for one pair, bit by bit.
struct FlatContact {
  std::uint32_t code = 0;  ///< of the two kinds
  BodyName a = 0;
  BodyName b = 0;
  bool persisted = false;
  std::vector<std::uint64_t> bits;

  friend bool operator==(const FlatContact&, const FlatContact&) = default;
  [[nodiscard]] auto order() const { return std::tuple(code, a, b); }
};
[[nodiscard]] std::vector<FlatContact> flattened(const Contacts& contacts);

/// A cluster of scenes on ranks of this process, and a table of its bodies from which each check
/// builds one Scene to compare with.
class ClusterSceneWorld {
 public:
  ClusterSceneWorld(const WorldShapes& shapes, std::uint32_t ranks,
                    const ClusterSceneOptions& options = {});

  /// Adds the fixed bodies, which exist on every rank.
  void add_ground();
  void move_ground(Random& random);
  /// Adds bodies within a cube of this size, each on a random rank. Some are fixed, some have
  /// filters.
  void add(std::size_t count, double size, Random& random);
  /// Adds one body at this pose.
  void add_at(const Pose& pose, Random& random);
  void move(double share, double step, Random& random);
  void remove(std::size_t count, Random& random);
  /// Calls collide on all ranks and in one scene, and compares all results.
  void check(ContactLevel level);
  /// Updates the rank of each body.
  void follow();
  /// Restores a new cluster of `ranks` ranks from the checkpoints of the current one.
  void restart(std::uint32_t ranks);

  [[nodiscard]] ClusterScene& cluster() { return *cluster_; }
  [[nodiscard]] const std::map<BodyName, BodyDefinition>& bodies() const { return bodies_; }
  [[nodiscard]] std::uint32_t rank_of(BodyName name) const { return owners_.at(name); }
  [[nodiscard]] std::vector<std::vector<std::byte>> saved() const;
  /// Returns a scene of all bodies, added in the order of their names.
  [[nodiscard]] std::unique_ptr<Scene> one_scene() const;

 private:
  using PairOrder = std::tuple<std::uint32_t, BodyName, BodyName>;

  [[nodiscard]] BodyDefinition make_body(const Pose& pose, Random& random) const;
  /// Adds each body on a random rank.
  void add_bodies(const std::vector<BodyDefinition>& bodies, Random& random);
  void check_events(const std::vector<FlatContact>& found);
  [[nodiscard]] std::vector<FlatContact> found() const;
  [[nodiscard]] std::vector<FlatContact> expected(ContactLevel level) const;

  const WorldShapes& shapes_;
  ClusterSceneOptions options_;
  std::unique_ptr<LoopbackTransport> transport_;
  std::unique_ptr<ClusterScene> cluster_;
  std::map<BodyName, BodyDefinition> bodies_;
  std::map<BodyName, BodyDefinition> ground_;
  std::map<BodyName, std::uint32_t> owners_;
  std::set<BodyName> fresh_;
  std::set<PairOrder> touched_;
  BodyName next_ = 1;
};

}  // namespace winnow::test
