#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/box_view.h>
#include <winnow/core/cast.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/hits.h>
#include <winnow/core/key.h>
#include <winnow/core/margin.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/region.h>
#include <winnow/core/status.h>
#include <winnow/core/volume.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <span>
#include <string_view>

namespace winnow {

/// What every partition is made with.
struct PartitionOptions {
  /// Every allocation comes from here. It must outlive the partition. Where a parallel partition
  /// runs, only the calling thread allocates.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  Execution execution = Execution::parallel();
  /// What bounds an object. Every partition prunes by boxes; of spheres and k-DOPs it drops the
  /// pairs whose boxes overlap though they themselves do not.
  Volume volume = Volume::aabb;
  /// Makes what rests or moves little cost nothing; every query sees the larger volumes.
  Margin margin{};
};

/// The order in which a query writes its results. Both are the same on any thread count and any
/// instruction set.
enum class Order : std::uint8_t {
  fast,       ///< as they were found; depends on the partition and on what happened before
  canonical,  ///< sorted by (first, second): every exact partition gives identical bytes
};

struct PairOptions {
  Order order = Order::fast;
  /// Update the caller's buffer by what moved since it was last filled, where that is cheaper.
  /// False asks for every pair anew.
  bool incremental = true;
  /// Asked about every pair that the objects' own filters let pass. An incremental query keeps what
  /// it answered about pairs that did not move.
  PairPredicate predicate{};
};

/// How a partition stands and what it did; counters, never timings, so they repeat exactly.
struct Statistics {
  std::size_t objects = 0;
  std::size_t regular = 0;    ///< objects in the cells, strips or leaves made by the last build
  std::size_t irregular = 0;  ///< objects kept apart: oversize, new, or moved away
  std::size_t cells = 0;      ///< cells, strips or leaf blocks
  std::size_t depth = 0;      ///< levels of the node tree; 0 if there is none
  std::uint64_t builds = 0;   ///< since construction
  std::uint64_t refits = 0;   ///< refreshes that did not need a build
  std::uint64_t full_queries = 0;
  std::uint64_t incremental_queries = 0;
  std::uint64_t last_tests = 0;  ///< tests of 16 volumes at once, in the last pair query
  std::uint64_t last_pairs = 0;  ///< pairs reported by the last pair query
};

class RowPartition;

/// A spatial partition: takes bounding volumes with 64 bits of client data, hands out keys, and
/// answers which of them may touch. It never misses a pair; whether it reports pairs whose boxes do
/// not touch is stated by each partition.
///
/// Mutation costs O(1) an object; the structure follows at the next query (or `refresh`). Queries
/// that are const may run at the same time from several threads; everything else wants the
/// partition to itself. A refused call (any Status but ok) changed nothing: of a span, either all
/// entries are taken or none.
class Partition {
 public:
  Partition(const Partition&) = delete;
  Partition& operator=(const Partition&) = delete;
  virtual ~Partition() = default;

  /// Stable name, e.g. "LinearBvh".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// True if `self_pairs` reports exactly the pairs whose given boxes overlap: where the volumes
  /// are boxes without a margin.
  [[nodiscard]] virtual bool is_exact() const noexcept = 0;

  /// Adds one object per box. `keys` receives a key for each; `data` may be empty (all zero).
  virtual Status insert(const BoxView& boxes, std::span<const ClientData> data,
                        std::span<Key> keys) = 0;
  /// Adds one object.
  virtual Status insert(const Aabb& box, ClientData data, Key& key) = 0;
  /// Gives each object a new box. If a key occurs twice its last box counts. With a margin, a box
  /// within the stored one leaves that as it is, unless it is larger by more than twice the margin;
  /// the object then counts as not moved.
  virtual Status update(std::span<const Key> keys, const BoxView& boxes) = 0;
  virtual Status update(Key key, const Aabb& box) = 0;
  /// Removes the objects. A key that occurs twice makes the whole call `invalid_key`.
  virtual Status remove(std::span<const Key> keys) = 0;
  virtual Status remove(Key key) = 0;
  /// Removes every object. Memory is kept; `release_memory` gives it back.
  virtual void clear() noexcept = 0;
  /// Gives back all memory that an empty partition, or scratch, holds.
  virtual void release_memory() noexcept = 0;
  /// Room for `objects` in all, so that inserting up to there allocates no columns.
  virtual Status reserve(std::size_t objects) = 0;

