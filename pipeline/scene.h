#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/column.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/pose.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/status.h>
#include <winnow/core/vec3.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct SceneState;

/// Which set of a scene a body is in. Dynamic bodies meet all others; fixed ones and sleeping ones
/// meet dynamic ones alone, and cost nothing until one of these comes near.
enum class Motion : std::uint8_t {
  fixed,     ///< never moves by itself: ground, walls
  dynamic,   ///< meets everything
  sleeping,  ///< came to rest; wakes by `Scene::set_motion`
};
/// How many there are.
inline constexpr std::size_t kMotions = 3;

/// What a scene is made with.
struct SceneOptions {
  /// Every allocation comes from here. It must outlive the scene.
  std::pmr::memory_resource* memory = default_memory();
  /// On whose threads work runs; results are the same on all.
  Execution execution = Execution::parallel();
  /// The structure of each set's partition, by Motion. A partition is made when its first body
  /// comes, or is reserved for. Fixed bodies that are asked about often may be worth the slow build
  /// of static_bvh().
  StructureKind structures[kMotions] = {linear_bvh(), linear_bvh(), linear_bvh()};
  /// Speculative: pairs no farther apart than this are contacts too; what bodies have of their own
  /// (see ContactOffsets) comes on top of it. Finite, >= 0.
  double margin = 0.0;
  NarrowTier tier = NarrowTier::robust;  ///< how exact contacts have to be
  /// What rests keeps its contacts: manifolds of a pair are carried over, turned with body a, as
  /// long as neither body has moved, against the other, by more than this (a length: translation
  /// and turning of its farthest point together) since they were made; error_bound grows by as
  /// much. Boxes in the partitions are larger by it, so that bodies that move less need no update
  /// there. 0: off, and every answer is that of a fresh scene, bit by bit. Finite, >= 0.
  double carry_over = 0.0;
  /// At level manifold, of pairs with a mesh, a height field or a compound: one manifold for each
  /// region of contact, with at most kManifoldPoints points, in place of one for each pair of parts
  /// that touch (see MidPhase::reduce and ContactRegion), as Jolt has it by default and as Bullet
  /// has one for a pair of bodies at all; a frame takes a tenth longer without a margin, and up to
  /// half where the margin is wide. Off: all manifolds of all parts, raw.
  bool contact_reduction = false;
  /// Fixed bodies that lie flush are one floor to what slides over them: at levels distance and
  /// manifold a contact of a dynamic body with one is left out if another fixed body holds it in a
  /// plane, as deep or deeper, all points of the contact are in the plane or below it, the normals
  /// differ by 5 to 120 degrees, and the body (of a composite one the parts touched) does not rise
  /// above the plane there, by more than 1/1000 of the dynamic body's radius or more steeply than 5
  /// degrees: it is with a side or an edge of a seam then. Steps, kerbs, walls, slopes and ridges
  /// stay. Pairs with fixed bodies are not carried over, and the search, O(n log n + pairs of
  /// contacts of one body whose normals differ so), runs on the thread that calls.
  bool seamless_floors = false;
  /// Contacts tell where each pair and each point was in the last frame (Contacts::previous_pair
  /// and previous_point), so that a solver starts from the impulses that it found then. Takes 4
  /// bytes for each pair, 5 for each point and 56 for each body.
  bool warm_start = false;
  /// That of the partitions (see PartitionOptions).
  std::size_t build_budget = 0;
  /// What holds triangle meshes, compounds and height fields; null for a scene without. Must
  /// outlive the scene.
  const MidPhase* composites = nullptr;
};

/// How far from its surface a body's contacts begin, and where it comes to rest. What two bodies
/// have is added, as in PhysX: they are a contact from the gap `a.contact + b.contact` on (and the
/// scene's margin besides), and rest where they are `a.rest + b.rest` apart: distances and depths
/// are measured as if the surface of each were moved out by its `rest`, points lie halfway between
/// these surfaces. So a fast body gets its contacts early, thin cloth rests above the ground, and
/// bodies of negative `rest` sink into each other unnoticed.
///
/// Counts at levels distance and manifold; at level pairs boxes are larger by `contact`; what
/// overlaps at level boolean, for queries and for sensors is the shapes themselves.
struct ContactOffsets {
  double contact = 0.0;  ///< a length, finite, >= 0 and >= `rest`
  double rest = 0.0;     ///< a length, finite; below 0 the surface is moved in

  /// Both are the same.
  friend constexpr bool operator==(const ContactOffsets&, const ContactOffsets&) noexcept = default;
};

/// So many layers bodies may be in; see Scene::set_layers_meet.
inline constexpr std::uint32_t kSceneLayers = 4096;

