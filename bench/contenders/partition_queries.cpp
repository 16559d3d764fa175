// Single and batched queries of a partition, as bench/micro times them, and the conversion
// of their results to rows.

#include "bench/contenders/partition_queries.h"

#include "bench/common/need.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <type_traits>

namespace winnow::bench {
namespace {

/// Largest number of box tests for one run on a partition that tests every box per query.
constexpr double kMaxTests = 2e8;

Found to_found(const Hit& hit) noexcept {
  return {hit.key.id, hit.t};
}

}  // namespace

PartitionQueries::PartitionQueries(std::string_view name, int threads)
    : partition_(make_named(name, {.memory = &memory_, .execution = execution_for(threads)})) {}

bool PartitionQueries::takes(const QuerySet& set, QueryMode mode) const {
  return mode == QueryMode::single || !set.rays.empty() ||
         (!set.boxes.empty() && set.query_type == QueryType::overlap);
}

std::size_t PartitionQueries::most_questions() const {
  if (!partition_.name().ends_with("NSquared")) return QueryEngine::most_questions();
  const double count = kMaxTests / static_cast<double>(std::max<std::size_t>(1, keys_.size()));
  return std::max<std::size_t>(16, static_cast<std::size_t>(count));
}

void PartitionQueries::start(std::span<const Aabb> boxes) {
  keys_.resize(boxes.size());
  // The objects of a new partition have the ids 0, 1, 2, ..., which are therefore rows.
  need(partition_.insert(boxes, {}, keys_), "a query");
  need(partition_.refresh(), "a query");
}

/// Calls `visit(results)` after each query, with a Hit, a HitBuffer or an OverlapBuffer.
template <typename Visit>
void PartitionQueries::run_each(const QuerySet& set, std::size_t begin, std::size_t end,
                                Buffers& buffers, Visit&& visit) const {
  const Partition& partition = partition_;
  const auto cast_one = [&](const Cast& cast) {
    if (set.query_type == QueryType::all) {
      need(partition.all(cast, buffers.hits), "a query");
      visit(buffers.hits);
      return;
    }
    const bool any = set.query_type == QueryType::any;
    visit(Hit(need(any ? partition.any(cast) : partition.closest(cast), "a query")));
  };
  const auto overlap_one = [&](const Region& region) {
    need(partition.overlap(region, buffers.overlaps), "a query");
    visit(buffers.overlaps);
  };
  for (std::size_t i = begin; i < end; ++i) {
    if (!set.rays.empty()) {
      cast_one(set.rays[i]);
    } else if (!set.casts.empty()) {
      cast_one(set.casts[i]);
    } else if (!set.regions.empty()) {
      overlap_one(set.regions[i]);
    } else if (set.query_type == QueryType::overlap) {
      overlap_one(set.boxes[i]);
    } else {
      constexpr float kAnyDistance = std::numeric_limits<float>::infinity();
      need(partition.nearest(set.boxes[i], set.count, kAnyDistance, buffers.hits), "a query");
      visit(buffers.hits);
    }
  }
}

/// Runs one batched query; the results are in `buffers_`.
void PartitionQueries::run_batch(const QuerySet& set, std::size_t count) {
  const Partition& partition = partition_;
  if (set.rays.empty()) {
    need(partition.overlap(std::span(set.boxes).first(count), buffers_.pairs), "a query");
    return;
  }
  const RayBatch rays(std::span(set.rays).first(count));
  if (set.query_type == QueryType::all) {
    need(partition.all(rays, buffers_.hits), "a query");
    return;
  }
  buffers_.keys.resize(count);
  buffers_.t.resize(count);
  const HitColumns columns{.key = buffers_.keys.data(), .t = buffers_.t.data()};
  need(set.query_type == QueryType::any ? partition.any(rays, columns)
                                        : partition.closest(rays, columns),
       "a query");
}

std::uint64_t PartitionQueries::run(const QuerySet& set, QueryMode mode, std::size_t count) {
  if (mode == QueryMode::batch) {
    run_batch(set, count);
    if (set.rays.empty()) return buffers_.pairs.size();
    if (set.query_type == QueryType::all) return buffers_.hits.size();
    return count - static_cast<std::uint64_t>(
                       std::count(buffers_.keys.begin(), buffers_.keys.end(), Key{}));
  }
  const auto run_part = [&](std::size_t begin, std::size_t end, Buffers& buffers) {
    std::uint64_t found = 0;
    run_each(set, begin, end, buffers, [&](const auto& results) {
      if constexpr (std::is_same_v<std::decay_t<decltype(results)>, Hit>) {
        found += results ? 1U : 0U;
      } else {
        found += results.size();
      }
    });
    return found;
  };
  if (tbb::this_task_arena::max_concurrency() == 1) return run_part(0, count, buffers_);
  std::atomic<std::uint64_t> found{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
    found += run_part(range.begin(), range.end(), thread_buffers_.local());
  });
  return found;
}

QueryResults PartitionQueries::answers(const QuerySet& set, QueryMode mode, std::size_t count) {
  QueryResults result;
  if (mode == QueryMode::batch) {
    run_batch(set, count);
    gather(set, count, result);
    return result;
  }
  run_each(set, 0, count, buffers_, [&](const auto& results) {
    using Results = std::decay_t<decltype(results)>;
    if constexpr (std::is_same_v<Results, Hit>) {
      if (results) result.add(to_found(results));
    } else if constexpr (std::is_same_v<Results, OverlapBuffer>) {
      for (const ObjectId id : results.ids()) result.add({id, 0.0F});
    } else {
      for (const Hit& hit : results) result.add(to_found(hit));
    }
    result.next();
  });
  return result;
}

/// Adds the results of the last batch to `answers`.
void PartitionQueries::gather(const QuerySet& set, std::size_t count, QueryResults& answers) {
  std::vector<Pair> pairs;
  if (set.rays.empty()) pairs.assign(buffers_.pairs.begin(), buffers_.pairs.end());
  std::sort(pairs.begin(), pairs.end());
  auto pair = pairs.begin();
  for (std::size_t i = 0; i < count; ++i) {
    if (set.rays.empty()) {
      for (; pair != pairs.end() && pair->first == i; ++pair) answers.add({pair->second, 0.0F});
    } else if (set.query_type == QueryType::all) {
      for (const Hit& hit : buffers_.hits.of(i)) answers.add(to_found(hit));
    } else if (buffers_.keys[i].id != kNoObject) {
      answers.add({buffers_.keys[i].id, buffers_.t[i]});
    }
    answers.next();
  }
}

}  // namespace winnow::bench
