#pragma once

#include <winnow/core/column.h>
#include <winnow/core/footprint.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/narrow_result.h>
#include "pipeline/shapes/pair_order.h"

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Pairs sorted by the kinds of their shapes (stable), the smaller kind first in each.
class PairBuckets {
 public:
  explicit PairBuckets(std::pmr::memory_resource* memory) noexcept
      : sorted_(memory), codes_(memory) {}

  /// Sorts, or finds that nothing is to be sorted. `order` is set to the place of each sorted pair
  /// in the input. `invalid_argument` for a body that does not exist, `invalid_key` for a shape
  /// that does not (`bad_body` says whose).
  Status sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
              std::span<const BodyPair> pairs, Column<std::uint32_t>& order,
              Column<NarrowRun>& runs, std::uint32_t& bad_body);

  [[nodiscard]] const BodyPair* pairs() const noexcept { return pairs_; }
  /// True if some pair is given the other way round than it was.
  [[nodiscard]] bool any_mirrored() const noexcept { return any_mirrored_; }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  Status classify(const ShapeTables& tables, std::span<const ShapeId> shapes,
                  std::span<const BodyPair> pairs, std::uint32_t& bad_body);
  Status add_runs(Column<NarrowRun>& runs) const;

  Column<BodyPair> sorted_;
  Column<std::uint8_t> codes_;
  std::uint32_t counts_[ConvexKindPairs::kCount] = {};
  const BodyPair* pairs_ = nullptr;
  bool any_mirrored_ = false;
};

}  // namespace winnow
