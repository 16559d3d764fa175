#pragma once

#include "bench/common/counting_resource.h"
#include "bench/contenders/engines.h"
#include "bench/contenders/partitions.h"

#include <tbb/enumerable_thread_specific.h>
#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A partition queried as a simulation does it: buffers are reused from query to query. Single
/// queries run on all threads of the arena; a batch is one call.
class PartitionQueries final : public QueryEngine {
 public:
  /// `name` is one of all_partitions().
  PartitionQueries(std::string_view name, int threads);

  [[nodiscard]] std::string name() const override { return std::string(partition_.name()); }
  /// True unless the partition does not support such queries.
  [[nodiscard]] bool takes(const QuerySet& set, QueryMode mode) const override;
  [[nodiscard]] std::size_t most_questions() const override;
  void start(std::span<const Aabb> boxes) override;
  /// Throws std::runtime_error if the partition returns an error.
  std::uint64_t run(const QuerySet& set, QueryMode mode, std::size_t count) override;
  [[nodiscard]] QueryResults answers(const QuerySet& set, QueryMode mode,
                                     std::size_t count) override;

  [[nodiscard]] Partition& partition() noexcept { return partition_; }
  /// The memory resource of the partition and of the buffers of single-threaded queries.
  [[nodiscard]] const CountingResource& memory() const noexcept { return memory_; }

 private:
  struct Buffers {
    explicit Buffers(std::pmr::memory_resource* memory)
        : hits(memory), overlaps(memory), pairs(memory) {}

    HitBuffer hits;
    OverlapBuffer overlaps;
    PairBuffer pairs;
    std::vector<float> t;
    std::vector<Key> keys;
  };

  template <typename Visit>
  void run_each(const QuerySet& set, std::size_t begin, std::size_t end, Buffers& buffers,
                Visit&& visit) const;
  void run_batch(const QuerySet& set, std::size_t count);
  void gather(const QuerySet& set, std::size_t count, QueryResults& answers);

  CountingResource memory_;
  Partition partition_;
  Buffers buffers_{&memory_};
  tbb::enumerable_thread_specific<Buffers> thread_buffers_{std::pmr::new_delete_resource()};
  std::vector<Key> keys_;
};

}  // namespace winnow::bench
