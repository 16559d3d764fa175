#pragma once

#include "partitions/queries/sweep.wide.h"
#include "partitions/queries/walks.wide.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// Walks many sweeps down the trees together, a level at a time: what is open on a level waits in
/// that level's list, and a list is worked off in one long loop. How many children a node passes on
/// is as hard to foresee as a coin, and each test takes long from its first load to its last bit;
/// here neither is waited for. Nothing is visited in order: what is to be left out must lie beyond
/// a sweep's limit from the start. All sweeps go the same way (`same_way`), so that which columns
/// they meet first is settled once a loop.
///
/// `Hits` takes what is touched: `void touched(sweep, t, id)`, and `bool make_room()` before 128 of
/// them at most, which returns false to end the walk.
template <typename Hits>
class SweepRounds {
 public:
  /// `from` and `limit` are the scaled interval of each sweep; `hits` may lower a limit.
  SweepRounds(const QueryView& view, const Sweep* sweeps, const float* from, const float* limit,
              const Wanted& wanted, Hits& hits)
      : view_(view), sweeps_(sweeps), from_(from), limit_(limit), wanted_(wanted), hits_(hits) {}

  /// Sweeps [0, count), or those of a list.
  bool run(const std::uint32_t* list, std::uint32_t count) {
    for (std::uint32_t t = 0; t < view_.trees; ++t) {
      tree_ = view_.tree[t];
      const std::uint32_t top = tree_->levels - 1;
      const Ways ways(sweeps_[0], tree_->node[top]);
      for (std::uint32_t k = 0; k < count; ++k) {
        if (!test_nodes(list != nullptr ? list[k] : k, ways, top, 0)) return false;
      }
      for (std::uint32_t level = top + 1; level-- > 0;) {
        if (!drain(level)) return false;
      }
    }
    for (std::uint32_t block = 0; block < view_.flat_blocks; ++block) {
      for (std::uint32_t k = 0; k < count; ++k) {
        if (!test_flat(list != nullptr ? list[k] : k, block * kLanes)) return false;
      }
    }
    return touch_rows();
  }

 private:
  static constexpr unsigned kRoom = 256;
  static constexpr unsigned kHitsAtOnce = 128;

  struct Open {
    unsigned size = 0;
    std::uint32_t sweep[kRoom + kLanes];
    std::uint32_t at[kRoom + kLanes];

    [[nodiscard]] bool full() const { return size > kRoom - kLanes; }
    void add(std::uint32_t s, std::uint32_t base, Mask16 mask) {
      Uints(s).store_unaligned(sweep + size);
      size += compress_store(mask, count_from(base), at + size);
    }
  };

  /// The columns that all sweeps meet first, and last.
  struct Ways {
    const float* near[3];
    const float* far[3];

    Ways(const Sweep& sweep, const float* const* column) {
      for (int i = 0; i < 3; ++i) {
        near[i] = column[sweep.near_column[i]];
        far[i] = column[sweep.far_column[i]];
      }
    }
  };

  [[nodiscard]] Mask16 test(std::uint32_t s, const Ways& ways, std::size_t at) const {
    Floats enter;
    return SweepTest(sweeps_[s], from_[s]).test(ways.near, ways.far, at, limit_[s], enter);
  }

  bool test_nodes(std::uint32_t s, const Ways& ways, std::uint32_t level,
                  std::uint32_t first_node) {
    if (open_[level].full() && !drain(level)) return false;
    const Mask16 mask = test(s, ways, first_node);
    open_[level].add(s, first_node, wanted_.nodes(*tree_, level, first_node, mask));
    return true;
  }

  bool drain(std::uint32_t level) {
    Open& open = open_[level];
    if (open.size == 0) return true;
    if (level == 0) {
      if (!drain_blocks(open)) return false;
    } else {
      const Ways ways(sweeps_[open.sweep[0]], tree_->node[level - 1]);
      for (unsigned k = 0; k < open.size; ++k) {
        if (!test_nodes(open.sweep[k], ways, level - 1, open.at[k] * kLanes)) return false;
      }
    }
    open.size = 0;
    return true;
  }

  bool drain_blocks(const Open& open) {
    const Ways ways(sweeps_[open.sweep[0]], view_.column);
    for (unsigned k = 0; k < open.size; ++k) {
      const std::uint32_t first_row = (tree_->first_block + open.at[k]) * kLanes;
      if (rows_.full() && !touch_rows()) return false;
      __builtin_prefetch(view_.id + first_row);
      const Mask16 mask = test(open.sweep[k], ways, first_row);
      rows_.add(open.sweep[k], first_row, wanted_.rows(first_row, mask));
    }
    return true;
  }

  bool test_flat(std::uint32_t s, std::uint32_t first_row) {
    if (rows_.full() && !touch_rows()) return false;
    const Mask16 mask = test(s, Ways(sweeps_[s], view_.column), first_row);
    rows_.add(s, first_row, wanted_.rows(first_row, mask));
    return true;
  }

  bool touch_rows() {
    const ExactSweepTest exact(sweeps_[0], view_.column);
    for (unsigned k = 0; k < rows_.size; ++k) {
      if (k % kHitsAtOnce == 0 && !hits_.make_room()) return false;
      const std::uint32_t s = rows_.sweep[k];
      const std::uint32_t row = rows_.at[k];
      const double t = exact.touch(sweeps_[s], row);
      if (t >= 0.0) hits_.touched(s, t, view_.id[row]);
    }
    rows_.size = 0;
    return true;
  }

  const QueryView& view_;
  const TreeView* tree_ = nullptr;
  const Sweep* sweeps_;
  const float* from_;
  const float* limit_;
  const Wanted& wanted_;
  Hits& hits_;
  Open open_[kMaxTreeLevels];
  Open rows_;
};

}  // namespace winnow::WINNOW_ISA_NAME
