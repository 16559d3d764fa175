#pragma once

// The main interface of the pipeline: bodies with shapes and poses, whose contacts `Scene::collide`
// writes to Contacts. Each set of bodies has a Partition (broad phase); pairs with composite shapes
// go through a CompositePool; NarrowPhase computes the contacts. The implementation is in scene/.

#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

class CompositePool;
class Recorder;
struct SceneState;

/// State of a body: the set of the scene that contains it. Dynamic bodies collide with all others.
/// Fixed and sleeping bodies collide only with dynamic ones, and are never tested against each
/// other.
enum class BodyState : std::uint8_t {
  fixed,     ///< never moves by itself: ground, walls
  dynamic,   ///< collides with every body
  sleeping,  ///< at rest; wakes by `Scene::set_body_state`
};
/// Number of enumerators of BodyState.
inline constexpr std::size_t kBodyStates = 3;

/// Options of a scene, fixed at construction.
struct SceneOptions {
  /// Source of every allocation. It must outlive the scene.
  std::pmr::memory_resource* memory = default_memory();
  /// How work is run in parallel; results do not depend on it.
  Execution execution = Execution::parallel();
  /// Structure of the partition of each set, indexed by BodyState. A partition is created when its
  /// first body is added, or by `reserve`. If fixed bodies are queried often, the slow build of
  /// static_bvh() may pay off.
  StructureKind structures[kBodyStates] = {linear_bvh(), linear_bvh(), linear_bvh()};
  /// Contact margin: pairs whose gap is at most this are contacts too (speculative contacts).
  /// Contact offsets of the two bodies (see ContactOffsets) are added to it. Finite, >= 0.
  double contact_margin = 0.0;
  NarrowTier tier = NarrowTier::robust;  ///< how exact contacts must be
  /// Tolerance of the contact cache. If the smaller body of a pair has moved relative to the other
  /// one by at most this length since the manifolds of the pair were computed (translation and
  /// rotation together, at the farthest point), the manifolds are kept and rotated with body a;
  /// `error_bound` grows by this length. Boxes in the partitions are enlarged by it, so that
  /// smaller motions need no update there. 0: off, and all results equal the results of a new
  /// scene, bit for bit. Finite, >= 0.
  double cache_tolerance = 0.0;
  /// At level manifold, for pairs with a mesh, a height field or a compound. False: the manifolds
  /// of all pairs of parts that touch are merged into one manifold per contact region, with at most
  /// kManifoldPoints points each (see mid::reduce_contacts), so that a loop over manifolds counts
  /// each contact once. Jolt does this by default. True: reports one manifold per pair of parts, as
  /// Bullet's algorithms for concave shapes find them; `collide` then takes less time, and a solver
  /// has more points. `bench/run micro --benchmark_filter=mesh/contacts` measures both.
  bool part_manifolds = false;
  /// Suppresses ghost contacts at the seams between fixed bodies with flush surfaces, so that
  /// bodies slide over them as over one floor. At levels distance and manifold, a contact of a
  /// dynamic body with a fixed body is dropped if all of these hold:
  ///
  /// - another fixed body supports the dynamic body in a plane, and the contact with it is at least
  ///   as deep;
  /// - all points of the dropped contact lie in that plane or below it;
  /// - the normals of the two contacts differ by 5 to 120 degrees;
  /// - the fixed body of the dropped contact (its touched parts, if it is composite) does not rise
  ///   above the plane there, except by 1/1000 of the dynamic body's radius and a slope of 5
  ///   degrees.
  ///
  /// Such a contact is with a side or an edge of a seam. Contacts with steps, kerbs, walls, slopes
  /// and ridges stay. Pairs with fixed bodies are not cached. The test runs on the calling thread
  /// in O(n log n) for n contacts with fixed bodies, plus O(1) for each pair of contacts of one
  /// body whose normals differ by that angle.
  bool suppress_ghost_contacts = false;
  /// Stores for each pair and each point its index in the previous frame (Contacts::previous_pair
  /// and previous_point), so that a solver can warm start. Takes 4 bytes per pair, 5 per point and
  /// 56 per body, and, unless `cache_tolerance` takes it too, a copy of the previous frame.
  bool warm_start = false;
  /// Build budget of each partition; see PartitionOptions.
  std::size_t build_budget = 0;
  /// Pool of meshes, height fields and compounds; null for a scene without composite shapes. It
  /// must outlive the scene.
  const CompositePool* composites = nullptr;
  /// Records all calls (pipeline/recording.h), with the shapes of bodies and the calls of the
  /// scene's SceneQueries, Sensors and ContinuousCollision. It must outlive the scene. Null records
  /// nothing.
  Recorder* recorder = nullptr;
};

