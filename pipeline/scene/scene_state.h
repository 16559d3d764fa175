#pragma once

// The data of a Scene: bodies as columns by id, one partition for each set (fixed, dynamic,
// sleeping), rules about pairs and the buffers of `collide`. scene_state.cpp implements most of it,
// reserve.cpp and pair_rules.cpp the rest.

#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/scene.h>
#include "core/memory/columns.h"
#include "core/memory/key_table.h"
#include "core/memory/new_in.h"
#include "partitions/pairs/linked_pairs.h"
#include "pipeline/composites/mid_phase.h"
#include "pipeline/scene/body_pairs.h"
#include "pipeline/scene/ghost_contacts.h"
#include "pipeline/scene/pair_rules.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>

namespace winnow {

class SceneObserver;

inline constexpr BodyState kAllBodyStates[kBodyStates] = {BodyState::fixed, BodyState::dynamic,
                                                          BodyState::sleeping};

/// An Aabb that is a plain struct, for Column.
struct PlainBox {
  float min[3];
  float max[3];
};

[[nodiscard]] bool are_good(const ContactOffsets& offsets) noexcept;

/// One set of bodies and its partition, which is created for the first body of the set.
struct SceneSet {
  explicit SceneSet(std::pmr::memory_resource* memory) noexcept
      : body_of(memory), with_dynamic(memory) {
    LinkedPairs(with_dynamic).forbid_linking();
  }

  std::optional<Partition> partition;
  /// Origin of the partition's boxes: the scene's origin, or the former one while memory for new
  /// boxes is refused.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// By object id of the partition.
  Column<std::uint32_t> body_of;
  /// Pairs (dynamic body, body of this set); in the dynamic set, the pairs among its own bodies.
  PairBuffer with_dynamic;
  /// Incremented by every change of the partition, or of rules that decide about its pairs.
  std::uint64_t changes = 0;
};

/// Contact and rest offsets of bodies (contact_offsets.cpp).
struct BodyOffsets {
  explicit BodyOffsets(std::pmr::memory_resource* memory) noexcept : column(memory) {}

  /// Empty until a body has offsets that are not zero.
  Column<ContactOffsets> column;
  bool any = false;

  [[nodiscard]] ContactOffsets of(std::uint32_t body) const noexcept {
    return any ? column[body] : ContactOffsets{};
  }
  /// From the first offsets on, the column has an element for every body. Returns false if memory
  /// is refused.
  [[nodiscard]] bool begin(std::size_t bodies, std::size_t room) noexcept;
};

/// Bodies whose boxes may be out of date, and a flag by id.
struct StaleBodies {
  explicit StaleBodies(std::pmr::memory_resource* memory) noexcept : bodies(memory), flag(memory) {}

  Column<std::uint32_t> bodies;
  Column<std::uint8_t> flag;

  void mark(std::uint32_t body) noexcept {
    if (flag[body] != 0) return;
    flag[body] = 1;
    bodies[bodies.size()] = body;
    bodies.set_size(bodies.size() + 1);
  }
  void clear() noexcept {
    for (const std::uint32_t body : bodies) flag[body] = 0;
    bodies.clear();
  }
  /// Takes removed bodies off the list.
  void forget_removed(const KeyTable& keys) noexcept;
  /// True if all keys are valid and different.
  [[nodiscard]] bool are_distinct(const KeyTable& keys, std::span<const Key> given) noexcept;
};

/// Boxes to be given to a partition, with their keys and bodies; and scratch of calls that work on
/// the bodies of one set: these bodies, and the keys that they had in their partition.
struct StagedBoxes {
  explicit StagedBoxes(std::pmr::memory_resource* memory) noexcept
      : boxes(memory), keys(memory), data(memory), chosen(memory), old_keys(memory) {}

  Column<PlainBox> boxes;
  Column<Key> keys;
  Column<ClientData> data;
  Column<std::uint32_t> chosen;
  Column<Key> old_keys;

  [[nodiscard]] Bytes bytes() const noexcept {
    return bytes_of(boxes, keys, data, chosen, old_keys);
  }
  /// A view of `boxes`.
  [[nodiscard]] BoxView view() const noexcept;
  template <typename Visit>
  void visit_columns(Visit&& visit) noexcept {
    visit(boxes);
    visit(keys);
    visit(data);
    visit(chosen);
    visit(old_keys);
  }
};

/// The bodies of a scene as columns, which are indexed by the ids of their keys and have holes for
/// removed bodies.
struct BodyColumns {
  explicit BodyColumns(std::pmr::memory_resource* memory) noexcept
      : keys(memory),
        shape(memory),
        pose(memory),
        body_state(memory),
        place(memory),
        moved_at(memory),
        shaped_at(memory),
        anchor(memory),
        ball(memory),
        offsets(memory) {}