/// A body as it is added.
struct BodyDefinition {
  ShapeId shape{};  ///< of the ShapePool, or of what `SceneOptions::composites` holds
  /// Where the shape's own frame stands in the world; finite, its quaternion not zero.
  Pose pose{};
  Motion motion = Motion::dynamic;  ///< which set it is in
  ObjectFilter filter{};            ///< which other bodies it may meet
  ClientData data = 0;              ///< yours, given back with contacts and hits; never read
  /// Where its contacts begin. The first body that has any makes the scene hold 16 bytes for each.
  ContactOffsets offsets{};
  /// Below kSceneLayers: see Scene::set_layers_meet. The first body that is not in layer 0 makes
  /// the scene hold 2 bytes for each.
  std::uint16_t layer = 0;
};

/// How much a scene is to have room for; see Scene::reserve. Each at most 2^32 - 2, and fewer than
/// 2^28 bodies in all.
struct SceneRoom {
  std::size_t bodies[kMotions] = {};  ///< by Motion
  /// Pairs of bodies that the broad phase finds; see SceneStatistics::body_pairs.
  std::size_t pairs = 0;
  /// That `collide` is asked for.
  ContactLevel level = ContactLevel::manifold;
  /// What Contacts hold: pairs that touch, those that sleep counted in; at level pairs it is all
  /// pairs.
  std::size_t touching = 0;
  /// From level boolean on: as many as pairs that touch, where no shape is composite.
  std::size_t manifolds = 0;
  std::size_t points = 0;  ///< at level manifold
};

/// Bytes of a scene by part. The sum equals, to the byte, what is outstanding at its resource.
struct WINNOW_API SceneFootprint {
  Bytes bodies;                ///< shapes, poses, keys, filters, client data, the scene itself
  Bytes partitions[kMotions];  ///< by Motion
  Bytes pairs;                 ///< what the broad phase found
  Bytes mid_phase;             ///< pairs of primitives; nothing without composite shapes
  Bytes narrow_phase;          ///< answers and scratch

  /// Sum of all parts.
  [[nodiscard]] Bytes total() const noexcept;
};

/// Counters of the last `collide`, never timings, so that they repeat exactly.
struct SceneStatistics {
  std::uint64_t boxes_updated = 0;  ///< boxes that partitions were given since the one before
  std::uint64_t body_pairs = 0;     ///< pairs that the broad phase found
  /// Of them not asked about any further since balls around the bodies are apart; 0 at level pairs.
  std::uint64_t balls_apart = 0;
  std::uint64_t carried = 0;          ///< of the others kept what they had
  std::uint64_t primitive_pairs = 0;  ///< pairs of parts that the mid phase made
  NarrowStatistics convex;            ///< narrow phase, pairs of convex bodies
  NarrowStatistics parts;             ///< narrow phase, pairs of parts
};

/// Bodies with shapes and poses, and what touches what: broad, mid and narrow phase in one.
///
///     winnow::ShapePool shapes;
///     winnow::Scene scene(shapes);
///     scene.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)}, key);
///     scene.collide(winnow::ContactLevel::manifold, contacts);
///
/// Parallel work runs in the arena of the thread that calls. Results and their order are the same
/// on any number of threads and any instruction set. A refused call (any Status but ok) changed
/// nothing. A scene wants its calls one at a time; see SceneQueries for asking from many threads.
class WINNOW_API Scene {
 public:
  /// `shapes` must outlive the scene; shapes must stay in it while bodies use them. Options that
  /// are out of range make every `add` answer `invalid_argument`. A scene for which no memory was
  /// left stays empty and answers `out_of_memory`.
  explicit Scene(const ShapePool& shapes, const SceneOptions& options = {}) noexcept;
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// Adds a body. `invalid_key` for a shape that neither pool has, `invalid_pose`;
  /// `invalid_argument` for offsets or a layer out of range; `too_many_objects` beyond 2^28.
  Status add(const BodyDefinition& body, Key& key);
  /// The same for who asks the key: the null key, which every call refuses, if the body was
  /// refused.
  Key add(const BodyDefinition& body) {
    Key key;
    return add(body, key) == Status::ok ? key : Key{};
  }
  /// Adds many at once, all or none. `size_mismatch` if there are not as many keys as bodies.
  Status add(std::span<const BodyDefinition> bodies, std::span<Key> keys);
  /// A key that occurs twice makes the whole call `invalid_key`.
  Status remove(Key key);
  /// Removes many at once, all or none.
  Status remove(std::span<const Key> keys);
  /// Removes every body. Their keys are stale from then on; memory is kept.
  void clear() noexcept;

