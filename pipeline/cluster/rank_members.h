#pragma once

// The bodies of one rank of a ClusterScene, with their names and records. RankScene derives from
// it.

#include <winnow/core/filter.h>
#include <winnow/pipeline/cluster_scene.h>
#include "pipeline/cluster/name_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace winnow {

struct SceneState;

/// All data of a body, as ranks send and store it. Without padding.
struct BodyRecord {
  Pose pose{};
  ShapeId shape{};
  ObjectFilter filter{};
  BodyState state = BodyState::dynamic;
  std::uint8_t is_new = 0;  ///< added since the last `collide`
  std::uint8_t spare[6] = {};

  [[nodiscard]] BodyDefinition definition(BodyName name) const noexcept {
    return {shape, pose, state, filter, name};
  }
};
static_assert(sizeof(BodyRecord) == 80);

/// The bodies of one rank: bodies that belong to the rank, copies (ghosts) of other ranks' bodies
/// whose boxes overlap its region, and replicated bodies.
class RankMembers {
 public:
  RankMembers(const ShapePool& shapes, const SceneOptions& options);

  /// False if the options are out of range.
  [[nodiscard]] bool is_good() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return owned_; }
  [[nodiscard]] Status bodies(std::span<ClusterBody> bodies) const;
  /// Returns all bodies that belong to this rank.
  void records(std::vector<BodyName>& names, std::vector<BodyRecord>& bodies) const;
  [[nodiscard]] Status key_of(BodyName name, Key& key) const noexcept;

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  /// Checks whether a shape and a pose are valid.
  [[nodiscard]] Status check_shape(ShapeId shape, const Pose& pose) const noexcept;
  /// Box around a valid shape at a valid pose.
  [[nodiscard]] Aabb box_around(ShapeId shape, const Pose& pose) const noexcept;

 protected:
  /// State of a body, indexed by the id of its key.
  enum Flag : std::uint8_t {
    kOwned = 1,         // belongs to this rank
    kCrosses = 2,       // its box is not contained in this rank's region
    kMoved = 4,         // is in moved_
    kRemoved = 8,       // to be removed here and on other ranks
    kReplicated = 16,   // is on every rank
    kNew = 32,          // added since the last collide
    kWasInterior = 64,  // at the last collide belonged to this rank and did not cross
  };

  [[nodiscard]] bool is_owned(Key key) const noexcept {
    return scene_.contains(key) && (flags_[key.id] & (kOwned | kRemoved)) == kOwned;
  }
  [[nodiscard]] bool stayed_interior(ObjectId id) const noexcept {
    return (flags_[id] & (kWasInterior | kOwned | kCrosses)) == (kWasInterior | kOwned);
  }
  [[nodiscard]] Aabb box_of(ObjectId id) const noexcept;
  [[nodiscard]] BodyRecord record_of(ObjectId id) const noexcept;
  /// Finds the keys of bodies that have a flag. `invalid_key` if a name is not of one, or is given
  /// twice.
  [[nodiscard]] Status find_keys(std::span<const BodyName> names, std::uint8_t flag,
                                 std::vector<Key>& keys) const;
  [[nodiscard]] SceneState& state() noexcept { return *state_; }
  [[nodiscard]] const SceneState& state() const noexcept { return *state_; }

  Scene scene_;
  SceneState* state_ = nullptr;      // of scene_; RankScene, which may read it, sets it
  std::vector<BodyName> names_;      // by id
  std::vector<std::uint8_t> flags_;  // by id
  NameTable table_;                  // to ids
  std::size_t owned_ = 0;
};

}  // namespace winnow
