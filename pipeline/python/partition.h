#pragma once

#include "pipeline/python/arrays.h"
#include "pipeline/python/callbacks.h"
#include "pipeline/python/choices.h"
#include "pipeline/python/described.h"
#include "pipeline/python/init_checks.h"
#include "pipeline/python/inputs.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/pool.h"
#include "pipeline/python/recordings.h"

#include <winnow/core/filter.h>
#include <winnow/core/memory.h>
#include <winnow/core/results.h>
#include <winnow/partitions/partition.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

namespace winnow::python {

inline constexpr Choices<Volume, 5> kVolumes{{{"aabb", Volume::aabb},
                                              {"sphere", Volume::sphere},
                                              {"kdop14", Volume::kdop14},
                                              {"kdop18", Volume::kdop18},
                                              {"kdop26", Volume::kdop26}}};
inline constexpr Choices<Order, 2> kOrders{
    {{"fast", Order::fast}, {"canonical", Order::canonical}}};

/// Returns the structure with this name; throws an invalid_argument that lists all names.
[[nodiscard]] StructureKind structure_of(const std::string& name);

/// A result object that is filled once per frame. Arrays of its data are copies.
template <typename Result>
class Exported : public NeedsInit {
 public:
  Exported() = default;
  /// `lent`: the value is filled by another object.
  explicit Exported(std::shared_ptr<Result> value, bool lent = true)
      : value_(std::move(value)), is_lent_(lent) {}

  [[nodiscard]] const std::shared_ptr<Result>& value() const noexcept { return value_; }
  /// Returns the value to be filled. Throws `unsupported` if another object fills it.
  [[nodiscard]] Result& to_fill(const char* what) const {
    if (is_lent_) {
      throw Refusal(Status::unsupported, std::string(what) + ": what they are of fills them");
    }
    return *value_;
  }
  /// Returns the lock that excludes other threads that fill it or make arrays of it. Waits without
  /// the GIL.
  [[nodiscard]] std::unique_lock<std::mutex> hold() const {
    InCallback::forbid();
    const WithoutGil release;
    return std::unique_lock(mutex_);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<Result> value_ = std::make_shared<Result>();
  bool is_lent_ = false;
};
struct Events : Exported<PairEvents> {
  explicit Events(bool client_data)
      : Exported(std::make_shared<PairEvents>(PairEventsOptions{default_memory(), client_data}),
                 false) {}

  /// The last fill used a predicate.
  std::atomic<bool> is_filtered{false};
};

/// A partition that several Python threads may use.
class SharedPartition : public NeedsInit {
 public:
  SharedPartition(StructureKind structure, const PartitionOptions& options,
                  RecorderPointer recorder_in);

  /// Returns a buffer for all pairs: the buffer of the last frame if no array refers to it. If one
  /// does, returns another buffer, with a copy of the last pairs if `with_events`, or if
  /// `incremental` and less than a quarter of the objects have changed.
  [[nodiscard]] std::shared_ptr<PairBuffer> take_pairs(bool incremental, bool with_events = false);
  void keep_pairs(std::shared_ptr<PairBuffer> pairs);
  /// Counts objects that have changed since the last pairs.
  void count_changes(std::size_t objects) noexcept { changes_ += objects; }

  mutable std::shared_mutex mutex;
  /// Null if it is not recorded.
  const RecorderPointer recorder;
  Partition partition;
  Execution execution;
  /// Buffer for boxes that cannot be read in place.
  std::vector<Aabb> room;
  std::shared_ptr<Pool<PairBuffer>> pair_pool = std::make_shared<Pool<PairBuffer>>();
  std::shared_ptr<Pool<HitBuffer>> hit_pool = std::make_shared<Pool<HitBuffer>>();

 private:
  std::mutex pairs_mutex_;
  std::shared_ptr<PairBuffer> last_pairs_;
  std::atomic<std::size_t> changes_{0};
};

/// True if a key is of an object of the partition.
[[nodiscard]] inline bool has_key(const SharedPartition& p, Key key) {
  return reading(p.mutex, [&] { return p.partition.contains(key); });
}
/// Pairs as an (m, 2) array.
[[nodiscard]] py::array shown_pairs(const std::shared_ptr<PairBuffer>& pairs);
/// Bytes by purpose.
[[nodiscard]] py::dict footprint_dict(const Footprint& footprint);

using PartitionClass = Class<SharedPartition>;

// Each function adds the contents of the source file of the same name.
void add_partition(py::module_& module, PartitionClass& partition);
void add_objects(py::module_& module, PartitionClass& partition);
void add_pairs(py::module_& module, PartitionClass& partition);
void add_queries(py::module_& module, PartitionClass& partition);

}  // namespace winnow::python
