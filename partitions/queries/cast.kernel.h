#pragma once

#include "partitions/index/query_view.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// A box that moves along a line, against boxes [low, high]: they touch during an interval of t per
/// axis, ended by (near - origin) / d and (far - origin) / d, where near is the end of the box that
/// is met first, and origin the end of the moving box that meets it. A ray is a box without extent.
///
/// The tests of 16 boxes are in float and never miss; what they let pass is decided in double. For
/// them t is scaled by a power of two that brings the largest component of the direction into
/// [1/2, 1), so that no product underflows by more than the tests allow for. On an axis without
/// motion the reciprocal is infinite and the origins are moved outward by one float, so that
/// 0 * infinity comes up only where there is no hit. An axis whose motion is too slow for a float
/// reciprocal repeats the fastest axis instead: only the test in double looks at it.
struct Sweep {
  float near_origin[3];
  float far_origin[3];
  float inverse[3];
  std::uint8_t near_column[3];
  std::uint8_t far_column[3];
  float from;  ///< scaled min_t, rounded down
  double scale;

  double exact_near_origin[3];
  double exact_far_origin[3];
  double exact_inverse[3];
  std::uint8_t exact_near_column[3];
  double min_t;
  double max_t;

  /// Goes on where the boxes touch, for shapes that are not boxes: the first t >= from at which the
  /// shape touches the box (six floats), or a negative number.
  double (*touch)(const void* shape, const float* box, double from) = nullptr;
  const void* shape = nullptr;
};

/// Sweeps that go down the trees together at most; all must go the same way.
inline constexpr std::uint32_t kMostSweeps = 64;

/// True if two sweeps meet the same columns of boxes first.
static inline bool same_way(const Sweep& a, const Sweep& b) {
  bool same = true;
  for (int i = 0; i < 3; ++i) {
    same = same && a.near_column[i] == b.near_column[i] && a.far_column[i] == b.far_column[i] &&
           a.exact_near_column[i] == b.exact_near_column[i];
  }
  return same;
}

/// Results that are sorted together at most.
inline constexpr std::uint32_t kMostSorted = 64;

/// The result of a sweep that hits nothing.
inline constexpr std::uint64_t kNoHit = ~std::uint64_t{0};

/// Results are t's bits << 32 | id, which sorts by t and then by id, since t >= 0.
struct CastKernels {
  /// For each of `count` <= kMostSweeps sweeps the least hit.
  void (*closest)(const QueryView&, const Sweep*, std::uint32_t count, const QueryFilter&,
                  std::uint64_t* best);
  /// For each of `count` sweeps any hit.
  void (*any)(const QueryView&, const Sweep*, std::uint32_t count, const QueryFilter&,
              std::uint64_t* found);
  /// All hits of `count` <= kMostSweeps sweeps, in no order: two pairs each, (question of the
  /// sweep, id) and (bits of t, 0). False if the sink is full.
  bool (*all)(const QueryView&, const Sweep*, std::uint32_t count, const std::uint32_t* question,
              const QueryFilter&, PairSink&);
  /// Sorts at most kMostSorted results.
  void (*sort_few)(std::uint64_t* results, std::uint32_t size);
};

WINNOW_KERNELS(CastKernels, cast_kernels);

}  // namespace winnow