/// Distances from its surface at which a body gets contacts and at which it rests. The offsets of
/// two bodies are added, as in PhysX: the pair is a contact if its gap is at most `a.contact +
/// b.contact` (plus the scene's contact margin), and the bodies rest at a gap of `a.rest + b.rest`.
/// Distances and depths are measured between the surfaces moved outward by `rest`; points lie
/// halfway between these surfaces. A fast body thus gets contacts early, thin cloth rests above the
/// ground, and bodies with a negative `rest` may sink into each other without a contact.
///
/// The offsets apply at levels distance and manifold. At level pairs, boxes are enlarged by
/// `contact`. Level boolean, queries and sensors ignore offsets and use the shapes.
struct ContactOffsets {
  double contact = 0.0;  ///< a length, finite, >= 0 and >= `rest`
  double rest = 0.0;     ///< a length, finite; negative moves the surface inward

  /// True if both lengths are equal.
  friend constexpr bool operator==(const ContactOffsets&, const ContactOffsets&) noexcept = default;
};

/// Number of layers; see Scene::set_layers_collide.
inline constexpr std::uint32_t kSceneLayers = 4096;

/// Layer of a query or sensor that considers bodies of all layers.
inline constexpr std::uint16_t kEveryLayer = 0xFFFF;

/// Which bodies a query of a scene considers, as if the query were a body. Filters are tested
/// during the search for bodies; layer, ignored body and predicate for each body whose box is
/// found. Ignored pairs and the pair predicate of the scene are rules for pairs of bodies; see
/// PairRules.
///
///     queries.closest(ray, {.layer = kBullets, .ignored = shooter});
struct SceneFilter {
  std::uint32_t layers = ~0U;  ///< layers that the query is in, one bit each; all by default
  std::uint32_t mask = ~0U;    ///< layers of bodies that it considers; 0 for none
  std::uint32_t environment = kAllEnvironments;  ///< bodies of other environments are skipped
  /// Layer, below kSceneLayers; bodies whose layer does not collide with it are skipped. See
  /// Scene::set_layers_collide.
  std::uint16_t layer = kEveryLayer;
  Key ignored{};                ///< a body that is skipped, such as the one that casts the ray
  ObjectPredicate predicate{};  ///< called last, for bodies that pass the rest of the filter

  /// Returns the layers, mask and environment as an ObjectFilter.
  [[nodiscard]] constexpr ObjectFilter object() const noexcept {
    return {layers, mask, environment};
  }
};

/// A body to be added to a scene.
struct BodyDefinition {
  ShapeId shape{};  ///< from the ShapePool, or from `SceneOptions::composites`
  /// Pose of the shape's frame in the world: finite, quaternion not zero.
  Pose pose{};
  BodyState state = BodyState::dynamic;  ///< the set that contains it
  ObjectFilter filter{};                 ///< which other bodies it may collide with
  ClientData data = 0;  ///< the caller's value, returned with contacts and hits; never read
  /// Contact offsets. The first body with nonzero offsets makes the scene store 16 bytes per body.
  ContactOffsets offsets{};
  /// Layer, below kSceneLayers; see Scene::set_layers_collide. The first body with a layer other
  /// than 0 makes the scene store 2 bytes per body.
  std::uint16_t layer = 0;
};

/// Numbers of objects to reserve memory for; see Scene::reserve. Each is at most 2^32 - 2; the sum
/// of `bodies` is below 2^28.
struct SceneCapacity {
  std::size_t bodies[kBodyStates] = {};  ///< indexed by BodyState
  /// Pairs of bodies found by the broad phase; see SceneStatistics::body_pairs.
  std::size_t pairs = 0;
  /// Level at which `collide` will be called.
  ContactLevel level = ContactLevel::manifold;
  /// Pairs stored in Contacts: pairs that touch, including sleeping pairs. At level pairs, all
  /// pairs.
  std::size_t touching = 0;
  /// Manifolds, from level boolean on. Without composite shapes, the same number as `touching`.
  std::size_t manifolds = 0;
  std::size_t points = 0;  ///< at level manifold
};