  [[nodiscard]] virtual std::size_t size() const noexcept = 0;
  [[nodiscard]] virtual bool contains(Key key) const noexcept = 0;
  /// The box as it is tested: float, larger than given by the margin, the box around other volumes;
  /// an infinite extent is given back as infinite.
  virtual Status bounds(Key key, Aabb& box) const noexcept = 0;
  virtual Status client_data(Key key, ClientData& data) const noexcept = 0;
  /// Key of a live object; the null key for any other id.
  [[nodiscard]] virtual Key key_of(ObjectId id) const noexcept = 0;
  /// Client data of a live object; 0 for any other id.
  [[nodiscard]] virtual ClientData client_data_of(ObjectId id) const noexcept = 0;

  /// Sets what the objects let themselves be paired with. Every object starts with ObjectFilter{};
  /// a partition in which no other was ever set stores none.
  virtual Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) = 0;
  virtual Status set_filter(Key key, const ObjectFilter& filter) = 0;
  virtual Status filter(Key key, ObjectFilter& filter) const noexcept = 0;

  /// Brings the structure up to date now rather than in the next query.
  virtual Status refresh() const = 0;

  /// All pairs of objects whose volumes overlap, each once, first < second.
  virtual Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const = 0;
  /// All pairs (object of this, object of other) whose boxes overlap, each once.
  virtual Status pairs_with(const Partition& other, PairBuffer& out,
                            const PairOptions& options = {}) const = 0;

  /// The same, and what changed since the frame that `out` holds. The cost follows what moved.
  virtual Status self_pairs(PairBuffer& out, PairEvents& events,
                            const PairOptions& options = {}) const = 0;

  // Casts: rays and swept volumes against the objects' boxes (of spheres and k-DOPs: the box around
  // them). A start inside a box, or touching it, is a hit at min_t. Never a miss; a false hit only
  // where the gap is below 1e-14 of the coordinates' size (1e-6 for capsules). Equal t are ordered
  // by id.

  /// The hit with the least t; a null hit if there is none. About O(log n).
  virtual Status closest(const Cast& cast, Hit& hit, const Filter& filter = {}) const = 0;
  /// Any one hit, whichever is found first; a null hit if there is none.
  virtual Status any(const Cast& cast, Hit& hit, const Filter& filter = {}) const = 0;
  /// All hits, sorted by t.
  virtual Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const = 0;
  /// The same for many rays at once, which share the work where they are alike. One bad ray makes
  /// the whole batch `invalid_argument`.
  virtual Status closest(const RayBatch& rays, const HitColumns& hits,
                         const Filter& filter = {}) const = 0;
  virtual Status any(const RayBatch& rays, const HitColumns& hits,
                     const Filter& filter = {}) const = 0;
  virtual Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const = 0;

  /// Every object whose box meets the region, those that lie wholly inside told from those that
  /// cross its border. A frustum or set of planes "meets" a box that is not wholly outside of one
  /// of its planes (or of the frustum's own box). Never a miss; a false hit only within rounding.
  /// Order::canonical sorts each of the two groups by id.
  virtual Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                         Order order = Order::fast) const = 0;
  /// All pairs (index of the box, object) that overlap. Boxes may reach to infinity.
  virtual Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                         Order order = Order::fast) const = 0;

  /// The `count` objects whose boxes are nearest to a finite box (a point is one of no extent)
  /// within a distance of `radius`, which may be infinite; sorted by distance, then by id. Those
  /// that touch are at distance 0. About O(log n + count).
  virtual Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                         const Filter& filter = {}) const = 0;

  /// Draws the objects and the partition's own structure. A picture, not a query: O(n).
  virtual Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const = 0;

  /// The rows behind this partition, for `pairs_with`; null if it keeps none.
  [[nodiscard]] virtual const RowPartition* row_partition() const noexcept { return nullptr; }

  [[nodiscard]] virtual Footprint footprint() const noexcept = 0;
  [[nodiscard]] virtual Statistics statistics() const noexcept = 0;

 protected:
  Partition() = default;
};

/// Names of all partitions, in the order in which reports list them.
[[nodiscard]] std::span<const std::string_view> partition_names() noexcept;

/// A partition by name with its default settings; null if there is no such name.
[[nodiscard]] std::unique_ptr<Partition> make_partition(std::string_view name,
                                                        const PartitionOptions& options = {});

}  // namespace winnow
