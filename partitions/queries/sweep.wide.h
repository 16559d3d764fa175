#pragma once

// Tests of sweeps (moving boxes) against the boxes of rows and nodes: 16 boxes in float
// (SweepTest), one row in double (ExactSweepTest), and a joint traversal of many sweeps
// (JointSweeps). Used by casts.kernel.cpp and regions.kernel.cpp.

#include "partitions/queries/cast.kernel.h"
#include "partitions/queries/descent.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Covers the rounding of three operations on each side.
inline constexpr float kSweepSlack = 1.0000006F;
/// Covers underflow, also if the caller flushes denormals to zero.
inline constexpr float kSweepTiny = 1e-37F;

/// Returns an upper bound of the scaled float t of any hit at or before t.
inline float scaled_limit(const KernelCast& sweep, double t) {
  const double scaled = t * sweep.scale * static_cast<double>(kSweepSlack) + 2e-37;
  // Converting a value beyond float is undefined; infinity replaces it.
  return scaled < 3e38 ? static_cast<float>(scaled) * kSweepSlack : __builtin_inff();
}

/// Float test of 16 boxes against one sweep.
class SweepTest {
 public:
  explicit SweepTest(const KernelCast& sweep) : SweepTest(sweep, sweep.from) {}
  /// Starts at a later scaled t.
  SweepTest(const KernelCast& sweep, float from) : sweep_(sweep), from_(from) {
    for (int i = 0; i < 3; ++i) {
      near_origin_[i] = Floats(sweep.near_origin[i]);
      far_origin_[i] = Floats(sweep.far_origin[i]);
      inverse_[i] = Floats(sweep.inverse[i]);
    }
  }

  /// Returns the boxes among the 16 from `at` on that the sweep may touch at a scaled t <= limit.
  /// For these, `enter` is a lower bound of t, at most kMaxOrder; for the others it is infinity.
  [[gnu::always_inline]] Mask16 test(const float* const* column, std::size_t at, float limit,
                                     Floats& enter) const {
    const float* const near[3] = {column[sweep_.near_column[0]], column[sweep_.near_column[1]],
                                  column[sweep_.near_column[2]]};
    const float* const far[3] = {column[sweep_.far_column[0]], column[sweep_.far_column[1]],
                                 column[sweep_.far_column[2]]};
    return test(near, far, at, limit, enter);
  }
  /// As above without `enter`.
  Mask16 test(const float* const* column, std::size_t at, float limit) const {
    Floats enter;
    return test(column, at, limit, enter);
  }
  /// As above for given columns of the ends that are reached first and last.
  [[gnu::always_inline]] Mask16 test(const float* const* near, const float* const* far,
                                     std::size_t at, float limit, Floats& enter) const {
    Floats e[3];
    Floats x[3];
    for (int i = 0; i < 3; ++i) {
      e[i] = time(near[i] + at, near_origin_[i], inverse_[i]);
      x[i] = time(far[i] + at, far_origin_[i], inverse_[i]);
    }
    enter = max(max(e[0], e[1]), max(e[2], from_));
    const Floats exit = min(min(x[0], x[1]), x[2]);
    const Floats late = exit * kSweepSlack + kSweepTiny;
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

  const KernelCast& sweep_;
  Floats near_origin_[3];
  Floats far_origin_[3];
  Floats inverse_[3];
  Floats from_;
};

/// Test of single rows in double. Entry and exit take three operations each: their relative error
/// is below 4e-16.
class ExactSweepTest {
 public:
  /// Also serves other sweeps that satisfy `same_octant` with this one.
  ExactSweepTest(const KernelCast& sweep, const float* const* column) : column_(column) {
    for (int i = 0; i < 3; ++i) {
      near_[i] = column[sweep.exact_near_column[i]];
      far_[i] = column[(sweep.exact_near_column[i] + 3) % 6];
    }
  }