/// Bytes of a scene by part. The sum is exactly what is allocated from its resource.
struct WINNOW_API SceneFootprint {
  Bytes bodies;                   ///< shapes, poses, keys, filters, client data, the scene object
  Bytes partitions[kBodyStates];  ///< indexed by BodyState
  Bytes pairs;                    ///< pairs found by the broad phase
  Bytes mid_phase;                ///< pairs of primitives; 0 without composite shapes
  Bytes narrow_phase;             ///< results and scratch

  /// Returns the sum of all parts.
  [[nodiscard]] Bytes total() const noexcept;
};

/// Counters of the last `collide`. They contain no timings, so that values repeat exactly.
struct SceneStatistics {
  std::uint64_t boxes_updated = 0;  ///< boxes written to partitions since the previous `collide`
  std::uint64_t body_pairs = 0;     ///< pairs found by the broad phase
  /// Body pairs that were discarded because the bounding spheres of the bodies are apart. 0 at
  /// level pairs.
  std::uint64_t rejected_by_spheres = 0;
  std::uint64_t cached_pairs = 0;     ///< remaining body pairs that kept their cached contacts
  std::uint64_t primitive_pairs = 0;  ///< pairs of parts generated by the mid phase
  NarrowStatistics convex;            ///< narrow phase, for pairs of convex bodies
  NarrowStatistics parts;             ///< narrow phase, for pairs of parts
};

/// Bodies with shapes and poses, and the contacts between them: broad, mid and narrow phase in one
/// class.
///
///     winnow::ShapePool shapes;
///     winnow::Scene scene(shapes);
///     winnow::Key key = scene.add({.shape = ball, .pose = winnow::Pose::at(0, 0, 2)});
///     scene.collide(winnow::ContactLevel::manifold, contacts);
///
/// Parallel work runs in the task arena of the calling thread. Results and their order are the same
/// for any number of threads and any instruction set. A failed call (any Status but ok) changes
/// nothing. A scene is not thread-safe: calls must not overlap. To query from several threads see
/// SceneQueries.
class WINNOW_API Scene {
 public:
  /// Creates an empty scene. `shapes` must outlive the scene, and shapes must stay in the pool
  /// while bodies use them. With options out of range every `add` returns `invalid_argument`. If
  /// memory for the scene itself is refused, the scene stays empty and every call returns
  /// `out_of_memory`.
  explicit Scene(const ShapePool& shapes, const SceneOptions& options = {}) noexcept;
  explicit Scene(ShapePool&& shapes, const SceneOptions& options = {}) = delete;
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// Adds a body. `invalid_key` if neither pool contains the shape; `unsupported` for a composite
  /// shape in a scene without SceneOptions::composites; `invalid_pose`; `invalid_argument` for
  /// offsets or a layer out of range; `too_many_objects` from 2^28 on.
  Answer<Key> add(const BodyDefinition& body);
  /// Adds several bodies, all or none. `size_mismatch` if the numbers of keys and bodies differ.
  Status add(std::span<const BodyDefinition> bodies, std::span<Key> keys);
  /// Removes a body. `invalid_key` if the key is not of a live body.
  Status remove(Key key);
  /// Removes several bodies, all or none. `invalid_key` also if a key occurs twice.
  Status remove(std::span<const Key> keys);
  /// Removes all bodies. Their keys become stale; memory is kept.
  void clear() noexcept;

  /// Reserves memory. A frame allocates nothing if no number of bodies, pairs or contacts exceeds
  /// its previous maximum. After `reserve`, neither adding up to room.bodies bodies with convex
  /// shapes nor a first `collide` at this level, within the other numbers, allocates.
  /// `too_many_objects` and `out_of_memory` change nothing. O(room): the narrow phase processes
  /// room.pairs sample pairs, of the kinds of shapes that the pool contains; so add the shapes
  /// first.
  ///
  /// Not reserved, but allocated on first use: what partitions need in later frames to track moves,
  /// inserts and removals (see Partition::reserve); filters; what the mid and narrow phase need for
  /// parts of composite shapes; and pairs between two sets of more than about 10,000 bodies each on
  /// several threads.
  Status reserve(const SceneCapacity& room, Pages pages = Pages::untouched);
  /// Reserves memory in Contacts for `room`, for `collide` of this scene; everything that Contacts
  /// store is included. `too_many_objects` and `out_of_memory` change nothing. O(1), apart from
  /// touching pages and moving contents.
  Status reserve_contacts(Contacts& out, const SceneCapacity& room,
                          Pages pages = Pages::untouched) const;

