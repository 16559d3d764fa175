// Kernels of overlap queries: tests of 16 boxes against a region (PlaneProbe, BallProbe,
// CapsuleProbe), and the traversal of flat blocks and trees with them (RegionTraversal).
// regions.cpp and overlaps.cpp call them.

#include "partitions/queries/cast_tests.wide.h"
#include "partitions/queries/descent.wide.h"
#include "partitions/queries/region.kernel.h"
#include "partitions/tree/hits.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Result of a float test of 16 boxes: `overlapping`: may overlap the region; `inside`: certainly
/// inside; `open`: needs the exact test.
struct OverlapMasks {
  Mask16 overlapping = 0;
  Mask16 inside = 0;
  Mask16 open = 0;
};

/// Returns the largest coordinate of each box.
inline Floats reach_of(const Box16& box) {
  const Floats high = max(box.high[0], max(box.high[1], box.high[2]));
  const Floats low = min(box.low[0], min(box.low[1], box.low[2]));
  return max(high, 0.0F - low);
}

/// Unordered blocks that are scanned together, so that collected rows are still in the L1 cache
/// when they are gathered.
constexpr std::uint32_t kScanned = 64;

/// A list of the rows, among some blocks, that overlap the region's box.
class RowsInBox {
 public:
  explicit RowsInBox(const PlaneRegion& region) : region_(region) {}

  /// False if there are so many rows that testing the planes on all rows is cheaper.
  bool collect(const QueryView& view, const CandidateFilter& candidate_filter, std::uint32_t begin,
               std::uint32_t end) {
    // Scattered rows cost about three times as much as the rows of a block.
    const unsigned most = (end - begin) * (kLanes / 4);
    for (std::uint32_t block = begin; block < end; ++block) {
      const std::uint32_t row = block * kLanes;
      const Mask16 overlapping =
          overlap(load_slabs<3>(view.column, row), region_.low, region_.high);
      size_ +=
          compress_store(candidate_filter.rows(row, overlapping), count_from(row), row_ + size_);
      if (size_ > most) return false;
    }
    return true;
  }
  [[nodiscard]] unsigned size() const { return size_; }
  [[nodiscard]] std::uint32_t operator[](unsigned place) const { return row_[place]; }

 private:
  const PlaneRegion& region_;
  unsigned size_ = 0;
  std::uint32_t row_[kScanned * kLanes / 4 + 2 * kLanes];
};

/// 16 scattered rows copied side by side.
struct GatheredRows {
  alignas(64) float box[6][kLanes] = {};
  std::uint32_t id[kLanes] = {};
  const float* column[6] = {box[0], box[1], box[2], box[3], box[4], box[5]};

  /// Loads rows from `first_place` on; returns the lanes that contain a row.
  Mask16 load(const QueryView& view, const RowsInBox& rows, unsigned first_place) {
    const unsigned left = rows.size() - first_place;
    const unsigned taken = left < kLanes ? left : kLanes;
    for (unsigned lane = 0; lane < taken; ++lane) {
      const std::uint32_t row = rows[first_place + lane];
      for (int c = 0; c < 6; ++c) box[c][lane] = view.column[c][row];
      id[lane] = view.id[row];
    }
    return lanes_below(taken);
  }
};

/// Scans unordered rows, most of which are outside, with the six planes of a frustum. The planes
/// stay in registers from block to block.
class FrustumScan {
 public:
  static constexpr std::uint32_t kPlanes = 6;

  FrustumScan(const PlaneRegion& region, const float* const* column)
      : region_(region), column_(column), rounding_(region.rounding), slack_(region.slack) {
    for (std::uint32_t k = 0; k < kPlanes; ++k) {
      const WidePlane& plane = region.planes[k];
      offset_[k] = Floats(plane.offset);
      for (int i = 0; i < 3; ++i) {
        normal_[k][i] = Floats(plane.normal[i]);
        end_[k][i] = column[plane.farthest[i]];
      }
    }
  }

  /// False if none of the 16 boxes from `at` on overlaps the region.
  [[nodiscard]] bool may_overlap(std::size_t at) const {
    const Box16 box = load_slabs<3>(column_, at);
    Mask16 overlapping = overlap(box, region_.low, region_.high);
    const Floats below = -kCastTiny - multiply_add(reach_of(box), rounding_, slack_);
    for (std::uint32_t k = 0; k < kPlanes; ++k) {
      Floats most = offset_[k];
      for (int i = 0; i < 3; ++i)
        most = multiply_add(Floats::load(end_[k][i] + at), normal_[k][i], most);
      overlapping &= ~bits(most <= below);
    }
    return overlapping != 0;
  }

