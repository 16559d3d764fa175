#pragma once

#include "core/memory/filter_columns.h"
#include "partitions/rows/filter_span.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Where kernels write pairs of object ids: a plain struct, because kernel files may not use the
/// standard library. While cursor <= limit there is room for kSinkSlack pairs; past the limit the
/// kernel calls `grow`, and stops if that says false.
struct PairSink {
  std::uint32_t* cursor = nullptr;
  std::uint32_t* limit = nullptr;
  bool (*grow)(PairSink& sink) = nullptr;
  void* owner = nullptr;
  std::uint64_t tests = 0;  ///< tests of 16 volumes, counted by the kernels
};

/// One block against another, and one more full store.
inline constexpr std::size_t kSinkSlack = 16 * 16 + 16;

/// Columns that kernels test: pointers into a BoundsPool. The first six are the box; a k-DOP's
/// further slabs follow (lower ends, then upper ends), or a sphere's centre and radius.
struct RowView {
  const float* column[26] = {};
  std::uint32_t further_slabs = 0;
  bool spheres = false;
  const std::uint32_t* id = nullptr;
  FilterColumns filter;       ///< by row; in no layer where there is no object
  bool environments = false;  ///< or false if all share one
  FilterSpan span;            ///< of all objects' filters
  bool all_meet = false;      ///< all objects are known to meet each other
  /// Another number than before once a row has got another object, or an object another filter.
  std::uint64_t arrangement = 0;
};

/// What becomes of a hit between query q and candidate c.
enum class HitMode : std::uint8_t {
  unordered,     ///< report (min, max); for regions that share no object
  query_first,   ///< report (q, c)
  query_second,  ///< report (c, q)
  moved,         ///< report (min, max); rows ask about their own pool: of two rows that both
                 ///< moved only the one in front reports, and no row reports itself
};

/// Volumes to ask about: rows of columns, by list or, if `rows` is null, one after another. They
/// are boxes (lower ends, then upper ends), or volumes of the kind that the asked rows hold.
struct QueryBatch {
  const float* column[26] = {};
  bool is_box = true;
  const std::uint32_t* id = nullptr;
  const std::uint32_t* rows = nullptr;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  HitMode mode = HitMode::unordered;
  const std::uint64_t* moved = nullptr;  ///< bit per row, for HitMode::moved
  FilterColumns filter;                  ///< of those who ask, by row, or in entry 0 one for all
  bool one_filter = false;
  bool environments = false;  ///< or false if all who ask share one
  bool meets_all = false;     ///< whoever asks is known to meet every object that is asked about
};

}  // namespace winnow