  KeyTable keys;
  Column<ShapeId> shape;
  Column<Pose> pose;
  Column<BodyState> body_state;
  /// A body is an object of the partition of its set, under a key of that partition: place[body].
  /// SceneSet::body_of maps the object back to the body.
  Column<Key> place;
  /// The `clock` at the last change of the pose, and of the shape.
  Column<std::uint32_t> moved_at;
  Column<std::uint32_t> shaped_at;
  /// Pose for which the partition's box was computed. Empty without caching.
  Column<Pose> anchor;
  /// Bounding ball of the body at the time of its last box, relative to the partition's origin and
  /// grown like the box.
  Column<BodyBall> ball;
  BodyOffsets offsets;
};

/// Input and results of the mid and narrow phase for pairs that have a composite shape.
struct PartAnswers {
  explicit PartAnswers(std::pmr::memory_resource* memory) noexcept
      : pairs(memory),
        gaps(memory),
        narrow(memory),
        answers(memory),
        slot(memory),
        regions(memory) {}

  PrimitivePairs pairs;
  /// Contact distance of the two bodies, by pair of primitives. Empty without offsets.
  Column<double> gaps;
  NarrowPhase narrow;
  NarrowResult answers;
  /// Index of the result in `answers`, by pair of primitives.
  Column<std::uint32_t> slot;
  ContactRegions regions;

  [[nodiscard]] Bytes bytes() const noexcept;
};

/// Pairs that go to the narrow phase, with its state and results.
struct PairBatch {
  explicit PairBatch(std::pmr::memory_resource* memory) noexcept
      : narrow(memory),
        answers(memory),
        convex(memory),
        composite(memory),
        gaps(memory),
        floor_contacts(memory),
        floor_order(memory) {}
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;
  ~PairBatch() { delete_in(convex.memory(), parts); }

  NarrowPhase narrow;
  NarrowResult answers;
  /// Pairs of convex shapes, and pairs that have a composite shape.
  Column<BodyPair> convex;
  Column<BodyPair> composite;
  /// Contact distance by pair of `convex` or of `composite`, whichever list the narrow phase works
  /// on. Empty without offsets.
  Column<double> gaps;
  /// Results for `composite`; created for the first such pair.
  PartAnswers* parts = nullptr;
  /// Used only with SceneOptions::suppress_ghost_contacts.
  Column<FloorContact> floor_contacts;
  /// Scratch: the order of one body's floor contacts.
  Column<std::uint32_t> floor_order;

  /// Implements Scene::reserve (reserve.cpp).
  [[nodiscard]] Status reserve(const ShapePool& shapes, const SceneOptions& options,
                               const SceneCapacity& room, bool with_offsets, Pages pages);

 private:
  [[nodiscard]] bool list_rehearsal(std::size_t kinds, std::size_t count) noexcept;
};

/// The state of a Scene. Body numbers are ids, the indices of the columns.
struct SceneState : BodyColumns {
  SceneState(const ShapePool& pool, const SceneOptions& given) noexcept;
  SceneState(const SceneState&) = delete;
  SceneState& operator=(const SceneState&) = delete;

  const ShapePool& shapes;
  /// Null if the scene is not recorded.
  SceneObserver* observer = nullptr;
  SceneOptions options;
  bool options_are_good;
  /// Boxes are grown by this in every direction, in addition to contact offsets.
  double growth;

  StaleBodies stale;
  StagedBoxes staged;

  SceneSet sets[kBodyStates];
  /// World point from which boxes are measured; see BodySample.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Boxes computed since choose_origin last sampled the bodies.
  std::size_t boxes_since_sampling = 0;
  /// Fixes the origin, for ranks of a cluster: all ranks measure boxes from one point.
  bool keeps_origin = false;
  /// Unique in this process.
  std::uint64_t serial;
  std::uint32_t clock = 1;
  /// Incremented if a body is removed or changes its set.
  std::uint64_t regroupings = 0;
  std::uint64_t composites_seen = 0;

  BodyPairs pairs;
  /// Null except on ranks of a cluster.
  const PairSelection* selection = nullptr;
  PairBatch batch;
  SceneStatistics statistics;
  BodyPairRules rules;
  /// Boxes given to partitions since the last `collide`.
  std::uint64_t boxes_updated = 0;