 private:
  const PlaneRegion& region_;
  const float* const* column_;
  Floats rounding_;
  Floats slack_;
  Floats offset_[kPlanes];
  Floats normal_[kPlanes][3];
  const float* end_[kPlanes][3];
};

class PlaneProbe {
 public:
  explicit PlaneProbe(const PlaneRegion& region) : region_(region) {}

  [[nodiscard]] const PlaneRegion& region() const { return region_; }
  [[nodiscard]] bool is_frustum() const { return region_.count == FrustumScan::kPlanes; }

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard, gnu::always_inline]] OverlapMasks test(const float* const* column,
                                                      std::size_t at) const {
    const Box16 box = load_slabs<3>(column, at);
    OverlapMasks result;
    result.overlapping = overlap(box, region_.low, region_.high);
    if (result.overlapping == 0) return result;
    const Floats slack = region_.count != 0 ? rounding_of(box) : Floats(0.0F);
    Mask16 surely = result.overlapping;
    // Test all planes even if no box remains: another plane costs less than a mispredicted branch.
    for (std::uint32_t k = 0; k < region_.count; ++k) {
      const WidePlane& plane = region_.planes[k];
      const Floats most = height(plane, column[plane.farthest[0]] + at,
                                 column[plane.farthest[1]] + at, column[plane.farthest[2]] + at);
      result.overlapping &= ~bits(most + slack <= -kCastTiny);
      surely &= bits(slack <= most);
    }
    if (result.overlapping == 0) return result;
    find_inside(box, column, at, slack, surely, result);
    return result;
  }

 private:
  /// `surely`: boxes that reach inside all planes by more than the rounding error.
  void find_inside(const Box16& box, const float* const* column, std::size_t at,
                   const Floats& slack, Mask16 surely, OverlapMasks& result) const {
    result.open = result.overlapping;
    if (region_.more) return;
    result.inside = result.overlapping;
    for (int i = 0; i < 3; ++i) {
      result.inside &= bits(region_.low[i] <= box.low[i]) & bits(box.high[i] <= region_.high[i]);
    }
    Mask16 perhaps = result.overlapping;
    const Floats below = 0.0F - slack;
    for (std::uint32_t k = 0; k < region_.count; ++k) {
      const WidePlane& plane = region_.planes[k];
      const Floats least = height(plane, column[opposite(plane.farthest[0])] + at,
                                  column[opposite(plane.farthest[1])] + at,
                                  column[opposite(plane.farthest[2])] + at);
      result.inside &= bits(slack <= least);
      perhaps &= bits(below <= least);
    }
    result.open &= ~result.inside;
    if (region_.planes_decide) result.open &= ~surely | perhaps;
  }

  static unsigned opposite(unsigned column) { return column < 3 ? column + 3 : column - 3; }

  /// Error bound of the heights of the boxes' corners.
  [[nodiscard]] Floats rounding_of(const Box16& box) const {
    return multiply_add(reach_of(box), Floats(region_.rounding), Floats(region_.slack));
  }

  /// Returns normal . p + offset for a corner of each box. Every step is monotone in the ends of
  /// the box, so a result for a node is also valid for the boxes below it.
  static Floats height(const WidePlane& plane, const float* x, const float* y, const float* z) {
    const Floats a = multiply_add(Floats::load(x), Floats(plane.normal[0]), Floats(plane.offset));
    const Floats b = multiply_add(Floats::load(y), Floats(plane.normal[1]), a);
    return multiply_add(Floats::load(z), Floats(plane.normal[2]), b);
  }

  const PlaneRegion& region_;
};