  /// A steady frame allocates nothing, that is, one that has no more of anything than one before:
  /// a new maximum of bodies, pairs or contacts does. This moves that point: to add up to so many
  /// bodies of convex shapes, and a first `collide` at this level of up to so many pairs that find
  /// so many points, then asks the memory resource for nothing. `too_many_objects` or
  /// `out_of_memory` change nothing. O(room): the narrow phase is asked about as many pairs, of the
  /// kinds of shapes that are in the pool by then, so that these should be in it.
  ///
  /// Not counted in, and asked for when it is met first: what partitions need besides in later
  /// frames (to follow what moves, comes and goes, see Partition::reserve); filters; what the mid
  /// and narrow phase need for parts of composite shapes; and pairs between two sets of more than
  /// about 10,000 bodies each on several threads.
  Status reserve(const SceneRoom& room, Pages pages = Pages::untouched);
  /// Makes room in Contacts for what `room` says, for `collide` by this scene: nothing in it is
  /// left out. `too_many_objects` or `out_of_memory` change nothing. O(1) but for pages that are
  /// touched and contents that are moved.
  Status reserve_contacts(Contacts& out, const SceneRoom& room,
                          Pages pages = Pages::untouched) const;

  /// Gives bodies new poses. O(1) each; the partitions follow at the next question.
  Status move(Key key, const Pose& pose);
  /// Gives each of the bodies its pose, all or none: `size_mismatch`, `invalid_key`,
  /// `invalid_pose`. Of a key that occurs twice the last pose counts. Of a view without
  /// orientations: new positions, each body as it is turned.
  Status move(std::span<const Key> keys, const PoseView& poses);
  /// Moves bodies from one set to another: sleeping bodies to dynamic when they wake.
  Status set_motion(Key key, Motion motion);
  /// The same for many bodies, all or none.
  Status set_motion(std::span<const Key> keys, Motion motion);
  /// Gives a body another shape, at the pose that it has. `invalid_key` for a key or a shape that
  /// is not there.
  Status set_shape(Key key, ShapeId shape);
  /// Says anew which others a body may meet; counts from the next question on.
  Status set_filter(Key key, const ObjectFilter& filter);
  /// Says anew where a body's contacts begin and where it rests. `invalid_argument` for offsets out
  /// of range. O(1), but for the first ones of a scene.
  Status set_offsets(Key key, const ContactOffsets& offsets);

  /// Layers beyond the 32 of a filter: each body is in one, layer 0 unless it is told another, and
  /// all meet until two, which may be the same, are told not to. The order of the two is of no
  /// effect. A filter is asked while pairs are found and costs next to nothing; layers are asked
  /// about each pair that is found, by one look into a square of bits. `invalid_argument` for
  /// layers out of range. O(1) beside pairs that are found anew; the square has a bit for each two
  /// layers up to the highest that was told not to meet one.
  Status set_layers_meet(std::uint16_t a, std::uint16_t b, bool meet = true);
  /// True unless the two were told not to.
  [[nodiscard]] bool layers_meet(std::uint16_t a, std::uint16_t b) const noexcept;
  /// Puts a body into another layer; counts from the next question on. `invalid_argument` for a
  /// layer out of range.
  Status set_layer(Key key, std::uint16_t layer);
  /// The layer of a live body; 0 for any other.
  [[nodiscard]] std::uint16_t layer(Key key) const noexcept;

  /// Bodies that never meet, whatever their filters say: neighbouring links of a robot, bones of a
  /// ragdoll. `ignored` false lets them meet again; the order of the two is of no effect, and what
  /// is told twice stands once. Removing a body ends what was said of it. A body that is told to
  /// ignore itself is `invalid_argument`. O(pairs log pairs + all that are ignored); a scene with
  /// none pays nothing.
  Status set_ignored(Key a, Key b, bool ignored = true);
  /// The same for many pairs, all or none.
  Status set_ignored(std::span<const KeyPair> pairs, bool ignored = true);
  /// True if the two were told to ignore each other, in either order; false for stale keys.
  [[nodiscard]] bool is_ignored(Key a, Key b) const noexcept;
  /// Asked about every pair of bodies, by the ids of their keys, whose boxes meet, whose filters
  /// let them and that are not ignored. A pair is not asked about in every frame: to have other
  /// answers given, set it again. See ObjectPredicate for what it may do.
  void set_predicate(const PairPredicate& predicate) noexcept;

  /// Live bodies of all sets.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Live bodies of one set.
  [[nodiscard]] std::size_t size(Motion motion) const noexcept;
  /// True for keys of live bodies of this scene. O(1).
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// The body as it stands now.
  Status body(Key key, BodyDefinition& body) const noexcept;
  /// Key of a live body by its id; the null key for any other.
  [[nodiscard]] Key key_of(ObjectId id) const noexcept;

  /// Brings boxes and partitions up to date now rather than in the next question.
  Status refresh();

  /// Everything that touches. Pairs of a fixed or sleeping body with another are not looked at;
  /// contacts of two bodies that fell asleep are remembered, neither shown nor ended, until one
  /// wakes. `out_of_memory` leaves `contacts` cleared.
  Status collide(ContactLevel level, Contacts& contacts);

