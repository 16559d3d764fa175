#pragma once

#include <winnow/pipeline/scene.h>
#include "core/memory/key_table.h"
#include "core/memory/new_in.h"
#include "partitions/pairs/linked_pairs.h"
#include "pipeline/scene/body_pairs.h"
#include "pipeline/scene/layers.h"
#include "pipeline/scene/seams.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>

namespace winnow {

inline constexpr Motion kEveryMotion[kMotions] = {Motion::fixed, Motion::dynamic, Motion::sleeping};

/// A box as a column can hold it.
struct PlainBox {
  float min[3];
  float max[3];
};

[[nodiscard]] bool are_good(const ContactOffsets& offsets) noexcept;

/// One set of bodies and its partition, made when its first body comes.
struct SceneSet {
  explicit SceneSet(std::pmr::memory_resource* memory) noexcept
      : body_of(memory), with_dynamic(memory) {
    LinkedPairs(with_dynamic).forbid();
  }

  std::optional<Partition> partition;
  /// What the partition's boxes are measured from: the scene's origin, or the one before while
  /// memory for new boxes is refused.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// By the partition's object id.
  Column<std::uint32_t> body_of;
  /// Pairs (dynamic body, body of this set); of the dynamic set its own.
  PairBuffer with_dynamic;
  /// Grows with every change of the partition.
  std::uint64_t changes = 0;
};

/// What is asked and answered about the parts of pairs with a composite shape.
struct PartAnswers {
  explicit PartAnswers(std::pmr::memory_resource* memory) noexcept
      : pairs(memory),
        gaps(memory),
        narrow(memory),
        answers(memory),
        slot(memory),
        regions(memory) {}

  PrimitivePairs pairs;
  /// By pair of parts, the gap of their bodies. Empty without offsets.
  Column<double> gaps;
  NarrowPhase narrow;
  NarrowResult answers;
  /// By pair of parts: where its answer lies.
  Column<std::uint32_t> slot;
  ContactRegions regions;

  [[nodiscard]] Bytes bytes() const noexcept;
};

/// What a Scene consists of. Bodies are numbered by the ids of their keys; columns are by id and
/// have holes where bodies were removed.
struct SceneState {
  SceneState(const ShapePool& pool, const SceneOptions& given) noexcept;
  SceneState(const SceneState&) = delete;
  SceneState& operator=(const SceneState&) = delete;
  ~SceneState() { delete_in(options.memory, parts); }

  const ShapePool& shapes;
  SceneOptions options;
  bool options_are_good;
  /// By how much boxes are grown to every side, but for offsets.
  double growth;

  KeyTable keys;
  Column<ShapeId> shape;
  Column<Pose> pose;
  Column<Motion> motion;
  /// Of the body in the partition of its set.
  Column<Key> place;
  /// When the pose, and when the shape last changed, in calls of `collide`.
  Column<std::uint32_t> moved_at;
  Column<std::uint32_t> shaped_at;
  /// Pose at which the partition was given the body's box. Empty without carry-over.
  Column<Pose> anchor;
  /// What holds the body as it was when the partition was given its box, measured from where that
  /// is, and grown as much.
  Column<BodyBall> ball;
  /// Empty as long as no body has had any.
  Column<ContactOffsets> offsets;
  bool with_offsets = false;
  /// The same of layers, and which of them meet.
  Column<std::uint16_t> layer;
  bool with_layers = false;
  LayerMatrix layers;
  /// Bodies whose boxes may no longer be right, and a flag by id.
  Column<std::uint32_t> stale;
  Column<std::uint8_t> is_stale;
  /// Boxes on their way to a partition, and whose they are.
  Column<PlainBox> boxes;
  Column<Key> boxes_of;
  Column<ClientData> boxes_body;
  /// Bodies of one set that a call is about, and where they were.
  Column<std::uint32_t> chosen;
  Column<Key> left;
  template <typename Visit>
  void visit_box_columns(Visit&& visit) noexcept {
    visit(boxes);
    visit(boxes_of);
    visit(boxes_body);
    visit(chosen);
    visit(left);
  }

