#pragma once

// One rank of a ClusterScene: its bodies and copies, their migration to and from other ranks, and
// its contacts. Used by cluster_scene.cpp and cluster_queries.cpp.

#include <winnow/pipeline/cluster_scene.h>
#include "pipeline/cluster/contact_events.h"
#include "pipeline/cluster/rank_group.h"
#include "pipeline/cluster/rank_members.h"
#include "pipeline/cluster/regions.h"
#include "pipeline/cluster/send_queue.h"
#include "pipeline/scene/body_pairs.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace winnow {

/// The bodies of one rank: changes by the caller, migration, and contacts. Throws std::bad_alloc if
/// memory is refused.
class RankScene : public RankMembers {
 public:
  RankScene(std::uint32_t rank, std::uint32_t ranks, const ShapePool& shapes,
            const SceneOptions& options);
  RankScene(const RankScene&) = delete;
  RankScene& operator=(const RankScene&) = delete;

  // Changes by the caller. A refused call changes nothing.

  /// Checks a batch, except for names on other ranks.
  [[nodiscard]] Status check(const ClusterSceneBatch& batch);
  /// Adds checked bodies. They belong to this rank until the next `send`.
  [[nodiscard]] Status insert(std::span<const BodyName> names, std::span<const BodyRecord> bodies);
  /// Adds checked bodies that are on every rank.
  [[nodiscard]] Status replicate(const ClusterSceneBatch& batch);
  /// Checks that the names are of replicated bodies, and that the poses are valid.
  [[nodiscard]] Status check_replicated(std::span<const BodyName> names,
                                        std::span<const Pose> poses);
  /// Moves the bodies of the last `check_replicated` that returned `ok`.
  [[nodiscard]] Status move_replicated(std::span<const Pose> poses);
  [[nodiscard]] Status move(std::span<const Key> keys, const PoseView& poses);
  [[nodiscard]] Status move(std::span<const BodyName> names, const PoseView& poses);
  [[nodiscard]] Status remove(std::span<const BodyName> names);

  // Migration: each body goes to the rank that it belongs to, and copies go to the other ranks
  // whose regions its box overlaps.

  /// Updates the boxes for the current poses. Call before `send`.
  [[nodiscard]] Status refresh();
  /// Prepares messages to other ranks about removed bodies only.
  void send_removals(const Regions& regions);
  /// Prepares messages to other ranks about the bodies and copies that they must add, update or
  /// remove: for changed bodies, or for all bodies if the regions changed.
  void send(const Regions& before, const Regions& now, bool regions_changed);
  void pack(std::vector<RankMessage>& messages) { send_queue_.pack(rank_, messages); }
  /// Applies messages of other ranks, and removes the bodies and copies that left this rank.
  [[nodiscard]] Status receive(std::span<const RankMessage> messages);

  // Contacts.

  /// Finds contacts, and the events that this rank can decide without other ranks.
  [[nodiscard]] Status collide(ContactLevel level);
  [[nodiscard]] ContactEvents& events() noexcept { return events_; }
  [[nodiscard]] const ContactEvents& events() const noexcept { return events_; }
  /// Writes the events to the contacts, after all ranks have agreed on them.
  void show_events();
  [[nodiscard]] const Contacts& contacts() const noexcept { return contacts_; }

  [[nodiscard]] RankCounts counts() const noexcept;
  /// Distributes the work of the last `collide` over the bodies that caused it. `send` resets it.
  void measure_work();
  /// Boxes of the bodies that belong to this rank, and the work of each; 1 if it was not measured.
  [[nodiscard]] CutWork cut_work();

  [[nodiscard]] std::span<const ClusterBody> arrived() const noexcept { return arrived_; }
  [[nodiscard]] std::span<const BodyName> departed() const noexcept { return departed_; }
  /// Returns the names of bodies that were removed since the last call.
  [[nodiscard]] std::vector<BodyName> take_removed() { return std::exchange(removed_, {}); }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  /// A body about which other ranks may need a message.
  struct MovedBody {
    Key key;
    Aabb sent_box;     // the box last sent; empty if there is none
    bool has_changed;  // false if only the regions changed
  };
  struct NamedId {
    BodyName name;
    ObjectId id;
    friend constexpr auto operator<=>(const NamedId&, const NamedId&) noexcept = default;
  };

  [[nodiscard]] bool is_within(const Aabb& box) const noexcept;
  [[nodiscard]] bool reports(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] Status add_bodies(std::span<const BodyName> names,
                                  std::span<const BodyRecord> bodies);
  void note(ObjectId id, bool has_changed);
  void note_all_that_cross();
  void note_changed_composites();
  void add_messages(const MovedBody& moved, const Regions& before, const Regions& now);
  void take(const BodyMessages<BodyRecord>& incoming);
  [[nodiscard]] Status apply_changes();
  void sort_names();
  void compare_contacts();
  void store_interior_flags();

  std::uint32_t rank_;
  bool is_single_rank_;
  Aabb region_;
  Contacts contacts_;
  ContactEvents events_;
  PairSelection selection_;
  std::size_t ghosts_ = 0;
  std::vector<MovedBody> moved_;
  std::vector<BodyName> removed_;
  std::vector<ClusterBody> arrived_;
  std::vector<BodyName> departed_;
  SendQueue<BodyRecord> send_queue_;
  BodyChanges<Pose, BodyRecord> changes_;
  // Order of pairs: the bodies of the last `collide` by name, bodies added since then, and the
  // tables for `selection_`.
  std::vector<NamedId> by_name_;
  std::vector<NamedId> added_;
  bool has_removed_ = false;
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