  [[nodiscard]] SceneSet& set(BodyState which) noexcept {
    return sets[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] const SceneSet& set(BodyState which) const noexcept {
    return sets[static_cast<std::size_t>(which)];
  }
  /// False if no body has a composite shape. May stay true after the last such body was removed.
  [[nodiscard]] bool has_composites() const noexcept;
  [[nodiscard]] bool is_up_to_date() const noexcept {
    return stale.bodies.empty() && has_one_origin();
  }
  /// False while the boxes of some set are measured from a former origin.
  [[nodiscard]] bool has_one_origin() const noexcept;
  void choose_origin() noexcept;
  [[nodiscard]] Status check(ShapeId id, const Pose& at) const noexcept;
  [[nodiscard]] bool reserve(std::size_t fresh) noexcept;
  /// Implements Scene::reserve (reserve.cpp).
  [[nodiscard]] Status reserve(const SceneCapacity& room, Pages pages);
  [[nodiscard]] bool reserve_bodies(const SceneCapacity& room, Pages pages) noexcept;
  [[nodiscard]] Status reserve_sets(const SceneCapacity& room, Pages pages);
  [[nodiscard]] Key acquire(const BodyDefinition& body) noexcept;
  [[nodiscard]] Status settle(std::span<const BodyDefinition> bodies, std::span<const Key> given);
  /// Upper bound on the distance of the body's points from its position.
  [[nodiscard]] double radius(std::uint32_t body) const noexcept;
  /// Returns the box of a shape, grown in every direction, relative to `from`.
  [[nodiscard]] PlainBox bounds_from(const Eigen::Vector3d& from, ShapeId id, const Pose& at,
                                     double grown_by) const noexcept;
  /// Recomputes the balls of bodies whose boxes are measured from `from`.
  void set_balls(std::span<const std::uint32_t> bodies, const Eigen::Vector3d& from) noexcept;
  [[nodiscard]] BodyBall ball_from(const Eigen::Vector3d& from, std::uint32_t body) const noexcept;
  [[nodiscard]] Status make_partition_of(BodyState which);
  /// Writes the bodies of the given keys that are in a set into `staged.chosen`, which must have
  /// room.
  [[nodiscard]] std::span<const std::uint32_t> choose(std::span<const Key> given,
                                                      BodyState which) noexcept;
  /// Inserts bodies whose columns are set into the partition of a set.
  [[nodiscard]] Status place_bodies(BodyState which, std::span<const std::uint32_t> bodies);
  /// Inserts bodies with the boxes in `staged`, one for each body, measured from the set's origin.
  [[nodiscard]] Status place_boxes(BodyState which, std::span<const std::uint32_t> bodies);
  /// Removes the objects `places` from the partition of a set.
  void displace(BodyState which, std::span<const Key> places);
  /// Removes the given bodies that are in a set, and releases their keys.
  void take_out(std::span<const Key> given, BodyState which);
  /// Undoes place_bodies: removes bodies that were just inserted.
  void take_back(std::span<const std::uint32_t> bodies, BodyState which);
  /// Moves the given bodies that are in other sets to the set `to`. A failure changes nothing.
  [[nodiscard]] Status move_to_set(std::span<const Key> given, BodyState to);
  void set_pose(std::uint32_t body, const Pose& to) noexcept;
  [[nodiscard]] Status refresh();
  [[nodiscard]] Status refresh_set(BodyState which);
  [[nodiscard]] Status move_origin(BodyState which);
  [[nodiscard]] Status renew_boxes(SceneSet& target);
  [[nodiscard]] bool needs_box(std::uint32_t body) const noexcept;
  /// Finds all pairs whose boxes overlap, or (`all` false) only those whose bounding balls overlap
  /// too.
  [[nodiscard]] Status find_pairs(bool all);
  /// True if `collide` would make a pair of two live bodies, provided that their boxes overlap:
  /// tests sets, filters and rules (pair_rules.cpp).
  [[nodiscard]] bool accepts_pair(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] ObjectFilter filter_of(ObjectId body) const noexcept;
  /// Makes the next `collide` find all pairs again.
  void invalidate_pairs() noexcept;
};

/// True if a call with this status succeeded, and the scene is recorded.
[[nodiscard]] inline bool is_observed(Status status, const SceneState* scene) noexcept {
  return status == Status::ok && scene->observer != nullptr;
}

/// Limits the box columns of a scene on destruction: shrinks the columns that grew beyond one
/// batch, unless they were larger at construction.
class BoxRoom {
 public:
  explicit BoxRoom(StagedBoxes& staged) noexcept;
  BoxRoom(const BoxRoom&) = delete;
  BoxRoom& operator=(const BoxRoom&) = delete;
  ~BoxRoom();

 private:
  StagedBoxes& staged_;
  std::size_t room_[5];
};

/// Maps shape ids and bodies of a snapshot to the ids of the process that replays it.
struct SavedNames {
  struct Name {
    ShapeId saved;
    ShapeId now;
  };
  std::span<const Name> by_saved;  ///< sorted by the bits of `saved`
  /// Ids of bodies that keep the keys they have now; all other bodies get new keys.
  std::span<const ObjectId> kept;

  /// Returns the present id of a saved shape, or an invalid id if it is not listed.
  [[nodiscard]] ShapeId now(ShapeId saved) const noexcept {
    const auto at = std::lower_bound(
        by_saved.begin(), by_saved.end(), saved.bits,
        [](const Name& name, std::uint32_t bits) { return name.saved.bits < bits; });
    return at != by_saved.end() && at->saved == saved ? at->now : ShapeId{};
  }
};

/// Implements Scene::load. `names` is null unless ids are to be mapped.
[[nodiscard]] Status load_scene(SceneState& scene, std::span<const std::byte> saved,
                                const SavedNames* names);

}  // namespace winnow
