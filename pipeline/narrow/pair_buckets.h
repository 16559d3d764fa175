#pragma once

// The first step of NarrowPhase: pairs sorted by the kinds of their shapes. pair_buckets.cpp
// implements it.

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shapes.h>
#include "core/memory/columns.h"
#include "pipeline/shapes/pair_order.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Sorts pairs by the kinds of their shapes (counting sort, stable). In each sorted pair the body
/// with the smaller kind is first.
class PairBuckets {
 public:
  explicit PairBuckets(std::pmr::memory_resource* memory) noexcept
      : sorted_(memory), codes_(memory), tasks_(memory) {}

  /// Sorts the pairs, unless all have the same two kinds and none has its bodies swapped; order[i]
  /// becomes the input index of sorted pair i. Returns `invalid_argument` for a body that does not
  /// exist, `invalid_key` for a shape that does not exist (`bad_body` is then its body).
  Status sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
              std::span<const BodyPair> pairs, const Execution& execution,
              Column<std::uint32_t>& order, Column<NarrowRun>& runs, std::uint32_t& bad_body);

  [[nodiscard]] const BodyPair* pairs() const noexcept { return pairs_; }
  /// True if some pair has its bodies swapped.
  [[nodiscard]] bool any_mirrored() const noexcept { return any_mirrored_; }
  [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(sorted_, codes_, tasks_); }

 private:
  /// The range of the pair codes that occur.
  struct CodeRange {
    std::uint32_t low = KindPairs::kCount;
    std::uint32_t high = 0;

    void add(std::uint32_t code) noexcept {
      low = std::min(low, code);
      high = std::max(high, code);
    }
  };
  /// The result of a task that checks and counts a range of the pairs.
  struct TaskCounts {
    Status status;
    std::uint32_t bad_body;
    std::uint32_t mirrored;
    CodeRange codes;
    /// Pairs by code. While pairs are sorted: the index of the next pair with this code.
    std::uint32_t counts[KindPairs::kCount];

    void clear() noexcept {
      status = Status::ok;
      mirrored = 0;
      codes = {};
      std::ranges::fill(counts, 0U);
    }
    void add(std::uint32_t code, std::uint32_t pairs) noexcept {
      counts[code] += pairs;
      codes.add(code);
    }
  };

  Status take_one(const ShapeTables& tables, std::span<const ShapeId> shapes,
                  std::span<const BodyPair> pair, Column<std::uint32_t>& order,
                  Column<NarrowRun>& runs, std::uint32_t& bad_body);
  template <typename Body>
  void for_tasks(std::span<const BodyPair> pairs, const Execution& execution, Body&& body);
  template <typename Note>
  void for_codes(const ShapeTables& tables, std::span<const ShapeId> shapes,
                 std::span<const BodyPair> pairs, std::size_t first, TaskCounts& task,
                 Note&& note) noexcept;
  void count_pairs(const ShapeTables& tables, std::span<const ShapeId> shapes,
                   std::span<const BodyPair> pairs, std::size_t first, TaskCounts& task) noexcept;
  Status sum_up(std::uint32_t& bad_body) noexcept;
  void find_offsets() noexcept;
  void place(std::span<const BodyPair> pairs, std::size_t first, TaskCounts& task,
             std::uint32_t* order) noexcept;
  Status add_runs(Column<NarrowRun>& runs) const;

  Column<BodyPair> sorted_;
  Column<std::uint8_t> codes_;
  Column<TaskCounts> tasks_;
  std::uint32_t counts_[KindPairs::kCount] = {};
  CodeRange range_;
  const BodyPair* pairs_ = nullptr;
  bool any_mirrored_ = false;
};

}  // namespace winnow