  SceneSet sets[kMotions];
  /// What boxes are measured from; see ScenePlaces.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Boxes made since bodies were last looked at for a better one.
  std::size_t boxes_since_look = 0;
  /// The origin stays where it is: on ranks of a cluster, whose boxes are all of one frame.
  bool keeps_origin = false;
  /// Tells this scene from every other one.
  std::uint64_t serial;
  std::uint32_t clock = 1;
  /// Grows when a body is removed or changes its set.
  std::uint64_t regroupings = 0;
  std::uint64_t composites_seen = 0;

  BodyPairs pairs;
  /// Null but on ranks of a cluster.
  const PairSelection* selection = nullptr;
  NarrowPhase narrow;
  NarrowResult answers;
  /// Which pairs of `pairs` are asked about: convex ones, and those with a composite shape.
  Column<BodyPair> convex;
  Column<BodyPair> composite;
  /// By pair of `convex` or `composite`, whichever the narrow phase answers. Empty without offsets.
  Column<double> gaps;
  /// Of `composite`; made when there is the first one.
  PartAnswers* parts = nullptr;
  /// Not used unless floors are seamless.
  Column<FloorContact> floor_contacts;
  /// Room for the order in which those of one body are looked at.
  Column<std::uint32_t> floor_order;
  SceneStatistics statistics;
  /// Bodies that never meet, as (smaller id << 32 | larger id), sorted; and by id whether a body
  /// is among them, where there were that many when it was told.
  Column<std::uint64_t> ignored;
  Column<std::uint8_t> ignores;
  PairPredicate predicate;
  /// Boxes updated since the last `collide`.
  std::uint64_t boxes_updated = 0;

