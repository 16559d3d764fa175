#pragma once

#include <winnow/core/aabb.h>
#include "bench/common/interface.h"
#include "bench/scenes/query_set.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace winnow::bench {

/// Queries are run by one call each, or by one call for many.
enum class QueryMode { single, batch };

/// Base of everything that runs queries on boxes: winnow's partitions and other libraries. The
/// harness times `run` from outside. All work that a user pays for (sorting hits, removing
/// candidates that do not overlap, building a structure over a batch) therefore belongs in `run`.
///
/// An object is identified by its row, 0..N-1. All calls come from one thread, inside a
/// `tbb::task_arena` of the thread count that the engine was made for.
class QueryEngine : public Interface {
 public:
  /// A short constant name, e.g. "LinearBvh".
  [[nodiscard]] virtual std::string name() const = 0;

  /// True if the engine supports these queries, single or batched.
  [[nodiscard]] virtual bool takes(const QuerySet& set, QueryMode mode) const = 0;

  /// Number of queries of a set that can be run in reasonable time.
  [[nodiscard]] virtual std::size_t most_questions() const {
    return std::numeric_limits<std::size_t>::max();
  }

  /// Takes the boxes (row = index) and prepares everything. Called once, before any query; `boxes`
  /// outlives the engine.
  virtual void start(std::span<const Aabb> boxes) = 0;

  /// Runs the first `count` queries of the set and returns the number of objects found. Results are
  /// written where a caller can read them, and overwritten by the next query or batch.
  virtual std::uint64_t run(const QuerySet& set, QueryMode mode, std::size_t count) = 0;

  /// Runs the queries and returns the results. Not timed; single queries run on one thread.
  [[nodiscard]] virtual QueryResults answers(const QuerySet& set, QueryMode mode,
                                             std::size_t count) = 0;
};

}  // namespace winnow::bench
