#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/box_view.h>
#include <winnow/core/cast.h>
#include <winnow/core/column.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/entries.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/hits.h>
#include <winnow/core/kdop.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/margin.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/region.h>
#include <winnow/core/sphere.h>
#include <winnow/core/status.h>
#include <winnow/core/volume.h>
#include <winnow/partitions/scene_features.h>
#include <winnow/partitions/structures.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <string_view>
#include <utility>

namespace winnow {

/// What every partition is made with.
struct PartitionOptions {
  /// Every allocation comes from here. It must outlive the partition. Where a parallel partition
  /// runs, only the calling thread allocates.
  std::pmr::memory_resource* memory = default_memory();
  /// On whose threads builds, refits and queries run; results are the same on all.
  Execution execution = Execution::parallel();
  /// What bounds an object. Every partition prunes by boxes; of spheres and k-DOPs it drops the
  /// pairs whose boxes overlap though they themselves do not.
  Volume volume = Volume::aabb;
  /// Makes what rests or moves little cost nothing; every query sees the larger volumes.
  Margin margin{};
  /// A build that can be seen coming, because objects near the edges of their cells or queries cost
  /// ever more, is planned over the refreshes before it, and so is the exchange of a structure by
  /// the automatic choice. This is how many rows' worth of that work a refresh does: a build takes
  /// two to five of each row. 0: as much as it takes for a plan to be done within two fifths of the
  /// refreshes that the last order was good for. The largest number: builds are done at once when
  /// they are due. Counts, never time: results are the same on every machine.
  std::size_t build_budget = 0;
};

/// The order in which a query writes its results. Both are the same on any thread count and any
/// instruction set.
enum class Order : std::uint8_t {
  fast,       ///< as they were found; depends on the partition and on what happened before
  canonical,  ///< sorted by (first, second): every exact partition gives identical bytes
};

/// How pairs are asked for.
struct PairOptions {
  Order order = Order::fast;  ///< in which order they are written
  /// Update the caller's buffer by what moved since it was last filled, where that is cheaper.
  /// False asks for every pair anew.
  bool incremental = true;
  /// Asked about every pair that the objects' own filters let pass. An incremental query keeps what
  /// it answered about pairs that did not move.
  PairPredicate predicate{};
};

/// How a partition stands and what it did; counters, never timings, so they repeat exactly.
struct Statistics {
  std::size_t objects = 0;    ///< live ones
  std::size_t regular = 0;    ///< objects in the cells, strips or leaves made by the last build
  std::size_t irregular = 0;  ///< objects kept apart: oversize, new, or moved away
  std::size_t cells = 0;      ///< cells, strips or leaf blocks
  std::size_t depth = 0;      ///< levels of the node tree; 0 if there is none
  std::size_t levels = 0;     ///< of sizes: grids laid over each other, or depths of an octree
  std::uint64_t builds = 0;   ///< since construction
  std::uint64_t planned_builds = 0;       ///< of these, how many were planned before they were due
  std::uint64_t refits = 0;               ///< refreshes that did not need a build
  std::uint64_t full_queries = 0;         ///< pair queries that asked about every object
  std::uint64_t incremental_queries = 0;  ///< pair queries that redid only the pairs of what moved
  std::uint64_t last_tests = 0;           ///< tests of 16 volumes at once, in the last pair query
  std::uint64_t last_pairs = 0;           ///< pairs reported by the last pair query
};

class PartitionState;
struct VolumeInput;

/// What the automatic choice holds, and why.
struct StructureChoice {
  StructureKind structure;    ///< that prunes the objects now
  std::string_view reason;    ///< in a few words
  std::uint64_t changes = 0;  ///< of the structure, after the first choice
  SceneFeatures features;     ///< what is known of the scene
};

/// Takes bounding volumes with 64 bits of client data, hands out keys, and answers which of them
/// may touch. It never misses a pair; `is_exact` says whether it reports pairs whose boxes do not
/// touch. What differs between partitions is the structure that prunes: it can be exchanged while
/// the objects stay, with their keys, filters, tracked pairs and events.
///
///     winnow::Partition partition(winnow::linear_bvh());
///     partition.insert(boxes, data, keys);
///     partition.self_pairs(pairs);
///
/// Boxes are of floats, which are coarse far from 0: in a world far away measure them, and whatever
/// is asked with, from a point among the objects (`Aabb::outward` with an origin). A Scene, which
/// has doubles, does so by itself.
///
/// Mutation costs O(1) per object; the structure follows at the next query (or `refresh`). Queries
/// that are const may run at the same time from several threads; everything else wants the
/// partition to itself. A refused call (any Status but ok) changed nothing: of a span, either all
/// entries are taken or none. Nothing throws.
class WINNOW_API Partition final {
 public:
  /// An empty partition of boxes, with the options that there are by default. It takes memory for
  /// its state at once; see `status`.
  explicit Partition(StructureKind structure) noexcept;
  /// The same with other options. Links what all volumes and margins need.
  Partition(StructureKind structure, const PartitionOptions& options) noexcept;
  /// Takes over the objects; `other` answers every call with `invalid_argument` from then on.
  Partition(Partition&& other) noexcept
      : state_(std::exchange(other.state_, nullptr)),
        status_(std::exchange(other.status_, Status::invalid_argument)) {}
  /// Exchanges the two partitions, objects, keys and all.
  Partition& operator=(Partition&& other) noexcept {
    std::swap(state_, other.state_);
    std::swap(status_, other.status_);
    return *this;
  }
  ~Partition();

