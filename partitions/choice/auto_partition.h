#pragma once

#include "partitions/choice/partition_costs.h"
#include "partitions/choice/scene_features.h"
#include "partitions/rows/row_partition.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string_view>

namespace winnow {

/// Picks a partition for the scene it is given and goes on picking. It holds one other partition
/// and hands every call on to it; at a refresh it may hand the objects over to another kind, which
/// costs one build and which no caller can see but by the time taken: keys, filters, client data,
/// tracked pair buffers and pair events go on, and results in canonical order are the same.
///
/// What each kind would have cost is predicted in every frame from what the frame did (objects
/// moved, pairs, rays, regions and nearest objects asked for) and from a sample of the scene (see
/// SceneFeatures and PartitionCosts), which is taken anew only after much has moved. The first
/// choice is the cheapest prediction. Later ones are a ski rental: another kind is taken once what
/// it would have saved exceeds what handing over costs (an eighth, a quarter and a half of that for
/// the first three changes, where it is clearly cheaper), and each kind that was left before must
/// save twice as much to come back, so that a scene that alternates does not. Cells that were seen
/// to be built often, because objects are fast, count as that much dearer. All decisions follow
/// counts and samples, never time: they are the same on every machine, instruction set and number
/// of threads.
///
/// It changes kind only where something changed since the last refresh. A world that is built once
/// and only asked from then on keeps its first choice; volumes other than boxes stay in a
/// LinearBvh. Exact for boxes without a margin.
class AutoPartition final : public Partition {
 public:
  explicit AutoPartition(const PartitionOptions& options = {});
  ~AutoPartition() override;

  [[nodiscard]] std::string_view name() const noexcept override { return "AutoPartition"; }
  [[nodiscard]] bool is_exact() const noexcept override {
    return options_.volume == Volume::aabb && options_.margin.is_none();
  }

  /// Name of the partition that holds the objects.
  [[nodiscard]] std::string_view chosen() const noexcept;
  /// Why, in a few words.
  [[nodiscard]] std::string_view reason() const noexcept;
  /// How often the objects were handed over to another kind after the first choice.
  [[nodiscard]] std::uint64_t switches() const noexcept;
  /// What is known of the scene.
  [[nodiscard]] SceneFeatures features() const noexcept;

  Status insert(const BoxView& boxes, std::span<const ClientData> data,
                std::span<Key> keys) override;
  Status insert(const Aabb& box, ClientData data, Key& key) override;
  Status update(std::span<const Key> keys, const BoxView& boxes) override;
  Status update(Key key, const Aabb& box) override;
  Status remove(std::span<const Key> keys) override;
  Status remove(Key key) override;
  void clear() noexcept override;
  void release_memory() noexcept override;
  Status reserve(std::size_t objects) override;

  [[nodiscard]] std::size_t size() const noexcept override;
  [[nodiscard]] bool contains(Key key) const noexcept override;
  Status bounds(Key key, Aabb& box) const noexcept override;
  Status client_data(Key key, ClientData& data) const noexcept override;
  [[nodiscard]] Key key_of(ObjectId id) const noexcept override;
  [[nodiscard]] ClientData client_data_of(ObjectId id) const noexcept override;

  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) override;
  Status set_filter(Key key, const ObjectFilter& filter) override;
  Status filter(Key key, ObjectFilter& filter) const noexcept override;

  Status refresh() const override;
  Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const override;
  Status self_pairs(PairBuffer& out, PairEvents& events,
                    const PairOptions& options = {}) const override;
  Status pairs_with(const Partition& other, PairBuffer& out,
                    const PairOptions& options = {}) const override;

