#pragma once

#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include "partitions/rows/rows.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Counts queries since the last take(), up to a limit. Past the limit the counter is only read, so
/// that concurrent queries do not contend for its cache line.
class QueryCounter {
 public:
  void add(std::size_t count) noexcept {
    if (count_.load(std::memory_order_relaxed) < kMaxCount) {
      count_.fetch_add(count, std::memory_order_relaxed);
    }
  }
  [[nodiscard]] std::size_t take() noexcept {
    if (count_.load(std::memory_order_relaxed) == 0) return 0;
    const std::size_t count = count_.exchange(0, std::memory_order_relaxed);
    return count < kMaxCount ? count : kMaxCount;
  }

 private:
  static constexpr std::size_t kMaxCount = std::size_t{1} << 16U;
  std::atomic<std::size_t> count_{0};
};

/// Kinds of queries that a chooser counts.
enum class QueryKind : std::uint8_t { pairs, all_pairs, casts, regions, nearest };
inline constexpr std::size_t kQueryKinds = 5;

/// Interface of a partition's automatic choice of structure: it is notified of the partition's work
/// and returns the structure for each refresh. PartitionState owns it; AutomaticChoice
/// (automatic.cpp) implements it.
class Chooser {
 public:
  Chooser() = default;
  Chooser(const Chooser&) = delete;
  Chooser& operator=(const Chooser&) = delete;

  /// The structure that a new partition begins with.
  [[nodiscard]] virtual StructureKind first() const noexcept = 0;
  /// All structures that choose() may return.
  [[nodiscard]] virtual std::span<const StructureKind> choices() const noexcept = 0;
  /// State of the structure in use.
  struct Wear {
    std::uint64_t builds = 0;
    /// Tests of 16 volumes in queries since the last build, compared with a fresh structure.
    std::uint64_t excess = 0;
    /// Number of new objects that makes a build due.
    std::size_t max_new = 1;
  };
  /// Returns the structure for this refresh; `now` is the structure in use.
  [[nodiscard]] virtual StructureKind choose(const Rows& rows, StructureKind now,
                                             const Wear& wear) noexcept = 0;
  /// Ends a refresh that succeeded. `now` is the structure in use: the chosen one, or the previous
  /// one if the memory of the chosen one could not be allocated.
  virtual void refreshed(const Rows& rows, StructureKind now, std::uint64_t builds) noexcept = 0;
  /// Called if the memory of the chosen structure could not be allocated.
  virtual void refused() noexcept = 0;
  /// Called after all objects were removed.
  virtual void clear() noexcept = 0;
  virtual void report(StructureChoice& choice) const noexcept = 0;

  /// The size of the implementation in bytes.
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
  virtual void destroy(std::pmr::memory_resource* memory) noexcept = 0;

  void note_changes(std::size_t count) noexcept { changed_ += count; }
  /// Counts inserted objects, which are also counted as changes.
  void note_inserted(std::size_t count) noexcept { new_ += count; }
  void count_queries(QueryKind kind, std::size_t count) noexcept {
    queries_[static_cast<std::size_t>(kind)].add(count);
  }
  /// Stores the number of pairs that the last query for all pairs found.
  void note_pairs(std::size_t pairs) noexcept { pairs_.store(pairs, std::memory_order_relaxed); }

 protected:
  ~Chooser() = default;

  [[nodiscard]] std::size_t take(QueryKind kind) noexcept {
    return queries_[static_cast<std::size_t>(kind)].take();
  }

  std::size_t changed_ = 0;            // objects changed since the last refresh
  std::size_t new_ = 0;                // objects inserted since the last read of this count
  std::atomic<std::size_t> pairs_{0};  // result of the last query for all pairs

 private:
  QueryCounter queries_[kQueryKinds];
};

}  // namespace winnow
