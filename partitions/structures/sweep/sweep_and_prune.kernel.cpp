// Kernels of SweepAndPrune: self pairs, batch queries and the search for misfits in strips.

#include "partitions/structures/sweep/sweep_and_prune.kernel.h"
#include "partitions/structures/cells/cells.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Lines of cells (or strips) are numbered over two axes: line = slow * mids + mid. Contains the
/// lines after line `own` whose objects can touch objects of `own`, so that each pair of
/// neighbouring lines is visited from one side only.
struct NeighbourLines {
  std::uint32_t line[4];
  int count = 0;

  NeighbourLines(const CellAxis& mid_axis, const CellAxis& slow_axis, std::uint32_t own) {
    const std::uint32_t mids = mid_axis.count;
    const std::uint32_t mid = own % mids;
    if (mid + 1 < mids) line[count++] = own + 1;
    if (own / mids + 1 == slow_axis.count) return;
    if (mid > 0) line[count++] = own + mids - 1;
    line[count++] = own + mids;
    if (mid + 1 < mids) line[count++] = own + mids + 1;
  }
};

/// A sweep ends when a key shows that no further row can overlap the box.
struct KeyMayOverlap {
  const StripView& strips;
  bool operator()(const QueryBox& q, std::uint32_t at) const {
    return strips.key[at] - strips.drift <= q.high[strips.axis[0].axis];
  }
};

/// Returns the first row of [at, end) that may extend to x or beyond. Keys ascend; each step
/// compares sixteen, and one step is usually enough, without an unpredictable branch.
inline std::uint32_t skip_below(const StripView& strips, std::uint32_t at, std::uint32_t end,
                                float x) {
  const Floats bound = Floats(x);
  const Floats drift = Floats(strips.drift);
  while (at < end) {
    const Mask16 reaching = bits(bound <= Floats::load_unaligned(strips.key + at) + drift);
    const unsigned below = reaching == 0 ? static_cast<unsigned>(kLanes) : first(reaching);
    at = end - at < below ? end : at + below;
    if (below < kLanes) break;
  }
  return at;
}

/// Returns the end of the rows from `at` on that may start at or below x, or up to fifteen rows
/// more. Keys ascend.
inline std::uint32_t run_end(const StripView& strips, std::uint32_t at, std::uint32_t end,
                             float x) {
  while (at < end && strips.key[at] - strips.drift <= x) at += kLanes;
  return at < end ? at : end;
}

/// Returns the first row of [at, end) that may extend to x or beyond on the sweep axis, by a
/// branchless binary search whose number of steps depends only on the length.
std::uint32_t first_reaching(const StripView& strips, std::uint32_t at, std::uint32_t end,
                             float x) {
  std::uint32_t left = end - at;
  while (left > 0) {
    const std::uint32_t half = (left + 1) / 2;
    at += strips.key[at + half - 1] + strips.drift < x ? half : 0;
    left -= half;
  }
  return at;
}

/// The neighbouring strips after one strip, and for each the first row that the strip's next blocks
/// may reach. Blocks of a strip ascend by key, so these rows only advance.
struct StripSweeps {
  const StripView& strips;
  const NeighbourLines others;
  std::uint32_t from[4];

  StripSweeps(const StripView& view, std::uint32_t strip)
      : strips(view), others(view.axis[1], view.axis[2], strip) {
    for (int k = 0; k < others.count; ++k) from[k] = strips.start[others.line[k]];
  }

  /// Adds the candidates of a block of rows [r, behind) in a strip that ends at `last`.
  template <typename Pairs>
  bool add_runs(std::uint32_t r, std::uint32_t behind, std::uint32_t last, Pairs& pairs) {
    const std::uint32_t axis = strips.axis[0].axis;
    const float low = pairs.low()[axis] - strips.axis[0].reach;
    const float high = pairs.high()[axis];
    if (!pairs.add_run(behind, run_end(strips, behind, last, high))) return false;
    // Boxes may have drifted in either direction from their keys.
    const float passed = strips.key[r] - strips.drift - strips.axis[0].reach;
    for (int k = 0; k < others.count; ++k) {
      const std::uint32_t end = strips.start[others.line[k] + 1];
      from[k] = skip_below(strips, from[k], end, passed);
      const std::uint32_t at = skip_below(strips, from[k], end, low);
      if (!pairs.add_run(at, run_end(strips, at, end, high))) return false;
    }
    return true;
  }
};

struct StripCells {
  template <bool Filtered>
  static bool find_pairs(const StripView& strips, std::uint32_t begin, std::uint32_t end,
                         PairSink& sink) {
    BlockPairs<Filtered> pairs(strips.rows, sink);
    for (std::uint32_t strip = begin; strip < end; ++strip) {
      const std::uint32_t last = strips.start[strip + 1];
      if (strips.start[strip] == last) continue;
      StripSweeps sweeps(strips, strip);
      for (std::uint32_t r = strips.start[strip]; r < last; r += kLanes) {
        const std::uint32_t behind = last - r < kLanes ? last : r + kLanes;
        if (!pairs.start(r, behind)) continue;
        if (!sweeps.add_runs(r, behind, last, pairs) || !pairs.finish()) return false;
      }
    }
    return true;
  }

  static KeyMayOverlap needs_rows(const StripView& strips) { return {strips}; }
  template <typename Visit>
  static bool visit_runs(const StripView& strips, const QueryBox& q, Visit&& visit) {
    std::uint32_t first[3];
    std::uint32_t last[3];
    for (int a = 1; a < 3; ++a) {
      const CellAxis& axis = strips.axis[a];
      first[a] = first_cell(axis, q.low[axis.axis] - axis.reach);
      last[a] = last_cell(axis, q.high[axis.axis]);
    }
    const float x = q.low[strips.axis[0].axis] - strips.axis[0].reach;
    for (std::uint32_t slow = first[2]; slow <= last[2]; ++slow) {
      for (std::uint32_t mid = first[1]; mid <= last[1]; ++mid) {
        const std::uint32_t strip = slow * strips.axis[1].count + mid;
        const std::uint32_t end = strips.start[strip + 1];
        if (!visit(first_reaching(strips, strips.start[strip], end, x), end)) return false;
      }
    }
    return true;
  }

  static std::uint32_t find_misfits(const StripView& strips, std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) {
    const Floats drift = Floats(strips.drift);
    const AxisBounds swept(strips.rows, strips.axis[0], 0);
    std::uint32_t found = 0;
    for (std::uint32_t strip = begin; strip < end; ++strip) {
      const AxisBounds mid(strips.rows, strips.axis[1], strip % strips.axis[1].count);
      const AxisBounds slow(strips.rows, strips.axis[2], strip / strips.axis[1].count);
      found += write_misfits(strips.rows, strips.start[strip], strips.start[strip + 1], out + found,
                             [&](std::size_t row) {
                               const Floats key = Floats::load_unaligned(strips.key + row);
                               const Floats x = Floats::load_unaligned(swept.low + row);
                               return bits(key - drift <= x) & bits(x <= key + drift) &
                                      swept.short_enough(x, row) & mid.kept(row) & slow.kept(row);
                             });
    }
    return found;
  }
};

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const SweepKernels WINNOW_KERNEL_TABLE(sweep_kernels) =
    WINNOW_ISA_NAME::CellFunctions<WINNOW_ISA_NAME::StripCells, StripView>::table();

}  // namespace winnow