class BallProbe {
 public:
  explicit BallProbe(const BallRegion& region) : region_(region) {}

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard, gnu::always_inline]] OverlapMasks test(const float* const* column,
                                                      std::size_t at) const {
    // kMore exceeds the rounding of both sides; kTiny covers squares that underflow.
    constexpr float kMore = 1.000002F;
    constexpr float kTiny = 1e-36F;
    const Box16 box = load_slabs<3>(column, at);
    Floats near = Floats(-kTiny);
    Floats far = Floats(kTiny);
    const Floats zero = Floats(0.0F);
    for (int i = 0; i < 3; ++i) {
      const Floats center = Floats(region_.center[i]);
      const Floats below = box.low[i] - center;
      const Floats above = center - box.high[i];
      const Floats gap = max(max(below, above), zero);
      const Floats span = max(zero - below, zero - above);
      near = near + gap * gap;
      far = far + span * span;
    }
    const float square = region_.radius * region_.radius;
    // An infinite square cannot prove that a box is inside.
    const float finite_square = square < kLargest<float> ? square : kLargest<float>;
    const Mask16 live = bits(box.low[0] <= kLargest<float>);
    OverlapMasks result;
    result.overlapping = bits(near <= square * kMore) & live;
    result.inside = bits(far * kMore <= finite_square) & result.overlapping;
    result.open = result.overlapping & ~result.inside;
    return result;
  }

 private:
  const BallRegion& region_;
};

class CapsuleProbe {
 public:
  explicit CapsuleProbe(const CapsuleRegion& region)
      : region_(region), test_(region.cast), limit_(scaled_limit(region.cast, region.cast.max_t)) {}

  [[nodiscard]] const ExactRegion& exact() const { return region_.exact; }

  [[nodiscard, gnu::always_inline]] OverlapMasks test(const float* const* column,
                                                      std::size_t at) const {
    Floats enter;
    const Mask16 overlapping = test_.test(column, at, limit_, enter);
    return {overlapping, 0, overlapping};
  }

 private:
  const CapsuleRegion& region_;
  CastTest test_;
  float limit_;
};

template <typename Probe>
class RegionTraversal {
 public:
  RegionTraversal(const QueryView& view, const Probe& probe, const QueryFilter& filter,
                  RegionSinks& sinks)
      : view_(view),
        probe_(probe),
        candidate_filter_(view, filter),
        has_predicate_(filter.accept != nullptr),
        sinks_(sinks) {}

  bool run() {
    if (!scan_flat()) return false;
    for (std::uint32_t t = 0; t < view_.trees; ++t) {
      if (!traverse_tree(*view_.tree[t])) return false;
    }
    return true;
  }

 private:
  bool scan_flat() {
    for (std::uint32_t begin = 0; begin < view_.flat_blocks; begin += kScanned) {
      const std::uint32_t left = view_.flat_blocks - begin;
      if (!scan_some(begin, begin + (left < kScanned ? left : kScanned))) return false;
    }
    return true;
  }

  /// Requires end - begin <= kScanned.
  bool scan_some(std::uint32_t begin, std::uint32_t end) {
    if constexpr (requires { probe_.is_frustum(); }) {
      if (probe_.is_frustum()) {
        RowsInBox rows(probe_.region());
        if (rows.collect(view_, candidate_filter_, begin, end)) return test_collected(rows);
        return scan_planes(begin, end);
      }
    }
    for (std::uint32_t block = begin; block < end; ++block) {
      if (!test_rows(block * kLanes)) return false;
    }
    return true;
  }

  bool test_collected(const RowsInBox& rows) {
    GatheredRows gathered;
    for (unsigned first_place = 0; first_place < rows.size(); first_place += kLanes) {
      const Mask16 present = gathered.load(view_, rows, first_place);
      OverlapMasks found = probe_.test(gathered.column, 0);
      found.overlapping &= present;
      if (!add_overlapping(found, gathered.id, gathered.column, 0)) return false;
    }
    return true;
  }

  /// Collects, without a branch, the blocks that pass, then tests them.
  bool scan_planes(std::uint32_t begin, std::uint32_t end) {
    const FrustumScan scan(probe_.region(), view_.column);
    std::uint32_t passed[kScanned];
    unsigned count = 0;
    for (std::uint32_t block = begin; block < end; ++block) {
      passed[count] = block * kLanes;
      count += scan.may_overlap(passed[count]) ? 1U : 0U;
    }
    for (unsigned i = 0; i < count; ++i) {
      if (!test_rows(passed[i])) return false;
    }
    return true;
  }

