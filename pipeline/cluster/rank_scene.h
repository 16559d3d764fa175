#pragma once

#include <winnow/core/object_filter.h>
#include <winnow/pipeline/cluster_scene.h>
#include "pipeline/cluster/contact_events.h"
#include "pipeline/cluster/name_table.h"
#include "pipeline/cluster/outbox.h"
#include "pipeline/cluster/rank_group.h"
#include "pipeline/cluster/regions.h"
#include "pipeline/scene/body_pairs.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace winnow {

struct SceneState;

/// All that a body is: how ranks tell each other, and how it is kept. Without gaps.
struct BodyRecord {
  Pose pose{};
  ShapeId shape{};
  ObjectFilter filter{};
  Motion motion = Motion::dynamic;
  std::uint8_t is_new = 0;  ///< since the last `collide`
  std::uint8_t spare[6] = {};

  [[nodiscard]] BodyDefinition definition(BodyName name) const noexcept {
    return {shape, pose, motion, filter, name};
  }
};
static_assert(sizeof(BodyRecord) == 80);

/// What one rank holds: a scene of the bodies that belong to it, copies of those of others that its
/// region meets, and what is on every rank. Throws std::bad_alloc where memory is refused.
class RankScene {
 public:
  RankScene(std::uint32_t rank, std::uint32_t ranks, const ShapePool& shapes,
            const SceneOptions& options);
  RankScene(const RankScene&) = delete;
  RankScene& operator=(const RankScene&) = delete;

  /// False for options out of range.
  [[nodiscard]] bool is_good() const noexcept;

  // What the rank is told. Refused calls change nothing.

  /// Whether bodies may be added, as far as this rank knows.
  [[nodiscard]] Status check(const ClusterSceneBatch& batch);
  /// Adds bodies that were checked. They belong to this rank until they are settled.
  [[nodiscard]] Status insert(std::span<const BodyName> names, std::span<const BodyRecord> bodies);
  /// Adds bodies that were checked, and that are on every rank.
  [[nodiscard]] Status replicate(const ClusterSceneBatch& batch);
  /// Whether replicated bodies of these names may have new poses.
  [[nodiscard]] Status check_replicated(std::span<const BodyName> names,
                                        std::span<const Pose> poses);
  /// Gives those for which the last `check_replicated` was `ok` their poses.
  [[nodiscard]] Status move_replicated(std::span<const Pose> poses);
  [[nodiscard]] Status move(std::span<const Key> keys, const PoseView& poses);
  [[nodiscard]] Status move(std::span<const BodyName> names, const PoseView& poses);
  [[nodiscard]] Status remove(std::span<const BodyName> names);

  // How bodies go where they belong, and copies to where they are met.

  /// Boxes as poses are. Before bodies are sent.
  [[nodiscard]] Status refresh();
  /// Tells other ranks what was removed, and nothing else.
  void send_removals(const Regions& regions);
  /// Tells other ranks what they hold from now on and what no more, of bodies that changed, or of
  /// all where regions did.
  void send(const Regions& before, const Regions& now, bool regions_changed);
  void pack(std::vector<Parcel>& parcels) { outbox_.pack(rank_, parcels); }
  /// Takes what others tell, and drops what this rank holds no more.
  [[nodiscard]] Status receive(std::span<const Parcel> parcels);

  // What touches.

  /// Finds contacts, and what is known of their events.
  [[nodiscard]] Status collide(ContactLevel level);
  [[nodiscard]] ContactEvents& events() noexcept { return events_; }
  [[nodiscard]] const ContactEvents& events() const noexcept { return events_; }
  /// Puts events into the contacts, once they are certain.
  void show_events();
  [[nodiscard]] const Contacts& contacts() const noexcept { return contacts_; }

  [[nodiscard]] RankCounts counts() const noexcept;
  /// Shares the work of the last `collide` among the bodies that made it; forgotten by `send`.
  void measure_work();
  /// Boxes of the bodies that belong here, and the work of each: 1 where it was not measured.
  [[nodiscard]] CutWork cut_work();

