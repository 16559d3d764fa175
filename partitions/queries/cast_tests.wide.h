#pragma once

// Tests of prepared casts (moving boxes) against the boxes of rows and nodes: 16 boxes in float
// (CastTest), one row in double (ExactCastTest), and a joint traversal of many casts
// (JointCasts). Used by casts.kernel.cpp and regions.kernel.cpp.

#include "partitions/queries/cast.kernel.h"
#include "partitions/queries/descent.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Covers the rounding of three operations on each side.
inline constexpr float kCastSlack = 1.0000006F;
/// Covers underflow, also if the caller flushes denormals to zero.
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
  explicit CastTest(const KernelCast& cast) : CastTest(cast, cast.from) {}
  /// Starts at a later scaled t.
  CastTest(const KernelCast& cast, float from) : cast_(cast), from_(from) {
    for (int i = 0; i < 3; ++i) {
      near_origin_[i] = Floats(cast.near_origin[i]);
      far_origin_[i] = Floats(cast.far_origin[i]);
      inverse_[i] = Floats(cast.inverse[i]);
    }
  }

  /// Returns the boxes among the 16 from `at` on that the cast may touch at a scaled t <= limit.
  /// For these, `enter` is a lower bound of t, at most kMaxOrder; for the others it is infinity.
  [[gnu::always_inline]] Mask16 test(const float* const* column, std::size_t at, float limit,
                                     Floats& enter) const {
    const float* const near[3] = {column[cast_.near_column[0]], column[cast_.near_column[1]],
                                  column[cast_.near_column[2]]};
    const float* const far[3] = {column[cast_.far_column[0]], column[cast_.far_column[1]],
                                 column[cast_.far_column[2]]};
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

/// Joint traversal of the trees with many casts, which must satisfy `same_octant`, so that the
/// columns to test are chosen once per loop.
///
/// `Hits` receives touched rows: `void touched(cast, t, id)`, and `bool make_room()` before at
/// most 128 of them, which returns false to end the traversal. A lowered limit only skips boxes
/// that are not tested yet; rows collected before are still passed on.
template <typename Hits>
class JointCasts {
 public:
  /// `from` and `limit` contain the first and the last t of each cast, scaled by KernelCast::scale.
  /// The functions of `hits` may lower a limit during the traversal.
  JointCasts(const QueryView& view, const KernelCast* casts, const float* from, const float* limit,
             const CandidateFilter& candidate_filter, Hits& hits)
      : view_(view),
        casts_(casts),
        from_(from),
        limit_(limit),
        candidate_filter_(candidate_filter),
        hits_(hits) {}

  /// Traces casts [0, count). Returns false if `make_room` ended the traversal.
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
  friend JointTraversal<JointCasts>;
  static constexpr unsigned kHitsAtOnce = 128;
  // Prefetch distance in tests. The six columns of a block are far apart in memory.
  static constexpr unsigned kAhead = 6;

  /// The columns of the ends that the casts reach first and last.
  struct EndColumns {
    const float* near[3];
    const float* far[3];

    EndColumns(const KernelCast& cast, const float* const* column) {
      for (int i = 0; i < 3; ++i) {
        near[i] = column[cast.near_column[i]];
        far[i] = column[cast.far_column[i]];
      }
    }
  };

  // always_inline: it makes up most of the loops that call it.
  [[nodiscard, gnu::always_inline]] Mask16 touching(const EndColumns& end_columns, std::uint32_t s,
                                                    std::size_t at) const {
    Floats enter;
    return CastTest(casts_[s], from_[s])
        .test(end_columns.near, end_columns.far, at, limit_[s], enter);
  }

  [[nodiscard]] EndColumns prepare(const TreeShape& tree, std::uint32_t level,
                                   std::uint32_t s) const {
    return EndColumns(casts_[s], tree.node[level]);
  }
  [[nodiscard]] Mask16 test(const EndColumns& end_columns, std::uint32_t s, std::uint32_t level,
                            std::uint32_t first_node) const {
    return candidate_filter_.nodes(*tree_, level, first_node, touching(end_columns, s, first_node));
  }

  bool visit(const QueryNodeList& blocks) {
    const EndColumns end_columns(casts_[blocks.query[0]], view_.column);
    for (unsigned k = 0; k < blocks.size; ++k) {
      const std::uint32_t first_row = (tree_->first_block + blocks.at[k]) * kLanes;
      if (rows_.full() && !touch_rows()) return false;
      __builtin_prefetch(view_.id + first_row);
      if (k + kAhead < blocks.size) fetch(blocks.at[k + kAhead]);
      const Mask16 mask = touching(end_columns, blocks.query[k], first_row);
      rows_.add(blocks.query[k], first_row, candidate_filter_.rows(first_row, mask));
    }
    return true;
  }

  void fetch(std::uint32_t block) const {
    const std::size_t at = std::size_t{tree_->first_block + block} * kLanes;
    for (int c = 0; c < 6; ++c) __builtin_prefetch(view_.column[c] + at);
  }

  bool test_flat(std::uint32_t s, std::uint32_t first_row) {
    if (rows_.full() && !touch_rows()) return false;
    const Mask16 mask = touching(EndColumns(casts_[s], view_.column), s, first_row);
    if (mask != 0) rows_.add(s, first_row, candidate_filter_.rows(first_row, mask));
    return true;
  }

  bool touch_rows() {
    const ExactCastTest exact(casts_[0], view_.column);
    for (unsigned k = 0; k < rows_.size; ++k) {
      if (k % kHitsAtOnce == 0 && !hits_.make_room()) return false;
      const std::uint32_t s = rows_.query[k];
      const std::uint32_t row = rows_.at[k];
      const double t = exact.touch(casts_[s], row);
      if (t >= 0.0) hits_.touched(s, t, view_.id[row]);
    }
    rows_.size = 0;
    return true;
  }

  const QueryView& view_;
  const TreeShape* tree_ = nullptr;
  const KernelCast* casts_;
  const float* from_;
  const float* limit_;
  const CandidateFilter& candidate_filter_;
  Hits& hits_;
  JointTraversal<JointCasts> traversal_{*this};
  QueryNodeList rows_;
};

}  // namespace winnow::WINNOW_ISA_NAME
