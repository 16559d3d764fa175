#pragma once

// The public interface of a spatial partition. Results go to a PairBuffer, PairEvents, HitBuffer or
// OverlapBuffer of the caller (core/).

#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/structures.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <string_view>
#include <utility>

namespace winnow {

class PartitionRecorder;

/// Options of a partition, fixed at construction.
struct PartitionOptions {
  /// Source of every allocation. It must outlive the partition. With parallel execution, only the
  /// calling thread allocates.
  std::pmr::memory_resource* memory = default_memory();
  /// How builds, refits and queries are run in parallel; results do not depend on it.
  Execution execution = Execution::parallel();
  /// Bounding volume of the objects. Every partition prunes by boxes. With spheres and k-DOPs it
  /// also drops pairs whose boxes overlap but whose volumes do not.
  Volume volume = Volume::aabb;
  /// Stores volumes enlarged by this fat margin (fat AABBs), so that small motions need no update
  /// of the structure. Every query tests the enlarged volumes.
  FatMargin fat_margin{};
  /// Number of rows that one refresh may process for a planned rebuild. A rebuild is planned if it
  /// is foreseeable: objects are about to leave their cells, or queries become steadily slower. The
  /// work is then spread over the refreshes before the rebuild is due; a change of structure by
  /// `automatic()` is spread, too. A build processes each row two to five times. If the budget is
  /// 0, the partition chooses the number so that planning takes two fifths of the number of
  /// refreshes since the last build. If it is the largest value of the type, nothing is planned: a
  /// build runs at once when it is due. The budget counts rows, never time, so that results are the
  /// same on every machine.
  std::size_t build_budget = 0;
  /// Records all calls: a Recorder (pipeline/recording.h), which must outlive the partition. Null
  /// records nothing.
  PartitionRecorder* recorder = nullptr;
};

/// Order in which a query writes its results. Both orders are the same for any number of threads
/// and any instruction set.
enum class Order : std::uint8_t {
  fast,       ///< order in which results are found; depends on the structure and on earlier calls
  canonical,  ///< sorted by (first, second): every exact partition writes identical bytes
};

/// Options of a pair query.
struct PairOptions {
  Order order = Order::fast;  ///< order of the written pairs
  /// If true, and if this is cheaper, a query keeps the pairs in the buffer, and finds again only
  /// the pairs of objects that moved since. If false, a query finds all pairs again.
  bool incremental = true;
  /// Called for every pair that the objects' filters let pass. An incremental query does not call
  /// it again for pairs of objects that did not move.
  PairPredicate predicate{};
};

/// State of a partition and counters of its work. It contains no times, so that values repeat
/// exactly.
struct Statistics {
  std::size_t objects = 0;           ///< live objects
  std::size_t regular = 0;           ///< objects in the cells, strips or leaves of the last build
  std::size_t irregular = 0;         ///< objects apart from these: too large, new, or moved away
  std::size_t cells = 0;             ///< cells, strips or leaf blocks
  std::size_t depth = 0;             ///< levels of the node tree; 0 if there is none
  std::size_t levels = 0;            ///< grids of a hierarchical grid, depths of an octree
  std::uint64_t builds = 0;          ///< builds since construction
  std::uint64_t planned_builds = 0;  ///< builds that were planned before they were due
  std::uint64_t refits = 0;          ///< refreshes that did not need a build
  std::uint64_t full_queries = 0;    ///< pair queries that tested every object
  std::uint64_t incremental_queries = 0;  ///< pair queries that tested only objects that moved
  std::uint64_t last_tests = 0;           ///< tests of 16 volumes at once, in the last pair query
  std::uint64_t last_pairs = 0;           ///< pairs that the last pair query returned
};

class PartitionObserver;
class PartitionState;
struct VolumeInput;

/// Records calls of partitions. Recorder (pipeline/recording.h) is the class to use; a program
/// without a Recorder links no code for recordings.
class WINNOW_API PartitionRecorder {
 protected:
  ~PartitionRecorder() = default;

