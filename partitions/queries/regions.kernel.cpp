#include "partitions/pairs/hits.wide.h"
#include "partitions/queries/region.kernel.h"
#include "partitions/queries/region_probes.wide.h"
#include "partitions/queries/walks.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

template <typename Probe>
class RegionWalk {
 public:
  RegionWalk(const QueryView& view, const Probe& probe, const QueryFilter& filter,
             RegionSinks& sinks)
      : view_(view),
        probe_(probe),
        wanted_(view, filter),
        chosen_(filter.accept != nullptr),
        sinks_(sinks) {}

  bool run() {
    if (!scan_flat()) return false;
    for (std::uint32_t t = 0; t < view_.trees; ++t) {
      if (!walk_tree(*view_.tree[t])) return false;
    }
    return true;
  }

 private:
  bool scan_flat() {
    if constexpr (requires { probe_.is_frustum(); }) {
      if (view_.flat_blocks != 0 && probe_.is_frustum()) {
        const FrustumScan scan(probe_.region(), view_.column);
        for (std::uint32_t begin = 0; begin < view_.flat_blocks; begin += kScanned) {
          if (!scan_some(scan, begin)) return false;
        }
        return true;
      }
    }
    for (std::uint32_t block = 0; block < view_.flat_blocks; ++block) {
      if (!test_rows(block * kLanes)) return false;
    }
    return true;
  }

  /// Notes the blocks that pass without a branch, and looks at them after that.
  template <typename Scan>
  bool scan_some(const Scan& scan, std::uint32_t begin) {
    std::uint32_t passed[kScanned];
    unsigned count = 0;
    const std::uint32_t left = view_.flat_blocks - begin;
    for (std::uint32_t i = 0; i < (left < kScanned ? left : kScanned); ++i) {
      passed[count] = (begin + i) * kLanes;
      count += scan.may_meet(passed[count]) ? 1U : 0U;
    }
    for (unsigned i = 0; i < count; ++i) {
      if (!test_rows(passed[i])) return false;
    }
    return true;
  }

  bool walk_tree(const TreeView& tree) {
    Met open[kMaxTreeLevels];
    std::uint32_t base[kMaxTreeLevels];
    std::uint32_t level = tree.levels - 1;
    const auto enter = [&](std::uint32_t first_node) {
      open[level] = probe_.test(tree.node[level], first_node);
      open[level].met = wanted_.nodes(tree, level, first_node, open[level].met);
      base[level] = first_node;
    };
    enter(0);
    for (;;) {
      Met& here = open[level];
      if (here.met == 0) {
        if (++level == tree.levels) return true;
        continue;
      }
      const unsigned lane = first(here.met);
      const std::uint32_t node = base[level] + lane;
      here.met &= here.met - 1;
      if ((here.inside >> lane & 1U) != 0) {
        if (!take_all(tree, level, node)) return false;
      } else if (level != 0) {
        --level;
        enter(node * kLanes);
      } else if (!test_rows((tree.first_block + node) * kLanes)) {
        return false;
      }
    }
  }

  /// Every row below a node that lies inside.
  bool take_all(const TreeView& tree, std::uint32_t level, std::uint32_t node) {
    const std::uint64_t begin = std::uint64_t{node} << (4 * level);
    std::uint64_t end = std::uint64_t{node + 1} << (4 * level);
    if (end > tree.count[0]) end = tree.count[0];
    for (std::uint64_t block = begin; block < end; ++block) {
      const auto row = static_cast<std::uint32_t>((tree.first_block + block) * kLanes);
      const Mask16 live = bits(Floats::load(view_.column[0] + row) <= 3.4028234e38F);
      if (!write(sinks_.inside, row, wanted_.rows(row, live))) return false;
    }
    return true;
  }

  bool test_rows(std::uint32_t first_row) {
    return take_met(probe_.test(view_.column, first_row), first_row, view_.column, first_row);
  }

  /// Writes what was met of the rows from `first_row` on, whose boxes lie in columns from `at` on.
  bool take_met(Met found, std::uint32_t first_row, const float* const* column, std::size_t at) {
    found.met = wanted_.rows(first_row, found.met);
    if (found.met == 0) return true;
    found.inside &= found.met;
    const ExactRegion& exact = probe_.exact();
    if (exact.meets != nullptr) {
      for (Mask16 rest = found.met & found.open; rest != 0; rest &= rest - 1) {
        const unsigned lane = first(rest);
        float box[6];
        for (int c = 0; c < 6; ++c) box[c] = column[c][at + lane];
        const Meeting meeting = exact.meets(exact.region, box);
        if (meeting == Meeting::apart) found.met &= ~(1U << lane);
        if (meeting == Meeting::inside) found.inside |= 1U << lane;
      }
    }
    return write(sinks_.inside, first_row, found.inside) &&
           write(sinks_.crossing, first_row, found.met & ~found.inside);
  }

  bool write(IdSink& sink, std::uint32_t first_row, Mask16 mask) {
    if (chosen_) {
      for (Mask16 rest = mask; rest != 0; rest &= rest - 1) {
        if (!wanted_.accepts(view_.id[first_row + first(rest)])) mask &= ~(1U << first(rest));
      }
    }
    if (sink.cursor > sink.limit && !sink.grow(sink)) return false;
    sink.cursor += compress_store(mask, Uints::load_unaligned(view_.id + first_row), sink.cursor);
    return true;
  }

  static constexpr std::uint32_t kScanned = 256;

  const QueryView& view_;
  const Probe& probe_;
  const Wanted wanted_;
  const bool chosen_;
  RegionSinks& sinks_;
};

template <typename Probe, typename Region>
bool run(const QueryView& view, const Region& region, const QueryFilter& filter,
         RegionSinks& sinks) {
  const Probe probe(region);
  return RegionWalk<Probe>(view, probe, filter, sinks).run();
}

bool flat_boxes(const QueryView& view, const QueryBatch& batch, const QueryFilter& filter,
                PairSink& sink) {
  const Wanted wanted(view, filter);
  for (std::uint32_t b = 0; b < view.flat_blocks; ++b) {
    const Box16 rows = load_slabs<3>(view.column, b * kLanes);
    const Uints ids = Uints::load_unaligned(view.id + b * kLanes);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const QueryBox q(batch.column, k);
      const Mask16 hits = wanted.rows(b * kLanes, overlap(rows, q.low, q.high));
      if (hits == 0) continue;
      if (!has_room(sink)) return false;
      sink.cursor += 2 * emit_pairs<false>(hits, ids, batch.id[k], sink.cursor);
    }
  }
  return true;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const RegionKernels WINNOW_KERNEL_TABLE(region_kernels) = {
    WINNOW_ISA_NAME::run<WINNOW_ISA_NAME::PlaneProbe, PlaneRegion>,
    WINNOW_ISA_NAME::run<WINNOW_ISA_NAME::BallProbe, BallRegion>,
    WINNOW_ISA_NAME::run<WINNOW_ISA_NAME::SweptProbe, SweptRegion>, WINNOW_ISA_NAME::flat_boxes};

}  // namespace winnow
