#pragma once

// Tests of prepared casts (moving boxes) against the boxes of rows and nodes: 16 boxes in float
// (CastTest), and one row in double (ExactCastTest). Used by the kernels of casts and regions.

#include "partitions/queries/cast.kernel.h"
#include "partitions/queries/descent.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// 1 + 10 * 2^-24. Covers the rounding of three operations on each side, of the product with this
/// factor, and of the sum with kCastTiny.
inline constexpr float kCastSlack = 1.0000006F;
/// Covers underflow.
inline constexpr float kCastTiny = 1e-37F;

/// Returns an upper bound of the scaled float t of any hit at or before t.
inline float scaled_limit(const KernelCast& cast, double t) {
  const double scaled = t * cast.scale * static_cast<double>(kCastSlack) + 2e-37;
  // Converting a value beyond float is undefined; infinity replaces it.
  return scaled < 3e38 ? static_cast<float>(scaled) * kCastSlack : __builtin_inff();
}

/// Float test of 16 boxes against one cast.
class CastTest {
 public:
  explicit CastTest(const KernelCast& cast) : CastTest(cast, cast.scaled_from) {}
  /// Starts at a later scaled t.
  CastTest(const KernelCast& cast, float from) : cast_(cast), from_(from) {
    for (int i = 0; i < 3; ++i) {
      near_origin_[i] = Floats(cast.near_origin[i]);
      far_origin_[i] = Floats(cast.far_origin[i]);
      inverse_[i] = Floats(cast.inverse[i]);
    }
  }

  /// Returns the boxes among the 16 from `at` on that the cast may touch at a scaled t <= limit.
  /// For these, `enter` is a lower bound of scaled t, at most kMaxOrder; for the others it is
  /// infinity.
  [[gnu::always_inline]] Mask16 test(const float* const* column, std::size_t at, float limit,
                                     Floats& enter) const {
    const float* const near[3] = {column[cast_.near_column[0]], column[cast_.near_column[1]],
                                  column[cast_.near_column[2]]};
    const float* const far[3] = {column[cast_.far_column[0]], column[cast_.far_column[1]],
                                 column[cast_.far_column[2]]};
    return test_ends(near, far, at, limit, enter);
  }
  /// As above without `enter`.
  [[gnu::always_inline]] Mask16 test(const float* const* column, std::size_t at,
                                     float limit) const {
    Floats enter;
    return test(column, at, limit, enter);
  }
  /// As above for given columns of the ends that are reached first and last.
  [[gnu::always_inline]] Mask16 test_ends(const float* const* near, const float* const* far,
                                          std::size_t at, float limit, Floats& enter) const {
    Floats e[3];
    Floats x[3];
    for (int i = 0; i < 3; ++i) {
      e[i] = time(near[i] + at, near_origin_[i], inverse_[i]);
      x[i] = time(far[i] + at, far_origin_[i], inverse_[i]);
    }
    enter = max(max(e[0], e[1]), max(e[2], from_));
    const Floats exit = min(min(x[0], x[1]), x[2]);
    const Floats late = exit * kCastSlack + kCastTiny;
    // `limit` is the first operand: if padding makes `late` NaN, `last` is NaN and the box fails.
    const Floats last = min(Floats(limit), late);
    const Mask16 touched = bits(enter <= last);
    enter = or_infinity(enter <= last, min(enter, kMaxOrder));
    return touched;
  }

 private:
  static Floats time(const float* end, const Floats& origin, const Floats& inverse) {
    return (Floats::load(end) - origin) * inverse;
  }

  const KernelCast& cast_;
  Floats near_origin_[3];
  Floats far_origin_[3];
  Floats inverse_[3];
  Floats from_;
};

/// Test of single rows in double. Entry and exit take three operations each: their relative error
/// is below 4e-16.
class ExactCastTest {
 public:
  /// Is also valid for other casts that satisfy `same_octant` with this one.
  ExactCastTest(const KernelCast& cast, const float* const* column) : column_(column) {
    for (int i = 0; i < 3; ++i) {
      near_[i] = column[cast.exact_near_column[i]];
      far_[i] = column[(cast.exact_near_column[i] + 3) % 6];
    }
  }

  /// Returns the first t at which the cast touches the box of row r, or a negative number.
  [[nodiscard]] double touch(const KernelCast& cast, std::size_t r) const {
    double enter = cast.min_t;
    double exit = cast.max_t;
    for (int i = 0; i < 3; ++i) {
      const double near = static_cast<double>(near_[i][r]) - cast.exact_near_origin[i];
      const double far = static_cast<double>(far_[i][r]) - cast.exact_far_origin[i];
      // On an axis without motion these are infinite, or NaN if ends touch. The comparisons then
      // keep the previous value.
      const double e = near * cast.exact_inverse[i];
      const double x = far * cast.exact_inverse[i];
      enter = e > enter ? e : enter;
      exit = x < exit ? x : exit;
    }
    if (!(enter <= exit * (1.0 + 1e-15) && enter < __builtin_inf())) return -1.0;
    enter = enter < cast.max_t ? enter : cast.max_t;
    if (cast.touch == nullptr) return enter;
    const float box[6] = {column_[0][r], column_[1][r], column_[2][r],
                          column_[3][r], column_[4][r], column_[5][r]};
    return cast.touch(cast.shape, box, enter);
  }

 private:
  const float* const* column_;
  const float* near_[3];
  const float* far_[3];
};

}  // namespace winnow::WINNOW_ISA_NAME
