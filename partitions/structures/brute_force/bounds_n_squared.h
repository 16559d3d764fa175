#pragma once

#include "partitions/rows/row_partition.h"

namespace winnow {

/// Tests the bounding volume of every object against every other, 16 at a time: no structure at
/// all, the least memory, and the fastest choice for some hundreds of objects. O(n^2 / 16) tests.
/// Exact for its volume.
class BoundsNSquared final : public RowPartition {
 public:
  explicit BoundsNSquared(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "BoundsNSquared"; }

 private:
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  [[nodiscard]] bool is_flat() const noexcept override { return true; }
};

}  // namespace winnow