  /// Appends all that bodies are to bytes: keys, shapes by id, poses, motions, filters, client
  /// data, who ignores whom, the boxes that partitions have of them, and margin, tier, carry-over
  /// and what else the options say of answers; pipeline/CONTRACT.md has the format. The pools of
  /// shapes are saved beside, and so are contacts. `out_of_memory` leaves `out` as it was.
  /// O(bodies).
  Status save(Column<std::byte>& out) const;
  /// Becomes what was saved, with the memory, execution, structures, predicate and pools that it
  /// has, of which the pools have to be loaded before: contacts go on bit for bit as those of the
  /// scene that was saved, on any number of threads and any instruction set. Keys that were saved
  /// are those of the same bodies again, unless another scene or partition of this process has them
  /// by now; `key_of` tells. Contacts that were filled before are strangers from then on; see
  /// `load_contacts`. `invalid_argument` for anything that was not saved so, whoever made it, or of
  /// shapes that the pools do not have, and `out_of_memory`, change nothing. O(bodies).
  Status load(std::span<const std::byte> saved);
  /// Appends what contacts that this scene filled last show and remember (`invalid_key` for others)
  /// to bytes. `out_of_memory` leaves `out` as it was. O(contacts).
  Status save_contacts(const Contacts& contacts, Column<std::byte>& out) const;
  /// Contacts become what was saved of those of this scene as it stands, which was loaded before:
  /// the next `collide` carries over, warm starts and tells events as the one after the saved one.
  /// `invalid_argument` for anything that was not saved so, whoever made it, or of a scene that
  /// stands otherwise, and `out_of_memory`, leave `contacts` as they were. O(contacts).
  Status load_contacts(std::span<const std::byte> saved, Contacts& contacts) const;

  /// Groups of the pairs in contacts that this scene filled and whose bodies it still has
  /// (`invalid_key`). Fixed bodies join nothing; sleeping ones count as dynamic, since what touches
  /// them may wake them. The same on any number of threads. `out_of_memory` leaves `out` cleared.
  ///
  /// Islands: pairs that bodies connect, numbered in the order of their first pairs. About O(pairs
  /// + bodies).
  Status islands(const Contacts& contacts, ContactGroups& out) const;
  /// Colours: no two pairs of one group share a body, so that they can be solved side by side, but
  /// for those of kRestColour. Each pair, in their order, gets the first colour that neither body
  /// has, so that there are fewer than twice as many as one body has contacts, and at most
  /// kContactColours. O(pairs + bodies), on the thread that calls.
  Status colours(const Contacts& contacts, ContactGroups& out) const;

  /// The partition of a set; null while it has had no body, nor was reserved for one. Its client
  /// data are bodies' ids, its boxes are measured from `origin()`.
  [[nodiscard]] const Partition* partition(Motion motion) const noexcept;
  /// A point of the world from which boxes are measured, so that a scene far away, where floats are
  /// coarse, costs as much as one that stands here. (0, 0, 0) while that is fine enough; chosen
  /// anew by `refresh` where bodies have gone elsewhere. Nothing else is measured from it: poses,
  /// contacts and queries are in the world.
  [[nodiscard]] Vec3d origin() const noexcept;
  /// Draws the partitions of all sets.
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const noexcept;

  /// Bytes by part, to the byte what the resource gave.
  [[nodiscard]] SceneFootprint footprint() const noexcept;
  /// Of the last `collide`.
  [[nodiscard]] const SceneStatistics& statistics() const noexcept;

 private:
  friend class SceneQueries;
  friend class SceneSweep;
  friend class Sensors;
  friend class RankScene;
  friend class RecordedScene;
  friend struct ReplayState;

  /// Null where memory was refused.
  SceneState* state_;
};

/// What SceneQueries ask for who is in a layer: bodies whose layers that one meets.
///
///     const winnow::LayerFilter bullet{scene, kBullets};
///     queries.closest(ray, hit, bullet.filter());
struct LayerFilter {
  const Scene& scene;       ///< that is asked
  std::uint16_t layer = 0;  ///< that the one who asks is in
  Filter also{};            ///< what else a body has to pass

  /// It points to this, which has to outlive the question.
  [[nodiscard]] Filter filter() const noexcept {
    Filter both = also;
    both.predicate = {[](void* context, Key key, ClientData data) {
                        const auto& self = *static_cast<const LayerFilter*>(context);
                        const ObjectPredicate& other = self.also.predicate;
                        return self.scene.layers_meet(self.layer, self.scene.layer(key)) &&
                               (other.accept == nullptr || other.accept(other.context, key, data));
                      },
                      const_cast<LayerFilter*>(this)};
    return both;
  }
};

}  // namespace winnow