 private:
  friend class Partition;
  /// Returns the observer of a new partition; null if its calls cannot be recorded.
  [[nodiscard]] virtual PartitionObserver* observe_partition(
      StructureKind structure, const PartitionOptions& options) noexcept = 0;
};

/// A set of bounding volumes, each with 64 bits of client data and a key, that finds the pairs that
/// may touch. It never misses a pair; `is_exact` is false if it may also report pairs whose boxes
/// do not touch. Partitions differ in the structure that prunes. The structure can be exchanged at
/// any time; objects, keys, filters, tracked pairs and events stay.
///
///     winnow::Partition partition(winnow::linear_bvh());
///     partition.insert(boxes, data, keys);
///     partition.self_pairs(pairs);
///
/// Boxes have float coordinates, which are coarse far from 0. In a world far from the origin, give
/// boxes and query shapes relative to a point among the objects (`Aabb::outward` with an origin). A
/// Scene has double coordinates and does this itself.
///
/// Insert, update and remove cost O(1) per object; the structure is brought up to date by the next
/// query or by `refresh`. Const queries may run concurrently on several threads; any other call
/// needs exclusive access. A call that returns any Status but ok has changed nothing: either all
/// entries of a span are taken or none. No call throws.
class WINNOW_API Partition final {
 public:
  /// Makes an empty partition of boxes with default options. Allocates its state at once; see
  /// `status`.
  explicit Partition(StructureKind structure) noexcept;
  /// As above, with options. Links the code of all volumes and margins.
  Partition(StructureKind structure, const PartitionOptions& options) noexcept;
  /// Moves the objects here; afterwards every call on `other` returns `invalid_argument`.
  Partition(Partition&& other) noexcept
      : state_(std::exchange(other.state_, nullptr)),
        status_(std::exchange(other.status_, Status::invalid_argument)) {}
  /// Swaps the two partitions, including objects and keys.
  Partition& operator=(Partition&& other) noexcept {
    std::swap(state_, other.state_);
    std::swap(status_, other.status_);
    return *this;
  }
  ~Partition();

  /// Returns `ok`, or the status that every call returns: `out_of_memory` if memory for the state
  /// was refused; `invalid_argument` if the structure or the volume of the options is not a valid
  /// one, or if the partition has been moved from.
  [[nodiscard]] Status status() const noexcept { return status_; }

  /// Returns the structure given at construction or by `set_structure`.
  [[nodiscard]] StructureKind structure() const noexcept;
  /// Returns the name of that structure, e.g. "LinearBvh".
  [[nodiscard]] std::string_view name() const noexcept { return structure().name(); }
  /// Exchanges the structure; the next refresh builds the new one. `automatic()` starts its choice
  /// anew. `invalid_argument` for a kind without a structure.
  Status set_structure(StructureKind structure);
  /// Returns the structure that `automatic()` has chosen, and the reason. With any other structure,
  /// returns the structure of the partition.
  [[nodiscard]] StructureChoice choice() const noexcept;

  /// True if `self_pairs` reports exactly the pairs whose given boxes overlap: the structure tests
  /// volumes, and the volumes are boxes without a margin.
  [[nodiscard]] bool is_exact() const noexcept;
  /// Returns the bounding volume of the options.
  [[nodiscard]] Volume volume() const noexcept;
  /// Returns the fat margin of the options.
  [[nodiscard]] FatMargin fat_margin() const noexcept;

  /// Adds one object per box and writes its key to `keys`. `data` may be empty: client data are 0
  /// then. `size_mismatch` if the lengths differ, `invalid_bounds` for a box with NaN, min > max or
  /// wholly at infinity.
  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  /// Adds one object and returns its key.
  Answer<Key> insert(const Aabb& box, ClientData data = 0);
  /// Gives each object a new box. If a key occurs twice, its last box counts. `size_mismatch`,
  /// `invalid_key` and `invalid_bounds` change nothing. With a margin, the stored box stays and the
  /// object does not count as moved if the stored box contains the new box and is at most four
  /// margins longer on each axis (two per side).
  Status update(std::span<const Key> keys, const BoxView& boxes);
  /// Gives one object a new box.
  Status update(Key key, const Aabb& box);
  /// Gives new boxes only to the listed or masked entries of `keys` and `boxes`, so that a caller
  /// that has arrays of all its objects need not copy the entries together. `invalid_argument` for
  /// an index out of range, `size_mismatch` for a mask of another length.
  Status update(std::span<const Key> keys, const BoxView& boxes, const IndexSubset& entries);

