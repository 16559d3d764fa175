#pragma once

#include <winnow/core/kdop.h>
#include <winnow/core/sphere.h>
#include <winnow/partitions/row_partition.h>

#include <span>

namespace winnow {

/// Tests the bounding volume of every object against every other, 16 at a time: no structure at
/// all, the least memory, and the fastest choice for some hundreds of objects. Volumes are boxes,
/// spheres or k-DOPs; given boxes, a sphere or k-DOP partition stores the tightest volume around
/// each (a sphere wants finite boxes). O(n^2 / 16) tests. Exact for its volume; spheres that miss
/// each other by less than 1e-6 of their distance may be reported.
class BoundsNSquared final : public RowPartition {
 public:
  explicit BoundsNSquared(const PartitionOptions& options = {});

  using RowPartition::insert;
  using RowPartition::update;

  /// For Volume::sphere; else `unsupported_volume`.
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  Status update(std::span<const Key> keys, std::span<const Sphere> spheres);

  /// For the volume of the same K; else `unsupported_volume`. K is 14, 18 or 26.
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  template <int K>
  Status update(std::span<const Key> keys, std::span<const Kdop<K>> kdops);

  [[nodiscard]] std::string_view name() const noexcept override { return "BoundsNSquared"; }

 private:
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  [[nodiscard]] bool is_flat() const noexcept override { return true; }
};

}  // namespace winnow