  /// Returns the first t at which the sweep touches the box of row r, or a negative number.
  [[nodiscard]] double touch(const KernelCast& sweep, std::size_t r) const {
    double enter = sweep.min_t;
    double exit = sweep.max_t;
    for (int i = 0; i < 3; ++i) {
      const double near = static_cast<double>(near_[i][r]) - sweep.exact_near_origin[i];
      const double far = static_cast<double>(far_[i][r]) - sweep.exact_far_origin[i];
      // On an axis without motion these are infinite, or NaN if ends touch. The comparisons then
      // keep the previous value.
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

/// Joint traversal of the trees with many sweeps, which must satisfy `same_octant`, so that the
/// columns to test are chosen once per loop.
///
/// `Hits` receives touched rows: `void touched(sweep, t, id)`, and `bool make_room()` before at
/// most 128 of them, which returns false to end the traversal. A lowered limit only skips boxes
/// that are not tested yet; rows collected before are still passed on.
template <typename Hits>
class JointSweeps {
 public:
  /// `from` and `limit` are the scaled interval of each sweep; `hits` may lower limits.
  JointSweeps(const QueryView& view, const KernelCast* sweeps, const float* from,
              const float* limit, const CandidateFilter& wanted, Hits& hits)
      : view_(view), sweeps_(sweeps), from_(from), limit_(limit), wanted_(wanted), hits_(hits) {}

  /// Traces sweeps [0, count).
  bool run(std::uint32_t count) {
    for (std::uint32_t t = 0; t < view_.trees; ++t) {
      tree_ = view_.tree[t];
      if (!traversal_.run(*tree_, count, [](std::uint32_t s) { return s; })) return false;
    }
    for (std::uint32_t block = 0; block < view_.flat_blocks; ++block) {
      for (std::uint32_t s = 0; s < count; ++s) {
        if (!test_flat(s, block * kLanes)) return false;
      }
    }
    return touch_rows();
  }

 private:
  friend JointTraversal<JointSweeps>;
  static constexpr unsigned kHitsAtOnce = 128;
  // Prefetch distance in tests. The six columns of a block are far apart in memory.
  static constexpr unsigned kAhead = 6;

  /// The columns of the ends that the sweeps reach first and last.
  struct Ways {
    const float* near[3];
    const float* far[3];

    Ways(const KernelCast& sweep, const float* const* column) {
      for (int i = 0; i < 3; ++i) {
        near[i] = column[sweep.near_column[i]];
        far[i] = column[sweep.far_column[i]];
      }
    }
  };

  // always_inline: it makes up most of the loops that call it.
  [[nodiscard, gnu::always_inline]] Mask16 touching(const Ways& ways, std::uint32_t s,
                                                    std::size_t at) const {
    Floats enter;
    return SweepTest(sweeps_[s], from_[s]).test(ways.near, ways.far, at, limit_[s], enter);
  }

  [[nodiscard]] Ways prepare(const TreeShape& tree, std::uint32_t level, std::uint32_t s) const {
    return Ways(sweeps_[s], tree.node[level]);
  }
  [[nodiscard]] Mask16 test(const Ways& ways, std::uint32_t s, std::uint32_t level,
                            std::uint32_t first_node) const {
    return wanted_.nodes(*tree_, level, first_node, touching(ways, s, first_node));
  }

  bool visit(const QueryNodeList& blocks) {
    const Ways ways(sweeps_[blocks.query[0]], view_.column);
    for (unsigned k = 0; k < blocks.size; ++k) {
      const std::uint32_t first_row = (tree_->first_block + blocks.at[k]) * kLanes;
      if (rows_.full() && !touch_rows()) return false;
      __builtin_prefetch(view_.id + first_row);
      if (k + kAhead < blocks.size) fetch(blocks.at[k + kAhead]);
      const Mask16 mask = touching(ways, blocks.query[k], first_row);
      rows_.add(blocks.query[k], first_row, wanted_.rows(first_row, mask));
    }
    return true;
  }

  void fetch(std::uint32_t block) const {
    const std::size_t at = std::size_t{tree_->first_block + block} * kLanes;
    for (int c = 0; c < 6; ++c) __builtin_prefetch(view_.column[c] + at);
  }

  bool test_flat(std::uint32_t s, std::uint32_t first_row) {
    if (rows_.full() && !touch_rows()) return false;
    const Mask16 mask = touching(Ways(sweeps_[s], view_.column), s, first_row);
    if (mask != 0) rows_.add(s, first_row, wanted_.rows(first_row, mask));
    return true;
  }

  bool touch_rows() {
    const ExactSweepTest exact(sweeps_[0], view_.column);
    for (unsigned k = 0; k < rows_.size; ++k) {
      if (k % kHitsAtOnce == 0 && !hits_.make_room()) return false;
      const std::uint32_t s = rows_.query[k];
      const std::uint32_t row = rows_.at[k];
      const double t = exact.touch(sweeps_[s], row);
      if (t >= 0.0) hits_.touched(s, t, view_.id[row]);
    }
    rows_.size = 0;
    return true;
  }

  const QueryView& view_;
  const TreeShape* tree_ = nullptr;
  const KernelCast* sweeps_;
  const float* from_;
  const float* limit_;
  const CandidateFilter& wanted_;
  Hits& hits_;
  JointTraversal<JointSweeps> traversal_{*this};
  QueryNodeList rows_;
};

}  // namespace winnow::WINNOW_ISA_NAME