  /// Adds one object per sphere. `unsupported_volume` unless `volume()` is Volume::sphere. A
  /// partition of spheres or k-DOPs that is given boxes stores the tightest volume around each box,
  /// up to rounding; for spheres the boxes must be finite. Two spheres that do not touch may be
  /// reported as a pair if their gap is below 1e-6 of their distance. They may also be reported if
  /// one of them is smaller than about 1e-18 or larger than about 1e18.
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  /// Gives each object a new sphere. `invalid_bounds` for values that are not finite or a negative
  /// radius.
  Status update(std::span<const Key> keys, std::span<const Sphere> spheres);
  /// Adds one object per k-DOP. `unsupported_volume` unless `volume()` is the one with this K (14,
  /// 18 or 26).
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  /// Gives each object a new k-DOP.
  template <int K>
  Status update(std::span<const Key> keys, std::span<const Kdop<K>> kdops);

  /// Removes the objects. `invalid_key` if a key occurs twice.
  Status remove(std::span<const Key> keys);
  /// Removes one object. `invalid_key` if no live object has this key.
  Status remove(Key key);
  /// Removes all objects. Memory is kept; `release_memory` frees it.
  void clear() noexcept;
  /// Frees scratch memory, and all memory of an empty partition.
  void release_memory() noexcept;
  /// Reserves all memory that the first frame of up to `objects` objects needs, at any positions:
  /// inserting them, `refresh` and a query for all pairs then allocate nothing (for the array of
  /// pairs see `reserve_pairs`). Reserves the largest number of cells and nodes that the structure
  /// may make of them, which is more than most scenes need; `automatic()` reserves for each
  /// structure that it may choose. Filters are not included. The memory stays until
  /// `release_memory`. `too_many_objects` and `out_of_memory` change nothing. O(objects) if pages
  /// are touched, else O(size()).
  Status reserve(std::size_t objects, Pages pages = Pages::untouched);
  /// Reserves memory in a buffer for up to `pairs` pairs of `self_pairs`, for the number of objects
  /// that `reserve` was called with. With several threads it takes twice the memory, because
  /// threads write to pages of their own first. `out_of_memory` changes nothing.
  Status reserve_pairs(PairBuffer& out, std::size_t pairs, Pages pages = Pages::untouched) const;
  /// Reserves memory for the events of up to `pairs` pairs, for the number of objects that
  /// `reserve` was called with. With `with_pairs`, for `self_pairs(events)`, also reserves memory
  /// for the pairs themselves. `out_of_memory` leaves the reported events unchanged.
  Status reserve_events(PairEvents& out, std::size_t pairs, bool with_pairs = false,
                        Pages pages = Pages::untouched) const;

  /// Returns the number of live objects.
  [[nodiscard]] std::size_t size() const noexcept;
  /// True if the key belongs to a live object of this partition. O(1).
  [[nodiscard]] bool contains(Key key) const noexcept;
  /// Returns the box that queries test: float, enlarged by the margin; for other volumes the box
  /// around them. An infinite extent is returned as infinite.
  Answer<Aabb> bounds(Key key) const noexcept;
  /// As above, one box per key. `size_mismatch` and `invalid_key` write nothing. O(keys).
  Status bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;
  /// Returns the client data of an object; 0 for a key of no live object.
  [[nodiscard]] ClientData client_data(Key key) const noexcept;
  /// Returns the key of a live object; the null key for any other id.
  [[nodiscard]] Key key_of(ObjectId id) const noexcept;
  /// Returns the client data of a live object; 0 for any other id.
  [[nodiscard]] ClientData client_data_of(ObjectId id) const noexcept;

  /// Sets the filters that restrict which objects pair. Every object starts with ObjectFilter{}; a
  /// partition stores no filters until another one is set.
  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  /// Sets the filter of one object.
  Status set_filter(Key key, const ObjectFilter& filter);
  /// Returns the filter of an object.
  Answer<ObjectFilter> filter(Key key) const noexcept;

  /// Brings the structure up to date now instead of in the next query. If the first build is made
  /// here or by a cast, region or nearest query, its tree is split with more care than for a pair
  /// query.
  Status refresh() const;

