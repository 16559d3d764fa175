#pragma once

#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include "partitions/rows/rows.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Counts questions since the last look. Up to a limit, past which the line is only read, so that
/// threads which ask at once do not wait for each other.
class QueryCounter {
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

/// What was asked of a partition.
enum class QueryKind : std::uint8_t { pairs, all_pairs, casts, regions, nearest };
inline constexpr std::size_t kQueryKinds = 5;

/// What goes on choosing a partition's structure, and what it is told of the partition's work.
class Chooser {
 public:
  Chooser() = default;
  Chooser(const Chooser&) = delete;
  Chooser& operator=(const Chooser&) = delete;

  /// A structure to begin with.
  [[nodiscard]] virtual StructureKind first() const noexcept = 0;
  /// Those that it may choose.
  [[nodiscard]] virtual std::span<const StructureKind> range() const noexcept = 0;
  /// What a structure that is in use has been through.
  struct Wear {
    std::uint64_t builds = 0;
    /// Tests of 16 volumes that queries took since the last one, beyond those on a fresh structure.
    std::uint64_t excess = 0;
    /// New objects that a build is due at.
    std::size_t most_new = 1;
  };
  /// The structure to refresh with; it holds `now`.
  [[nodiscard]] virtual StructureKind choose(const Rows& rows, StructureKind now,
                                             const Wear& wear) noexcept = 0;
  /// Ends a refresh that succeeded, with what was chosen or, if that did not get its memory, with
  /// what was there before.
  virtual void refreshed(const Rows& rows, StructureKind now, std::uint64_t builds) noexcept = 0;
  /// Memory for what was chosen was refused.
  virtual void refused() noexcept = 0;
  /// All objects are gone.
  virtual void clear() noexcept = 0;
  virtual void report(StructureChoice& choice) const noexcept = 0;

  /// Its sizeof.
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
  virtual void end(std::pmr::memory_resource* memory) noexcept = 0;

  void note_changes(std::size_t count) noexcept { changed_ += count; }
  /// Of the changes, objects that were inserted.
  void note_new(std::size_t count) noexcept { new_ += count; }
  void note(QueryKind kind, std::size_t count) noexcept {
    asked_[static_cast<std::size_t>(kind)].add(count);
  }
  /// Of a query for all pairs that says something about the scene.
  void note_pairs(std::size_t pairs) noexcept { pairs_.store(pairs, std::memory_order_relaxed); }

 protected:
  ~Chooser() = default;

  [[nodiscard]] std::size_t take(QueryKind kind) noexcept {
    return asked_[static_cast<std::size_t>(kind)].take();
  }

  std::size_t changed_ = 0;            // objects since the last refresh
  std::size_t new_ = 0;                // objects since it was last read
  std::atomic<std::size_t> pairs_{0};  // in the last frame that asked for all

 private:
  QueryCounter asked_[kQueryKinds];
};

}  // namespace winnow