  /// `ok`, or what every call that has a status answers: `out_of_memory` if memory for its state
  /// was refused, `invalid_argument` if the structure or the options' volume names none, or if it
  /// has been moved from.
  [[nodiscard]] Status status() const noexcept { return status_; }

  /// What it was made with, or given last.
  [[nodiscard]] StructureKind structure() const noexcept;
  /// That structure's name, e.g. "LinearBvh".
  [[nodiscard]] std::string_view name() const noexcept { return structure().name(); }
  /// Exchanges the structure; the next refresh builds it. `automatic()` starts choosing anew.
  Status set_structure(StructureKind structure);
  /// What `automatic()` has chosen; of any other structure that one itself.
  [[nodiscard]] StructureChoice choice() const noexcept;

  /// True if `self_pairs` reports exactly the pairs whose given boxes overlap: where the structure
  /// tests bounds, and these are boxes without a margin.
  [[nodiscard]] bool is_exact() const noexcept;
  /// What objects are bounded by: that of the options it was made with.
  [[nodiscard]] Volume volume() const noexcept;
  /// By how much stored boxes are larger than given ones: that of the options it was made with.
  [[nodiscard]] Margin margin() const noexcept;

  /// Adds one object per box. `keys` receives a key for each; `data` may be empty (all zero).
  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  /// Adds one object.
  Status insert(const Aabb& box, ClientData data, Key& key);
  /// Gives each object a new box. If a key occurs twice its last box counts. With a margin, a box
  /// within the stored one leaves that as it is, unless it is larger by more than twice the margin;
  /// the object then counts as not moved.
  Status update(std::span<const Key> keys, const BoxView& boxes);
  /// The same for one object.
  Status update(Key key, const Aabb& box);
  /// The same for some entries of keys and boxes alone, of which a caller keeps all: those that a
  /// list names, or of which a mask has the bits set, need not be copied together. A number that is
  /// none of an entry is an `invalid_argument`, a mask of another length a `size_mismatch`.
  Status update(std::span<const Key> keys, const BoxView& boxes, const Entries& entries);