  Status closest(const Cast& cast, Hit& hit, const Filter& filter = {}) const override;
  Status any(const Cast& cast, Hit& hit, const Filter& filter = {}) const override;
  Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const override;
  Status closest(const RayBatch& rays, const HitColumns& hits,
                 const Filter& filter = {}) const override;
  Status any(const RayBatch& rays, const HitColumns& hits,
             const Filter& filter = {}) const override;
  Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const override;
  Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                 Order order = Order::fast) const override;
  Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                 Order order = Order::fast) const override;
  Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                 const Filter& filter = {}) const override;
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const override;

  /// Of the partition that holds the objects now: not to be kept beyond the next change.
  [[nodiscard]] const RowPartition* row_partition() const noexcept override;

  [[nodiscard]] Footprint footprint() const noexcept override;
  [[nodiscard]] Statistics statistics() const noexcept override;

 private:
  // Queries of one kind since the last refresh. Counted up to a limit, past which the line is only
  // read, so that threads which ask at once do not wait for each other.
  class Counter {
   public:
    void add(std::size_t count) noexcept {
      if (count_.load(std::memory_order_relaxed) < kMost) {
        count_.fetch_add(count, std::memory_order_relaxed);
      }
    }
    [[nodiscard]] std::size_t take() noexcept {
      if (count_.load(std::memory_order_relaxed) == 0) return 0;
      const std::size_t count = count_.exchange(0, std::memory_order_relaxed);
      return count < kMost ? count : kMost;
    }

   private:
    static constexpr std::size_t kMost = std::size_t{1} << 16U;
    std::atomic<std::size_t> count_{0};
  };

  void note_changes(std::size_t count) noexcept;
  [[nodiscard]] FrameWork take_frame() noexcept;
  Status refresh_now();
  void choose() noexcept;
  void guess(FrameWork frame) noexcept;
  void consider(const FrameWork& frame) noexcept;
  void note_builds() noexcept;
  /// With the builds of cells beyond the usual.
  [[nodiscard]] double cost_of(const PartitionCosts& costs, PartitionKind kind) const noexcept;
  Status hand_over();
  void move_in(PartitionKind kind) noexcept;

  /// Calls `use(inner)` while no other thread can exchange it.
  template <typename Use>
  auto look(Use&& use) const noexcept {
    std::unique_lock lock(mutex_, std::defer_lock);
    if (stale_.load(std::memory_order_acquire)) lock.lock();
    return use(*inner_);
  }
  /// Brings everything up to date, counts `count` questions (from here on the refresh that reads
  /// the counters is over) and calls `question(inner)`; empties the buffers if it cannot.
  template <typename Question, typename... Buffers>
  Status ask(Counter& counter, std::size_t count, Question&& question, Buffers&... buffers) const {
    if (const Status status = refresh(); status != Status::ok) {
      (buffers.clear(), ...);
      return status;
    }
    counter.add(count);
    return question(*inner_);
  }
  void note_pairs(const PairBuffer& out, bool full, const PairOptions& options) const noexcept;

  static constexpr std::size_t kRoom = 8192;  // bytes of the largest partition

  PartitionOptions options_;
  // Two places, so that the objects can be handed from one to the other.
  struct alignas(64) Place {
    std::byte bytes[kRoom];
  };
  std::array<Place, 2> places_;
  RowPartition* inner_ = nullptr;
  std::size_t place_ = 0;  // of the inner one
  PartitionKind kind_{};
  PartitionKind wanted_{};

  mutable std::mutex mutex_;
  // True from a change on until a refresh is through. Only in between is the inner partition
  // exchanged, and only under the mutex.
  mutable std::atomic<bool> stale_{false};

  SceneFeatures features_;
  PartitionCosts::List saved_{};  // by kind: what it would have saved, not yet spent
  std::array<std::uint8_t, kPartitionKinds> left_{};  // how often each was left
  double build_share_ = 0.1;       // of refreshes with cells: about how many built them
  std::uint64_t builds_seen_ = 0;  // by the kind that holds the objects
  std::size_t held_ = 0;           // refreshes by it, up to a limit
  std::string_view reason_ = "nothing to choose by yet";
  std::uint64_t switches_ = 0;
  std::size_t objects_seen_ = 0;  // when the sample was taken
  std::size_t changed_ = 0;       // objects since the last refresh
  std::size_t unseen_ = 0;        // changes since the last sample
  std::size_t pairs_seen_ = 0;    // pairs when the sample was taken
  std::size_t waiting_ = 0;       // refreshes to wait after memory was refused
  bool chosen_ = false;
  bool build_due_ = false;                     // in the last refresh, whatever was chosen
  mutable std::atomic<std::size_t> pairs_{0};  // in the last frame that asked for all
  mutable Counter pair_queries_;
  mutable Counter full_queries_;
  mutable Counter casts_;
  mutable Counter regions_;
  mutable Counter nearest_;
};

}  // namespace winnow
