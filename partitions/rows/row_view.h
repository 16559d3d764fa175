#pragma once

// Views of rows that kernels read, and the sink that they write pairs to. All are plain structs,
// because kernel sources may include only headers of plain structs.

#include "core/memory/filter_columns.h"
#include "partitions/rows/filter_span.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Output of kernels: pairs of object ids. While cursor <= limit there is room for kSinkSlack
/// pairs. Beyond the limit the kernel calls `grow`, and stops if it returns false.
struct PairSink {
  std::uint32_t* cursor = nullptr;
  std::uint32_t* limit = nullptr;
  bool (*grow)(PairSink& sink) = nullptr;
  void* owner = nullptr;
  std::uint64_t tests = 0;  ///< tests of 16 volumes at once
};

/// Pairs that a kernel may write before it compares the cursor with the limit again: those of one
/// block with another, and one more full store.
inline constexpr std::size_t kSinkSlack = 16 * 16 + 16;

/// Columns of a BoundsPool. The first six are the box. The further slabs of a k-DOP follow (lower
/// ends, then upper ends), or the centre and radius of a sphere.
struct RowView {
  const float* column[26] = {};
  std::uint32_t further_slabs = 0;
  bool spheres = false;
  const std::uint32_t* id = nullptr;
  FilterColumns filter;       ///< by row; rows without an object have no layer
  bool environments = false;  ///< false if all objects share one environment
  FilterSpan span;            ///< of all objects' filters
  bool all_match = false;     ///< every two objects pass each other's filters
  /// Changes whenever a row gets another object or an object another filter.
  std::uint64_t arrangement = 0;
};

/// How a hit between query q and candidate c is reported.
enum class HitMode : std::uint8_t {
  unordered,     ///< (min, max); for regions that share no object
  query_first,   ///< (q, c)
  query_second,  ///< (c, q)
  moved,         ///< (min, max); queries are rows of the same pool: of two moved rows the lower one
                 ///< reports, and no row reports itself
};

/// Volumes to query with: rows of columns, by list or, if `rows` is null, consecutive. They are
/// boxes (lower ends, then upper ends) or volumes of the kind that the queried rows store.
struct QueryBatch {
  const float* column[26] = {};
  bool is_box = true;
  const std::uint32_t* id = nullptr;
  const std::uint32_t* rows = nullptr;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  HitMode mode = HitMode::unordered;
  const std::uint64_t* moved = nullptr;  ///< bit per row, for HitMode::moved
  FilterColumns filter;                  ///< of the queries: by row, or entry 0 for all
  bool one_filter = false;
  bool environments = false;  ///< false if all queries share one environment
  bool matches_all = false;   ///< every query passes the filters of every candidate
};

}  // namespace winnow