  /// Spheres, where `volume()` is Volume::sphere; else `unsupported_volume`. Given boxes, a
  /// partition of spheres or k-DOPs stores the tightest volume around each (a sphere wants finite
  /// boxes). Spheres that miss each other by less than 1e-6 of their distance may be reported, and
  /// any that are smaller than some 1e-18 or larger than 1e18.
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  /// The same for spheres. Values that are not finite or a negative radius are `invalid_bounds`.
  Status update(std::span<const Key> keys, std::span<const Sphere> spheres);
  /// k-DOPs, where `volume()` is that of the same K (14, 18 or 26); else `unsupported_volume`.
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  template <int K>
  /// The same for k-DOPs.
  Status update(std::span<const Key> keys, std::span<const Kdop<K>> kdops);

  /// Removes the objects. A key that occurs twice makes the whole call `invalid_key`.
  Status remove(std::span<const Key> keys);
  /// Removes one object; `invalid_key` if there is none of this key.
  Status remove(Key key);
  /// Removes every object. Memory is kept; `release_memory` gives it back.
  void clear() noexcept;
  /// Gives back all memory that an empty partition, or scratch, holds.
  void release_memory() noexcept;
  /// Makes ready all that the first frame of up to `objects` objects needs, wherever these lie: to
  /// insert them, to `refresh`, and to ask for all pairs asks the memory resource for nothing then
  /// (for the array of pairs itself see `reserve_pairs`). Cells and nodes are reserved for as many
  /// as the structure may make of so many objects, which is more than most scenes have; for
  /// `automatic()` each of those that it may choose gets its own. Filters are not counted in. What
  /// was reserved stays until `release_memory`. `too_many_objects` or `out_of_memory` change
  /// nothing. O(objects) if pages are touched, else O(size()).
  Status reserve(std::size_t objects, Pages pages = Pages::untouched);
  /// Makes room in a buffer for up to `pairs` pairs of `self_pairs`, as long as there are no more
  /// objects than was reserved for: on several threads twice that, since they write side by side
  /// first. `out_of_memory` changes nothing.
  Status reserve_pairs(PairBuffer& out, std::size_t pairs, Pages pages = Pages::untouched) const;
  /// Makes room for what events tell of up to so many pairs, as long as there are no more objects
  /// than was reserved for, and with `alone`, for `self_pairs(events)`, for those pairs themselves.
  /// `out_of_memory` changes nothing that is told.
  Status reserve_events(PairEvents& out, std::size_t pairs, bool alone = false,
                        Pages pages = Pages::untouched) const;

  /// Live objects.
  [[nodiscard]] std::size_t size() const noexcept;
  /// True for keys of live objects of this partition. O(1).
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// The box as it is tested: float, larger than given by the margin, the box around other volumes;
  /// an infinite extent is given back as infinite.
  Status bounds(Key key, Aabb& box) const noexcept;
  /// The same of many objects, one box for each key. `size_mismatch` and `invalid_key` leave all
  /// boxes alone. O(keys).
  Status bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;
  /// What the object was inserted with; `invalid_key` leaves `data` alone.
  Status client_data(Key key, ClientData& data) const noexcept;
  /// Key of a live object; the null key for any other id.
  [[nodiscard]] Key key_of(ObjectId id) const noexcept;
  /// Client data of a live object; 0 for any other id.
  [[nodiscard]] ClientData client_data_of(ObjectId id) const noexcept;

  /// Sets what the objects let themselves be paired with. Every object starts with ObjectFilter{};
  /// a partition in which no other was ever set stores none.
  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  /// The same for one object.
  Status set_filter(Key key, const ObjectFilter& filter);
  /// What was set last, or ObjectFilter{}; `invalid_key` leaves `filter` alone.
  Status filter(Key key, ObjectFilter& filter) const noexcept;

  /// Brings the structure up to date now rather than in the next query. A tree that is made here,
  /// or for a ray or a region, at first, is cut with more care than one that is made for pairs.
  Status refresh() const;

