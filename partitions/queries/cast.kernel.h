#pragma once

#include "partitions/index/query_view.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// A cast prepared for the kernels: a box that moves along a line, tested against boxes by the slab
/// method (Kay, Kajiya 1986). On each axis the boxes overlap while t is between (near -
/// near_origin) / d and (far - far_origin) / d. `near` is the end of the tested box that the moving
/// box reaches first, `far` is the other end, and the origins are ends of the moving box. A ray is
/// a box of zero extent.
///
/// The float tests of 16 boxes never miss a hit; a test in double, with the members exact_*,
/// decides on the rows that pass. Three rules hold for the values of the float tests:
/// - They scale t by a power of two, so that the largest component of the direction is in [1/2, 1)
///   and underflow stays within the slack of the tests.
/// - On an axis without motion the reciprocal is infinite, and the origins are moved outward by one
///   float, so that 0 * infinity occurs only without a hit.
/// - A slow axis, whose motion is too slow for a float reciprocal, has the values of the fastest
///   axis; only the test in double tests it.
struct KernelCast {
  float near_origin[3];
  float far_origin[3];
  float inverse[3];
  std::uint8_t near_column[3];
  std::uint8_t far_column[3];
  float scaled_from;  ///< scaled min_t, rounded down
  double scale;

  double exact_near_origin[3];
  double exact_far_origin[3];
  double exact_inverse[3];
  std::uint8_t exact_near_column[3];  ///< near_column, except on slow axes
  double min_t;
  double max_t;

  /// For shapes that are not boxes, called for rows whose box the bounding box touches: returns the
  /// first t >= `from` at which the shape touches the box (six floats), or a negative number.
  double (*touch)(const void* shape, const float* box, double from) = nullptr;
  const void* shape = nullptr;
};

/// Largest number of casts in one joint traversal. Their directions must satisfy `same_octant`.
inline constexpr std::uint32_t kMaxCasts = 64;

/// True if two casts reach the same columns of boxes first, so that one choice of columns serves
/// both.
static inline bool same_octant(const KernelCast& a, const KernelCast& b) {
  bool same = true;
  for (int i = 0; i < 3; ++i) {
    same = same && a.near_column[i] == b.near_column[i] && a.far_column[i] == b.far_column[i] &&
           a.exact_near_column[i] == b.exact_near_column[i];
  }
  return same;
}

/// Largest number of results that sort_few sorts.
inline constexpr std::uint32_t kMaxSorted = 64;

/// Result of a cast without a hit.
inline constexpr std::uint64_t kNoHit = ~std::uint64_t{0};

/// A result is (bits of t) << 32 | id. Because t >= 0, integers sort by t, then by id.
struct CastKernels {
  /// Finds the least hit of each of `count` <= kMaxCasts casts.
  void (*closest)(const QueryView&, const KernelCast*, std::uint32_t count, const QueryFilter&,
                  std::uint64_t* best);
  /// Finds any hit of each of `count` <= kMaxCasts casts.
  void (*any)(const QueryView&, const KernelCast*, std::uint32_t count, const QueryFilter&,
              std::uint64_t* found);
  /// Finds all hits of `count` <= kMaxCasts casts, unsorted. Writes two pairs per hit:
  /// (query[i], id) and (bits of t, 0) for a hit of cast i. False if the sink is full.
  bool (*all)(const QueryView&, const KernelCast*, std::uint32_t count, const std::uint32_t* query,
              const QueryFilter&, PairSink&);
  /// Sorts at most kMaxSorted results.
  void (*sort_few)(std::uint64_t* results, std::uint32_t size);
};

WINNOW_KERNELS(CastKernels, cast_kernels);

}  // namespace winnow