  /// Writes all pairs of objects whose volumes overlap, each once, first < second. `out_of_memory`
  /// leaves `out` empty.
  Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const;
  /// Writes all pairs (object of this, object of other) whose boxes overlap, each once.
  /// `out_of_memory` leaves `out` empty.
  Status pairs_with(const Partition& other, PairBuffer& out, const PairOptions& options = {}) const;

  /// Writes all pairs like `self_pairs(out)`, and reports the pairs that began and ended since the
  /// frame whose pairs `out` contains. The cost grows with the number of moved objects.
  /// `out_of_memory` reports no change and leaves the pairs of that frame in `out`, in any order;
  /// if the events do not describe that frame, `out` becomes empty.
  Status self_pairs(PairBuffer& out, PairEvents& events, const PairOptions& options = {}) const;
  /// Reports only the pairs that began and ended. If few objects move, O(moved objects and their
  /// pairs). `options.order` is ignored.
  Status self_pairs(PairEvents& events, const PairOptions& options = {}) const;

  // Casts: rays and swept volumes against the objects' boxes (for spheres and k-DOPs, the boxes
  // around them). A cast that starts inside a box, or touching it, hits it at min_t. No hit is
  // missed; a false hit is possible only if the gap is below 1e-14 of the coordinates (1e-6 for
  // capsules). Hits of equal t are ordered by id. `invalid_argument` for an invalid cast.

  /// Finds the hit of least t; a null hit if there is none. About O(log n).
  Answer<Hit> closest(const Cast& cast, const Filter& filter = {}) const;
  /// Finds any one hit; a null hit if there is none.
  Answer<Hit> any(const Cast& cast, const Filter& filter = {}) const;
  /// Finds all hits, sorted by t.
  Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const;
  /// Finds the hit of least t of each ray. Rays of similar direction share work. One invalid ray
  /// makes any call with a batch return `invalid_argument`.
  Status closest(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  /// Finds any one hit of each ray, the same hit for any number of threads.
  Status any(const RayBatch& rays, const HitColumns& hits, const Filter& filter = {}) const;
  /// Finds all hits of each ray, sorted by t: `hits.of(i)` are the hits of ray i.
  Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const;

  /// Finds every object whose box overlaps the region, and separates boxes inside the region from
  /// boxes that cross its border. A box overlaps a frustum or a set of planes if it is not wholly
  /// outside one of the planes (or the box of the frustum). No object is missed; an object that is
  /// found although it does not overlap is within rounding of the region. Order::canonical sorts
  /// each of the two groups by id.
  Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                 Order order = Order::fast) const;
  /// Finds all overlapping pairs (index of the box, object). Boxes may be infinite.
  Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                 Order order = Order::fast) const;

  /// Finds the `count` objects whose boxes are nearest to a finite box (or a point: min == max)
  /// within distance `radius`, which may be infinite; sorted by distance, then by id. Boxes that
  /// touch have distance 0. `invalid_argument` for a box that is not finite, or a radius that is
  /// negative or NaN. About O(log n + count).
  Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                 const Filter& filter = {}) const;

  /// Appends a snapshot of the objects: keys and the order in which new ones are given out, stored
  /// volumes, client data, filters, the structure and its options. pipeline/FORMATS.md has the
  /// format. `out_of_memory` leaves `out` unchanged. O(objects).
  Status save(Column<std::byte>& out) const;
  /// Replaces the objects by a snapshot; memory resource and execution stay. Saved keys belong to
  /// the same objects again, unless another partition of this process uses them (compare with
  /// `key_of`). The next query builds the structure. From then on results, including the order of
  /// pairs, equal the results of every other partition that loaded the same bytes. They need not
  /// equal the results of the partition that saved: to stay equal bit for bit, load the bytes there
  /// too. The next query for pairs is a full one for any buffer. `invalid_argument` if the bytes
  /// are not a valid snapshot (untrusted bytes are safe); `invalid_argument` and `out_of_memory`
  /// change nothing. Links all structures. O(objects).
  Status load(std::span<const std::byte> saved);

  /// Draws the objects and the cells or nodes of the structure. O(n).
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const noexcept;

  /// Returns all bytes that are allocated from the memory resource, by purpose.
  [[nodiscard]] Footprint footprint() const noexcept;
  /// Returns the current counters.
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