  /// Sets the pose of a body. `invalid_key`, `invalid_pose`. O(1); the partitions are updated by
  /// the next `refresh` or `collide`.
  Status move(Key key, const Pose& pose);
  /// Sets the pose of each body, all or none: `size_mismatch`, `invalid_key`, `invalid_pose`. If a
  /// key occurs twice, its last pose is used. A view without orientations sets only positions.
  Status move(std::span<const Key> keys, const PoseView& poses);
  /// Moves a body to another set; a sleeping body that wakes becomes dynamic.
  Status set_body_state(Key key, BodyState state);
  /// Moves several bodies to a set, all or none. `invalid_key` also if a key occurs twice.
  Status set_body_state(std::span<const Key> keys, BodyState state);
  /// Replaces the shape of a body; its pose stays. `invalid_key` if the body or the shape does not
  /// exist; `unsupported` as for `add`.
  Status set_shape(Key key, ShapeId shape);
  /// Replaces the filter of a body. It takes effect with the next `collide` or query.
  Status set_filter(Key key, const ObjectFilter& filter);
  /// Replaces the contact offsets of a body. `invalid_argument` for offsets out of range. O(1),
  /// except for the first offsets of a scene.
  Status set_offsets(Key key, const ContactOffsets& offsets);

  /// Sets whether bodies of two layers collide; a may equal b, and their order does not matter.
  /// Layers extend the 32 layers of a filter: each body is in one layer, 0 by default, and at first
  /// all layers collide. Filters are tested during the search for pairs, at almost no cost; layers
  /// are tested for each pair found, by one lookup in a bit matrix. The matrix has a row and a
  /// column for each layer up to the highest one that was excluded from colliding.
  /// `invalid_argument` for a layer out of range. O(1), but the next `collide` finds all pairs
  /// again.
  Status set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide = true);
  /// True unless the two layers were excluded by `set_layers_collide`.
  [[nodiscard]] bool layers_collide(std::uint16_t a, std::uint16_t b) const noexcept;
  /// Moves a body to another layer; it takes effect with the next `collide` or query.
  /// `invalid_argument` for a layer out of range.
  Status set_layer(Key key, std::uint16_t layer);
  /// Returns the layer of a live body; 0 for any other key.
  [[nodiscard]] std::uint16_t layer(Key key) const noexcept;

  /// Excludes a pair of bodies from colliding, whatever their filters are, such as adjacent links
  /// of a robot or bones of a ragdoll. `ignored` = false ends the exclusion. The order of the two
  /// does not matter; excluding a pair twice has no further effect. Removing a body ends its
  /// exclusions. `invalid_argument` if a and b are the same body. O(pairs log pairs + all ignored
  /// pairs); no cost for a scene without ignored pairs.
  Status set_ignored(Key a, Key b, bool ignored = true);
  /// Excludes or includes several pairs, all or none.
  Status set_ignored(std::span<const KeyPair> pairs, bool ignored = true);
  /// True if the pair is ignored, in either order; false for stale keys.
  [[nodiscard]] bool is_ignored(Key a, Key b) const noexcept;
  /// Sets a predicate that is called for pairs of bodies (by the ids of their keys) whose boxes
  /// overlap, whose filters and layers let them collide, and that are not ignored. It is not called
  /// for every pair in every frame: if its results change, set it again. See ObjectPredicate for
  /// what it may do.
  void set_predicate(const PairPredicate& predicate) noexcept;

  /// Returns the number of live bodies in all sets.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the number of live bodies in one set.
  [[nodiscard]] std::size_t size(BodyState state) const noexcept;
  /// True if the key belongs to a live body of this scene. O(1).
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// Returns the current state of a body. `invalid_key` if there is no such body.
  Answer<BodyDefinition> body(Key key) const noexcept;
  /// Returns the key of a live body by its id; the null key for any other id.
  [[nodiscard]] Key key_of(ObjectId id) const noexcept;

  /// Updates boxes and partitions now instead of in the next `collide`.
  Status refresh();

  /// Finds all contacts at the given level of detail, and the changes since `contacts` was last
  /// filled. Pairs without a dynamic body are not tested. Contacts of two bodies that fell asleep
  /// are stored, but neither reported nor ended, until one of them wakes. `out_of_memory` leaves
  /// `contacts` empty.
  Status collide(ContactLevel level, Contacts& contacts);

  /// Appends a snapshot of the bodies: keys, shape ids, poses, states, filters, client data,
  /// ignored pairs, layers, the boxes in the partitions, and the options that affect results
  /// (contact_margin, tier, cache_tolerance and others). pipeline/FORMATS.md has the format. The
  /// shape pools and Contacts are saved separately. `out_of_memory` leaves `out` unchanged.
  /// O(bodies).
  Status save(Column<std::byte>& out) const;
  /// Replaces the bodies by a snapshot. Memory resource, execution, structures, predicate and pools
  /// of this scene stay; load the pools first. From then on contacts equal the contacts of the
  /// saved scene bit for bit, on any number of threads and any instruction set. Saved keys belong
  /// to the same bodies again, unless another scene or partition of this process uses them (compare
  /// with `key_of`). Contacts that were filled before count as contacts of another scene; see
  /// `load_contacts`. `invalid_argument` if the bytes are not a valid snapshot (untrusted bytes are
  /// safe) or use shapes that the pools do not contain; it and `out_of_memory` change nothing.
  /// O(bodies).
  Status load(std::span<const std::byte> saved);
  /// Appends a snapshot of Contacts that this scene filled last (`invalid_key` for others),
  /// including what they store between frames. `out_of_memory` leaves `out` unchanged. O(contacts).
  Status save_contacts(const Contacts& contacts, Column<std::byte>& out) const;
  /// Replaces `contacts` by a snapshot that was saved with the loaded state of this scene. The next
  /// `collide` keeps cached contacts, warm starts and reports events as the original scene would
  /// have. `invalid_argument` if the bytes are not a valid snapshot (untrusted bytes are safe) or
  /// belong to another state of the scene; it and `out_of_memory` leave `contacts` unchanged.
  /// O(contacts).
  Status load_contacts(std::span<const std::byte> saved, Contacts& contacts) const;

  /// Groups the pairs of contacts into islands: sets of pairs that are connected by bodies,
  /// numbered in the order of their first pairs. Fixed bodies connect nothing; sleeping bodies
  /// count as dynamic, because bodies that touch them may wake them. About O(pairs + bodies).
  /// `contacts` must have been filled by this scene, and their bodies must still exist
  /// (`invalid_key`). The result is the same for any number of threads. `out_of_memory` leaves
  /// `out` empty.
  Status islands(const Contacts& contacts, ContactGroups& out) const;
  /// Groups the pairs of contacts into colours: no two pairs of a colour share a dynamic or
  /// sleeping body, so that they can be solved in parallel. Only pairs of kRestColour may share
  /// such bodies. In order, each pair gets the first colour that neither of its bodies has. The
  /// number of colours is less than twice the largest number of contacts of a body, and at most
  /// kContactColours. Errors as for `islands`. O(pairs + bodies), on the calling thread.
  Status colours(const Contacts& contacts, ContactGroups& out) const;

  /// Returns the partition of a set; null if the set never had a body and was not reserved. Its
  /// client data are body ids; its boxes are relative to `origin()`.
  [[nodiscard]] const Partition* partition(BodyState state) const noexcept;
  /// Returns the point of the world that boxes are relative to. It keeps float boxes tight in a
  /// scene far from (0, 0, 0), where floats are coarse. The origin is (0, 0, 0) while floats are
  /// precise enough there; `refresh` chooses it again after the bodies have moved far away. Poses,
  /// contacts and queries are always in world coordinates.
  [[nodiscard]] Vec3d origin() const noexcept;
  /// Draws the partitions of all sets.
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const noexcept;

  /// Returns the bytes by part: exactly what is allocated from the memory resource.
  [[nodiscard]] SceneFootprint footprint() const noexcept;
  /// Returns the counters of the last `collide`.
  [[nodiscard]] const SceneStatistics& statistics() const noexcept;

 private:
  friend class SceneQueries;
  friend class ContinuousCollision;
  friend class Sensors;
  friend class RankScene;
  friend struct ReplayState;

  /// Null if memory was refused.
  SceneState* state_;
};

}  // namespace winnow
