#include <winnow/partitions/hits.kernel.h>
#include <winnow/partitions/sweep_and_prune.kernel.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Sweeps rows [at, end) for box q of row r until a key shows that nothing further can touch it.
template <typename Hits>
bool sweep(const StripView& strips, const QueryBox& q, std::uint32_t r, std::uint32_t at,
           std::uint32_t end, Hits& hits, PairSink& sink) {
  const float stop = q.high[strips.axis[0].axis];
  for (; at < end && strips.key[at] - strips.drift <= stop; at += kLanes) {
    const Box16 box = load_slabs_unaligned<3>(strips.rows.column, at);
    const Mask16 lanes = end - at < kLanes ? lanes_below(end - at) : 0xFFFFU;
    if (!hits.make_room()) return false;
    hits.add(r, at, overlap(box, q.low, q.high) & lanes);
    ++sink.tests;
  }
  return true;
}

/// The first row of [at, end) that may reach up to x on the sweep axis.
std::uint32_t first_reaching(const StripView& strips, std::uint32_t at, std::uint32_t end,
                             float x) {
  while (at < end) {
    const std::uint32_t middle = at + (end - at) / 2;
    if (strips.key[middle] + strips.drift < x) {
      at = middle + 1;
    } else {
      end = middle;
    }
  }
  return at;
}

bool strip_against(const StripView& strips, std::uint32_t own, std::uint32_t other, OwnHits& hits,
                   PairSink& sink) {
  const std::uint32_t end = strips.start[other + 1];
  std::uint32_t from = strips.start[other];
  if (from == end) return true;
  for (std::uint32_t r = strips.start[own]; r < strips.start[own + 1]; ++r) {
    // Keys ascend in both strips, so the start only moves forward: it goes by the key, as the box
    // itself may have drifted either way.
    const float x = strips.key[r] - strips.drift - strips.axis[0].reach;
    while (from < end && strips.key[from] + strips.drift < x) ++from;
    const QueryBox q(strips.rows.column, r);
    if (!sweep(strips, q, r, from, end, hits, sink)) return false;
  }
  return true;
}

bool strip_self(const StripView& strips, std::uint32_t own, OwnHits& hits, PairSink& sink) {
  const std::uint32_t end = strips.start[own + 1];
  for (std::uint32_t r = strips.start[own]; r < end; ++r) {
    const QueryBox q(strips.rows.column, r);
    if (!sweep(strips, q, r, r + 1, end, hits, sink)) return false;
  }
  return true;
}

bool self_pairs(const StripView& strips, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  const std::uint32_t columns = strips.axis[1].count;
  OwnHits hits(strips.rows, sink);
  for (std::uint32_t strip = begin; strip < end; ++strip) {
    if (strips.start[strip] == strips.start[strip + 1]) continue;
    if (!strip_self(strips, strip, hits, sink)) return false;
    const std::uint32_t c = strip % columns;
    std::uint32_t others[4];
    int count = 0;
    if (c + 1 < columns) others[count++] = strip + 1;
    if (strip / columns + 1 < strips.axis[2].count) {
      const std::uint32_t above = strip + columns;
      if (c > 0) others[count++] = above - 1;
      others[count++] = above;
      if (c + 1 < columns) others[count++] = above + 1;
    }
    for (int k = 0; k < count; ++k) {
      if (!strip_against(strips, strip, others[k], hits, sink)) return false;
    }
  }
  return hits.flush();
}

struct Query {
  template <HitMode Mode>
  static bool run(const StripView& strips, const QueryBatch& batch, PairSink& sink) {
    HitList<Mode> hits(strips.rows, batch.id, batch.moved, sink);
    for (std::uint32_t k = batch.begin; k < batch.end; ++k) {
      const std::uint32_t row = batch.rows != nullptr ? batch.rows[k] : k;
      const QueryBox q(batch.column, row);
      if (!(q.low[0] <= q.high[0])) continue;
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
          const std::uint32_t from = first_reaching(strips, strips.start[strip], end, x);
          if (!sweep(strips, q, row, from, end, hits, sink)) return false;
        }
      }
    }
    return hits.flush();
  }
};

bool query(const StripView& strips, const QueryBatch& batch, PairSink& sink) {
  return with_mode<Query>(strips, batch, sink);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const SweepKernels WINNOW_KERNEL_TABLE(sweep_kernels) = {WINNOW_ISA_NAME::self_pairs,
                                                                WINNOW_ISA_NAME::query};

}  // namespace winnow