  [[nodiscard]] SceneSet& set(Motion which) noexcept {
    return sets[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] const SceneSet& set(Motion which) const noexcept {
    return sets[static_cast<std::size_t>(which)];
  }
  /// False if no body has a composite shape; true also a while after the last one that had.
  [[nodiscard]] bool has_composites() const noexcept;
  [[nodiscard]] bool is_fresh() const noexcept { return stale.empty() && has_one_origin(); }
  /// True unless some set's boxes are still measured from another point.
  [[nodiscard]] bool has_one_origin() const noexcept;
  void choose_origin() noexcept;
  [[nodiscard]] Status check(ShapeId id, const Pose& at) const noexcept;
  /// Offsets of bodies (contact_offsets.cpp).
  [[nodiscard]] bool has_offsets() const noexcept { return with_offsets; }
  [[nodiscard]] ContactOffsets offsets_of(std::uint32_t body) const noexcept {
    return has_offsets() ? offsets[body] : ContactOffsets{};
  }
  [[nodiscard]] bool begin_offsets() noexcept;
  /// Pairs no farther apart than this are contacts.
  [[nodiscard]] double gap_of(const BodyPair& pair) const noexcept;
  [[nodiscard]] bool reserve(std::size_t fresh) noexcept;
  /// See Scene::reserve (reserve.cpp).
  [[nodiscard]] Status reserve(const SceneRoom& room, Pages pages);
  [[nodiscard]] bool reserve_bodies(const SceneRoom& room, Pages pages) noexcept;
  [[nodiscard]] Status reserve_sets(const SceneRoom& room, Pages pages);
  [[nodiscard]] Status reserve_answers(const SceneRoom& room, Pages pages);
  [[nodiscard]] bool list_rehearsal(std::size_t kinds, std::size_t count) noexcept;
  [[nodiscard]] Key acquire(const BodyDefinition& body) noexcept;
  [[nodiscard]] Status settle(std::span<const BodyDefinition> bodies, std::span<const Key> given);
  [[nodiscard]] bool are_distinct(std::span<const Key> given) noexcept;
  void forget_stale() noexcept;
  /// No point of the body is farther than this from its position.
  [[nodiscard]] double radius(std::uint32_t body) const noexcept;
  /// The box around a shape, grown to every side, and measured from a point.
  [[nodiscard]] PlainBox bounds_from(const Eigen::Vector3d& from, ShapeId id, const Pose& at,
                                     double grown_by) const noexcept;
  /// The bodies' boxes are measured from `from`.
  void set_balls(std::span<const std::uint32_t> bodies, const Eigen::Vector3d& from) noexcept;
  [[nodiscard]] BodyBall ball_from(const Eigen::Vector3d& from, std::uint32_t body) const noexcept;
  [[nodiscard]] BoxView box_view() const noexcept;
  [[nodiscard]] Status make_partition_of(Motion which);
  /// Those of the given keys whose bodies are in a set, into `chosen`. Room was made.
  [[nodiscard]] std::span<const std::uint32_t> choose(std::span<const Key> given,
                                                      Motion which) noexcept;
  /// Puts bodies, whose columns are set, into the partition of a set.
  [[nodiscard]] Status place_bodies(Motion which, std::span<const std::uint32_t> bodies);
  /// The same with what lies in `boxes`, one for each, measured from the set's origin.
  [[nodiscard]] Status place_boxes(Motion which, std::span<const std::uint32_t> bodies);
  /// Takes out what lies at `places`.
  void displace(Motion which, std::span<const Key> places);
  /// Takes those of the given bodies that are in a set out of it, and gives their keys back.
  void take_out(std::span<const Key> given, Motion which);
  /// Takes out bodies that were just placed, as if they had never been.
  void take_back(std::span<const std::uint32_t> bodies, Motion which);
  /// Moves those of the given bodies that are elsewhere. A refusal changes nothing.
  [[nodiscard]] Status move_to_set(std::span<const Key> given, Motion to);
  void mark_stale(std::uint32_t body) noexcept;
  void set_pose(std::uint32_t body, const Pose& to) noexcept;
  [[nodiscard]] Status refresh();
  [[nodiscard]] Status refresh_set(Motion which);
  [[nodiscard]] Status move_origin(Motion which);
  [[nodiscard]] Status renew_boxes(SceneSet& target);
  [[nodiscard]] bool needs_box(std::uint32_t body) const noexcept;
  /// With all pairs whose boxes meet, or without those whose balls are apart.
  [[nodiscard]] Status find_pairs(bool all);
  /// Which pairs may meet (meetings.cpp).
  [[nodiscard]] bool meets_all() const noexcept {
    return ignored.empty() && layers.all_meet() && predicate.accept == nullptr;
  }
  [[nodiscard]] bool begin_layers() noexcept;
  [[nodiscard]] std::uint16_t layer_of(std::uint32_t body) const noexcept {
    return with_layers ? layer[body] : std::uint16_t{0};
  }
  [[nodiscard]] bool may_pair(ObjectId a, ObjectId b) const noexcept;
  /// All that decides whether `collide` makes a pair of two live bodies whose boxes meet.
  [[nodiscard]] bool would_pair(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] ObjectFilter filter_of(ObjectId body) const noexcept;
  [[nodiscard]] bool is_ignored(ObjectId a, ObjectId b) const noexcept;
  [[nodiscard]] bool add_ignored(std::span<const KeyPair> told) noexcept;
  void forget_ignored(std::span<const Key> removed) noexcept;
  template <typename Unwanted>
  void drop_ignored(Unwanted&& is_unwanted) noexcept {
    std::uint64_t* const end = std::remove_if(ignored.begin(), ignored.end(), is_unwanted);
    ignored.set_size(static_cast<std::size_t>(end - ignored.begin()));
  }
  /// All pairs are found anew by the next `collide`.
  void ask_again() noexcept;
};

/// When it goes it gives back what boxes of more bodies than a batch took, unless there was room
/// for them when it came.
class BoxRoom {
 public:
  explicit BoxRoom(SceneState& scene) noexcept;
  BoxRoom(const BoxRoom&) = delete;
  BoxRoom& operator=(const BoxRoom&) = delete;
  ~BoxRoom();

 private:
  SceneState& scene_;
  std::size_t room_[5];
};

/// What shapes and bodies of a snapshot are called where it is played.
struct SavedNames {
  struct Name {
    ShapeId saved;
    ShapeId now;
  };
  std::span<const Name> by_saved;  ///< ascending by the bits of `saved`
  /// Ids of bodies that had the same keys before; keys of all others are new ones.
  std::span<const ObjectId> kept;

  /// No shape of one that is not among them.
  [[nodiscard]] ShapeId now(ShapeId saved) const noexcept {
    const auto at = std::lower_bound(
        by_saved.begin(), by_saved.end(), saved.bits,
        [](const Name& name, std::uint32_t bits) { return name.saved.bits < bits; });
    return at != by_saved.end() && at->saved == saved ? at->now : ShapeId{};
  }
};

/// As Scene::load; with names, of what is called otherwise here.
[[nodiscard]] Status load_scene(SceneState& scene, std::span<const std::byte> saved,
                                const SavedNames* names);

}  // namespace winnow
