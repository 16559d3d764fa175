#pragma once

// The observer of a recorded partition. Partition calls it at the end of each call that succeeds,
// with the arguments and results; pipeline/recording/ implements it.

#include <winnow/partitions/partition.h>
#include "core/threads/mutex.h"
#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/state/partition_state.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Volumes given to a call: a view of boxes, or an array of spheres or k-DOPs.
struct GivenVolumes {
  explicit GivenVolumes(const BoxView& given) noexcept : count(given.count), boxes(given) {}
  explicit GivenVolumes(const Aabb& box) noexcept
      : GivenVolumes(BoxView(std::span<const Aabb>(&box, 1))) {}
  template <typename V>
  GivenVolumes(Volume kind, std::span<const V> given) noexcept
      : volume(kind), count(given.size()), bytes(std::as_bytes(given)) {}

  Volume volume = Volume::aabb;
  std::size_t count;
  BoxView boxes;                     // of Volume::aabb
  std::span<const std::byte> bytes;  // of all other kinds
};

/// Where a query for the pairs of one partition writes its results. Recordings contain the values.
enum class PairForm : std::uint8_t { buffer, buffer_and_events, events };

/// A query for the pairs of one partition. Created before the query runs, because the query updates
/// the results of an earlier one.
struct ObservedPairQuery {
  ObservedPairQuery(PairForm kind, const PairBuffer& out, const PairEvents* changes) noexcept
      : form(kind), pairs(out), events(changes), pairs_before(PairTracker::provenance(out)) {
    if (changes != nullptr) events_before = EventWriter::provenance(*changes);
  }

  PairForm form;
  const PairBuffer& pairs;
  const PairEvents* events;  // null for PairForm::buffer
  /// The query whose result the buffer contained, and the query whose result the events contained.
  PairBuffer::Provenance pairs_before;
  PairBuffer::Provenance events_before;
};

/// Receives the successful calls of one partition, each with its arguments and then its results. A
/// call that another call of the partition makes is not received. Calls of const functions may come
/// from several threads at once.
class PartitionObserver {
 public:
  PartitionObserver(const PartitionObserver&) = delete;
  PartitionObserver& operator=(const PartitionObserver&) = delete;

  /// Called before the partition is destroyed; destroys this object.
  virtual void end() noexcept = 0;
  /// Called after a call that a recording cannot contain.
  virtual void give_up() noexcept = 0;

  virtual void set_structure(StructureKind structure) noexcept = 0;
  virtual void insert(const GivenVolumes& volumes, std::span<const ClientData> data) noexcept = 0;
  virtual void update(std::span<const Key> keys, const GivenVolumes& volumes) noexcept = 0;
  virtual void update(std::span<const Key> keys, const BoxView& boxes,
                      const IndexSubset& entries) noexcept = 0;
  virtual void remove(std::span<const Key> keys) noexcept = 0;
  virtual void clear() noexcept = 0;
  virtual void release_memory() noexcept = 0;
  virtual void set_filter(std::span<const Key> keys,
                          std::span<const ObjectFilter> filters) noexcept = 0;
  virtual void refresh() noexcept = 0;

  virtual void self_pairs(const PairOptions& options, const ObservedPairQuery& query) noexcept = 0;
  /// `other` is the observer of the other partition; null if that partition is not recorded.
  virtual void pairs_with(PartitionObserver* other, const PairOptions& options,
                          const PairBuffer& out) noexcept = 0;
  virtual void closest(const Cast& cast, const Filter& filter, const Hit& hit) noexcept = 0;
  virtual void any(const Cast& cast, const Filter& filter, const Hit& hit) noexcept = 0;
  virtual void all(const Cast& cast, const Filter& filter, const HitBuffer& hits) noexcept = 0;
  virtual void closest(const RayBatch& rays, const Filter& filter,
                       const HitColumns& hits) noexcept = 0;
  virtual void any(const RayBatch& rays, const Filter& filter, const HitColumns& hits) noexcept = 0;
  virtual void all(const RayBatch& rays, const Filter& filter, const HitBuffer& hits) noexcept = 0;
  virtual void overlap(const Region& region, const Filter& filter, Order order,
                       const OverlapBuffer& objects) noexcept = 0;
  virtual void overlap(const BoxView& boxes, const Filter& filter, Order order,
                       const PairBuffer& out) noexcept = 0;
  virtual void nearest(const Aabb& from, std::size_t count, float radius, const Filter& filter,
                       const HitBuffer& hits) noexcept = 0;

  /// Held during `self_pairs`: its results depend on the queries before it, so a recording contains
  /// these queries in the order in which they ran.
  Mutex self_pairs_mutex;

 protected:
  PartitionObserver() = default;
  ~PartitionObserver() = default;
};

/// True if a call with this status succeeded, and the partition is recorded.
[[nodiscard]] inline bool is_observed(Status status, const PartitionState* state) noexcept {
  return status == Status::ok && state->observer != nullptr;
}

}  // namespace winnow