  /// All pairs of objects whose volumes overlap, each once, first < second. `out_of_memory` leaves
  /// `out` empty.
  Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const;
  /// All pairs (object of this, object of other) whose boxes overlap, each once.
  Status pairs_with(const Partition& other, PairBuffer& out, const PairOptions& options = {}) const;

  /// The same, and what changed since the frame that `out` holds. The cost follows what moved.
  /// `out_of_memory` reports no change and leaves that frame in `out`.
  Status self_pairs(PairBuffer& out, PairEvents& events, const PairOptions& options = {}) const;
  /// What changed alone. Where little moves it costs what moved and how many pairs that has; the
  /// order is of no effect.
  Status self_pairs(PairEvents& events, const PairOptions& options = {}) const;

  // Casts: rays and swept volumes against the objects' boxes (of spheres and k-DOPs: the box around
  // them). A start inside a box, or touching it, is a hit at min_t. Never a miss; a false hit only
  // where the gap is below 1e-14 of the coordinates' size (1e-6 for capsules). Equal t are ordered
  // by id.

  /// The hit with the least t; a null hit if there is none. About O(log n).
  Status closest(const Cast& cast, Hit& hit, const Filter& filter = {}) const;
  /// Any one hit, whichever is found first; a null hit if there is none.
  Status any(const Cast& cast, Hit& hit, const Filter& filter = {}) const;
  /// All hits, sorted by t.
  Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const;
  /// The same for many rays at once, which share the work where they are alike. One bad ray makes
  /// the whole batch `invalid_argument`.
  Status closest(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  /// Any one hit of each ray, the same on any number of threads; the same bad rays are refused.
  Status any(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  /// All hits of each ray, sorted by t: `hits.of(i)` are those of ray i.
  Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const;

  /// Every object whose box meets the region, those that lie wholly inside told from those that
  /// cross its border. A frustum or set of planes "meets" a box that is not wholly outside of one
  /// of its planes (or of the frustum's own box). Never a miss; a false hit only within rounding.
  /// Order::canonical sorts each of the two groups by id.
  Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                 Order order = Order::fast) const;
  /// All pairs (index of the box, object) that overlap. Boxes may reach to infinity.
  Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                 Order order = Order::fast) const;

  /// The `count` objects whose boxes are nearest to a finite box (a point is one of no extent)
  /// within a distance of `radius`, which may be infinite; sorted by distance, then by id. Those
  /// that touch are at distance 0. About O(log n + count).
  Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                 const Filter& filter = {}) const;

  /// Appends all that the objects are to bytes: keys and which come next, stored volumes, client
  /// data, filters, and which structure with what options; pipeline/CONTRACT.md has the format.
  /// `out_of_memory` leaves `out` as it was. O(objects).
  Status save(Column<std::byte>& out) const;
  /// Becomes what was saved, with the memory and execution that it has. Keys that were saved are
  /// those of the same objects again, unless another partition of this process has them by now;
  /// `key_of` tells. The structure is built by the next question; what is asked from then on is
  /// answered, to the order of pairs, as by every other partition that loaded the same bytes: to go
  /// on bit for bit with it, who saved loads, too. Buffers of pairs start anew. `invalid_argument`
  /// for anything that was not saved so, whoever made it, and `out_of_memory`, change nothing.
  /// Links all structures. O(objects).
  Status load(std::span<const std::byte> saved);

  /// Draws the objects and the partition's own structure. A picture, not a query: O(n).
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const noexcept;

  /// Every byte that the memory resource was asked for and has not got back.
  [[nodiscard]] Footprint footprint() const noexcept;
  /// Counters as they stand.
  [[nodiscard]] Statistics statistics() const noexcept;

 private:
  friend Partition make_box_partition(StructureKind structure,
                                      const PartitionOptions& options) noexcept;
  Partition(StructureKind structure, const PartitionOptions& options,
            const VolumeInput* input) noexcept;

  PartitionState* state_ = nullptr;
  Status status_ = Status::invalid_argument;
};

}  // namespace winnow
