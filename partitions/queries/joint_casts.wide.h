#pragma once

// Many casts that traverse the trees together. casts.kernel.cpp uses it for batches of rays and for
// all hits.

#include "partitions/queries/cast_tests.wide.h"

namespace winnow::WINNOW_ISA_NAME {

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
        .test_ends(end_columns.near, end_columns.far, at, limit_[s], enter);
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