  [[nodiscard]] std::size_t size() const noexcept { return owned_; }
  [[nodiscard]] Status bodies(std::span<ClusterBody> bodies) const;
  /// All bodies that belong here.
  void records(std::vector<BodyName>& names, std::vector<BodyRecord>& bodies) const;
  [[nodiscard]] Status key_of(BodyName name, Key& key) const noexcept;
  [[nodiscard]] std::span<const ClusterBody> arrived() const noexcept { return arrived_; }
  [[nodiscard]] std::span<const BodyName> departed() const noexcept { return departed_; }
  /// Names of removed bodies, since the last call of this.
  [[nodiscard]] std::vector<BodyName> take_removed() { return std::exchange(removed_, {}); }
  [[nodiscard]] Bytes bytes() const noexcept;

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  /// Whether a shape may stand at a pose.
  [[nodiscard]] Status check(ShapeId shape, const Pose& pose) const noexcept;
  /// Of a shape that may.
  [[nodiscard]] Aabb box_around(ShapeId shape, const Pose& pose) const noexcept;

 private:
  /// What is known of a body, by the id of its key.
  enum Flag : std::uint8_t {
    kOwned = 1,        // belongs here
    kCrosses = 2,      // its box does not lie within this rank's region
    kMoved = 4,        // in moved_
    kRemoved = 8,      // to be told to others and dropped
    kReplicated = 16,  // on every rank
    kNew = 32,         // since the last collide
    kSettled = 64,     // belonged here at the last collide, and lay within
  };
  /// A body that others may have to be told of.
  struct Moved {
    Key key;
    Aabb told;         // its box when they last were; empty: they know nothing of it
    bool has_changed;  // and not regions alone
  };
  struct NamedId {
    BodyName name;
    ObjectId id;
    friend constexpr auto operator<=>(const NamedId&, const NamedId&) noexcept = default;
  };

  [[nodiscard]] SceneState& state() noexcept { return *scene_.state_; }
  [[nodiscard]] const SceneState& state() const noexcept { return *scene_.state_; }
  [[nodiscard]] bool is_owned(Key key) const noexcept {
    return scene_.contains(key) && (flags_[key.id] & (kOwned | kRemoved)) == kOwned;
  }
  [[nodiscard]] bool is_settled(ObjectId id) const noexcept {
    return (flags_[id] & (kSettled | kOwned | kCrosses)) == (kSettled | kOwned);
  }
  [[nodiscard]] Aabb box_of(ObjectId id) const noexcept;
  [[nodiscard]] BodyRecord record_of(ObjectId id) const noexcept;
  [[nodiscard]] bool is_within(const Aabb& box) const noexcept;
  [[nodiscard]] bool reports(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] Status find_keys(std::span<const BodyName> names, std::uint8_t flag,
                                 std::vector<Key>& keys) const;
  [[nodiscard]] Status add_bodies(std::span<const BodyName> names,
                                  std::span<const BodyRecord> bodies);
  void note(ObjectId id, bool has_changed);
  void note_all_that_cross();
  void note_changed_composites();
  void tell(const Moved& moved, const Regions& before, const Regions& now);
  void take(const BodyNews<BodyRecord>& news);
  [[nodiscard]] Status apply_changes();
  void sort_names();
  void compare_contacts();
  void settle_flags();

  std::uint32_t rank_;
  bool alone_;
  Aabb region_;
  Scene scene_;
  Contacts contacts_;
  ContactEvents events_;
  PairSelection selection_;
  std::vector<BodyName> names_;      // by id
  std::vector<std::uint8_t> flags_;  // by id
  NameTable table_;                  // to ids
  std::size_t owned_ = 0;
  std::size_t ghosts_ = 0;
  std::vector<Moved> moved_;
  std::vector<BodyName> removed_;
  std::vector<ClusterBody> arrived_;
  std::vector<BodyName> departed_;
  Outbox<BodyRecord> outbox_;
  BodyChanges<Pose, BodyRecord> changes_;
  // The order of pairs: all bodies by name, those that came since it was made, and what
  // `selection_` looks at.
  std::vector<NamedId> by_name_;
  std::vector<NamedId> came_;
  bool has_lost_ = false;
  bool has_collided_ = false;
  std::vector<std::uint32_t> place_;  // by id
  std::vector<std::uint32_t> body_;   // by place
  std::vector<std::uint32_t> works_;  // by id
  std::vector<Aabb> work_boxes_;
  std::vector<std::uint32_t> works_of_owned_;
  // Scratch.
  std::vector<std::uint32_t> ranks_before_;
  std::vector<std::uint32_t> ranks_now_;
  std::vector<Key> keys_;
  std::vector<Key> replicated_keys_;
  std::vector<BodyDefinition> definitions_;
};

}  // namespace winnow
