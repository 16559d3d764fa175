#pragma once

#include "partitions/rows/row_partition.h"

namespace winnow {

/// Reports every pair of objects without looking at their bounds: n(n-1)/2 pairs, no structure. The
/// baseline that says what a test is worth, and the slow obvious twin of every other partition.
class NSquared final : public RowPartition {
 public:
  explicit NSquared(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "NSquared"; }
  [[nodiscard]] bool is_exact() const noexcept override { return false; }

 private:
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  [[nodiscard]] bool is_flat() const noexcept override { return true; }
};

}  // namespace winnow
