#pragma once

#include "partitions/queries/cast.kernel.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Rounding of three operations on either side, and more.
inline constexpr float kSweepSlack = 1.0000006F;
/// What denormal results can lose, also where the caller flushes them to zero.
inline constexpr float kSweepTiny = 1e-37F;

/// The largest scaled t that a hit at or before t can show in float.
inline float scaled_limit(const Sweep& sweep, double t) {
  const double scaled = t * sweep.scale * static_cast<double>(kSweepSlack) + 2e-37;
  // Conversion of what is beyond float is undefined; infinity stands for it.
  return scaled < 3e38 ? static_cast<float>(scaled) * kSweepSlack : __builtin_inff();
}

/// Sixteen boxes against one sweep.
class SweepTest {
 public:
  explicit SweepTest(const Sweep& sweep) : SweepTest(sweep, sweep.from) {}
  /// From a later scaled t on.
  SweepTest(const Sweep& sweep, float from) : sweep_(sweep), from_(from) {
    for (int i = 0; i < 3; ++i) {
      near_origin_[i] = Floats(sweep.near_origin[i]);
      far_origin_[i] = Floats(sweep.far_origin[i]);
      inverse_[i] = Floats(sweep.inverse[i]);
    }
  }

  /// Which of the boxes from `at` on may be touched at a scaled t <= limit, and when at the
  /// earliest; infinity for the others.
  Mask16 test(const float* const* column, std::size_t at, float limit, Floats& enter) const {
    const float* const near[3] = {column[sweep_.near_column[0]], column[sweep_.near_column[1]],
                                  column[sweep_.near_column[2]]};
    const float* const far[3] = {column[sweep_.far_column[0]], column[sweep_.far_column[1]],
                                 column[sweep_.far_column[2]]};
    return test(near, far, at, limit, enter);
  }
  /// The same where the columns that are met first and last are known.
  Mask16 test(const float* const* near, const float* const* far, std::size_t at, float limit,
              Floats& enter) const {
    Floats e[3];
    Floats x[3];
    for (int i = 0; i < 3; ++i) {
      e[i] = time(near[i] + at, near_origin_[i], inverse_[i]);
      x[i] = time(far[i] + at, far_origin_[i], inverse_[i]);
    }
    enter = max(max(e[0], e[1]), max(e[2], from_));
    const Floats exit = min(min(x[0], x[1]), x[2]);
    const Floats late = exit * kSweepSlack + kSweepTiny;
    // The limit first: what is not a number, as padding can make, must not become the limit.
    const Floats last = min(Floats(limit), late);
    const Mask16 touched = bits(enter <= last);
    enter = or_infinity(enter <= last, enter);
    return touched;
  }

 private:
  static Floats time(const float* end, const Floats& origin, const Floats& inverse) {
    return (Floats::load(end) - origin) * inverse;
  }

  const Sweep& sweep_;
  Floats near_origin_[3];
  Floats far_origin_[3];
  Floats inverse_[3];
  Floats from_;
};

/// Decides on single rows. In double: of three operations each, entry and exit are off by less than
/// 4e-16 of themselves.
class ExactSweepTest {
 public:
  /// For sweeps that go the same way as this one.
  ExactSweepTest(const Sweep& sweep, const float* const* column) : column_(column) {
    for (int i = 0; i < 3; ++i) {
      near_[i] = column[sweep.exact_near_column[i]];
      far_[i] = column[(sweep.exact_near_column[i] + 3) % 6];
    }
  }

  /// The first t at which the sweep touches the box of row r, or a negative number.
  [[nodiscard]] double touch(const Sweep& sweep, std::size_t r) const {
    double enter = sweep.min_t;
    double exit = sweep.max_t;
    for (int i = 0; i < 3; ++i) {
      const double near = static_cast<double>(near_[i][r]) - sweep.exact_near_origin[i];
      const double far = static_cast<double>(far_[i][r]) - sweep.exact_far_origin[i];
      // On an axis without motion these are infinite, or not numbers where ends touch: then the
      // comparisons keep what there was.
      const double e = near * sweep.exact_inverse[i];
      const double x = far * sweep.exact_inverse[i];
      enter = e > enter ? e : enter;
      exit = x < exit ? x : exit;
    }
    if (!(enter <= exit * (1.0 + 1e-15) && enter < __builtin_inf())) return -1.0;
    enter = enter < sweep.max_t ? enter : sweep.max_t;
    if (sweep.touch == nullptr) return enter;
    const float box[6] = {column_[0][r], column_[1][r], column_[2][r],
                          column_[3][r], column_[4][r], column_[5][r]};
    return sweep.touch(sweep.shape, box, enter);
  }

 private:
  const float* const* column_;
  const float* near_[3];
  const float* far_[3];
};

}  // namespace winnow::WINNOW_ISA_NAME