  bool traverse_tree(const TreeShape& tree) {
    Mask16 inside[kMaxTreeLevels];
    return traverse<kMaxTreeLevels>(
        tree.levels,
        [&](std::uint32_t level, std::uint32_t first_node) {
          const OverlapMasks found = probe_.test(tree.node[level], first_node);
          inside[level] = found.inside;
          return candidate_filter_.nodes(tree, level, first_node, found.overlapping);
        },
        [&](std::uint32_t level, std::uint32_t node) {
          if ((inside[level] >> node % kLanes & 1U) != 0) {
            return write_subtree(tree, level, node) ? Next::past : Next::stop;
          }
          if (level != 0) return Next::below;
          return test_rows((tree.first_block + node) * kLanes) ? Next::past : Next::stop;
        });
  }

  /// Writes every row below a node that is inside the region.
  bool write_subtree(const TreeShape& tree, std::uint32_t level, std::uint32_t node) {
    const std::uint64_t begin = std::uint64_t{node} << (4 * level);
    std::uint64_t end = std::uint64_t{node + 1} << (4 * level);
    if (end > tree.count[0]) end = tree.count[0];
    for (std::uint64_t block = begin; block < end; ++block) {
      const auto row = static_cast<std::uint32_t>((tree.first_block + block) * kLanes);
      const Mask16 live = bits(Floats::load(view_.column[0] + row) <= kLargest<float>);
      if (!write(sinks_.inside, view_.id + row, candidate_filter_.rows(row, live))) return false;
    }
    return true;
  }

  [[gnu::always_inline]] bool test_rows(std::uint32_t first_row) {
    OverlapMasks found = probe_.test(view_.column, first_row);
    found.overlapping = candidate_filter_.rows(first_row, found.overlapping);
    return add_overlapping(found, view_.id + first_row, view_.column, first_row);
  }

  /// Writes the matches among 16 rows with these ids and with boxes in the columns from `at` on.
  bool add_overlapping(OverlapMasks found, const std::uint32_t* id, const float* const* column,
                       std::size_t at) {
    if (found.overlapping == 0) return true;
    found.inside &= found.overlapping;
    const ExactRegion& exact = probe_.exact();
    if (exact.classify != nullptr) {
      for (Mask16 rest = found.overlapping & found.open; rest != 0; rest &= rest - 1) {
        const unsigned lane = first(rest);
        float box[6];
        for (int c = 0; c < 6; ++c) box[c] = column[c][at + lane];
        const Containment containment = exact.classify(exact.region, box);
        if (containment == Containment::apart) found.overlapping &= ~(1U << lane);
        if (containment == Containment::inside) found.inside |= 1U << lane;
      }
    }
    return write(sinks_.inside, id, found.inside) &&
           write(sinks_.crossing, id, found.overlapping & ~found.inside);
  }

  bool write(IdSink& sink, const std::uint32_t* id, Mask16 mask) {
    if (has_predicate_) {
      for (Mask16 rest = mask; rest != 0; rest &= rest - 1) {
        if (!candidate_filter_.accepts(id[first(rest)])) mask &= ~(1U << first(rest));
      }
    }
    if (sink.cursor > sink.limit && !sink.grow(sink)) return false;
    sink.cursor += compress_store(mask, Uints::load_unaligned(id), sink.cursor);
    return true;
  }

  const QueryView& view_;
  const Probe& probe_;
  const CandidateFilter candidate_filter_;
  const bool has_predicate_;
  RegionSinks& sinks_;
};

template <typename Probe, typename Region>
bool run(const QueryView& view, const Region& region, const QueryFilter& filter,
         RegionSinks& sinks) {
  const Probe probe(region);
  return RegionTraversal<Probe>(view, probe, filter, sinks).run();
}

bool flat_boxes(const QueryView& view, const QueryBatch& batch, const QueryFilter& filter,
                PairSink& sink) {
  const CandidateFilter candidate_filter(view, filter);
  for (std::uint32_t b = 0; b < view.flat_blocks; ++b) {
    const Box16 rows = load_slabs<3>(view.column, b * kLanes);
    const Uints ids = Uints::load_unaligned(view.id + b * kLanes);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const QueryBox q(batch.column, k);
      const Mask16 overlapping = overlap(rows, q.low, q.high);
      if (overlapping == 0) continue;
      const Mask16 hits = candidate_filter.rows(b * kLanes, overlapping);
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
    WINNOW_ISA_NAME::run<WINNOW_ISA_NAME::CapsuleProbe, CapsuleRegion>,
    WINNOW_ISA_NAME::flat_boxes};

}  // namespace winnow
