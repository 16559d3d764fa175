#include <winnow/partitions/hits.kernel.h>
#include <winnow/partitions/sweep_and_prune.kernel.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Sweeps rows [at, end) for box q until a key shows that nothing further can touch it.
template <typename Report>
bool sweep(const StripView& strips, std::uint32_t at, std::uint32_t end, const QueryBox& q,
           PairSink& sink, Report&& report_hits) {
  const float stop = q.high[strips.axis[0].axis];
  for (; at < end && strips.key[at] - strips.drift <= stop; at += kLanes) {
    const Box16 box = load_slabs_unaligned<3>(strips.rows.column, at);
    const Mask16 lanes = end - at < kLanes ? lanes_below(end - at) : 0xFFFFU;
    const Mask16 hits = overlap(box, q.low, q.high) & lanes;
    ++sink.tests;
    if (hits == 0) continue;
    if (!has_room(sink)) return false;
    report_hits(hits, at);
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

bool strip_against(const StripView& strips, std::uint32_t own, std::uint32_t other,
                   PairSink& sink) {
  const std::uint32_t end = strips.start[other + 1];
  std::uint32_t from = strips.start[other];
  if (from == end) return true;
  const CellAxis& sweep_axis = strips.axis[0];
  for (std::uint32_t r = strips.start[own]; r < strips.start[own + 1]; ++r) {
    const QueryBox q(strips.rows.column, r);
    // Keys ascend in both strips, so the start only moves forward: it goes by the key, as the box
    // itself may have drifted either way.
    const float x = strips.key[r] - strips.drift - sweep_axis.reach;
    while (from < end && strips.key[from] + strips.drift < x) ++from;
    const bool done = sweep(strips, from, end, q, sink, [&](Mask16 hits, std::uint32_t at) {
      sink.cursor += 2 * emit_pairs<true>(hits, load_unaligned(strips.rows.id + at),
                                          strips.rows.id[r], sink.cursor);
    });
    if (!done) return false;
  }
  return true;
}

bool strip_self(const StripView& strips, std::uint32_t own, PairSink& sink) {
  const std::uint32_t end = strips.start[own + 1];
  for (std::uint32_t r = strips.start[own]; r < end; ++r) {
    const QueryBox q(strips.rows.column, r);
    const bool done = sweep(strips, r + 1, end, q, sink, [&](Mask16 hits, std::uint32_t at) {
      sink.cursor += 2 * emit_pairs<true>(hits, load_unaligned(strips.rows.id + at),
                                          strips.rows.id[r], sink.cursor);
    });
    if (!done) return false;
  }
  return true;
}

bool self_pairs(const StripView& strips, std::uint32_t begin, std::uint32_t end, PairSink& sink) {
  const std::uint32_t columns = strips.axis[1].count;
  for (std::uint32_t strip = begin; strip < end; ++strip) {
    if (strips.start[strip] == strips.start[strip + 1]) continue;
    if (!strip_self(strips, strip, sink)) return false;
    const std::uint32_t c = strip % columns;
    if (c + 1 < columns && !strip_against(strips, strip, strip + 1, sink)) return false;
    if (strip / columns + 1 == strips.axis[2].count) continue;
    const std::uint32_t above = strip + columns;
    if (c > 0 && !strip_against(strips, strip, above - 1, sink)) return false;
    if (!strip_against(strips, strip, above, sink)) return false;
    if (c + 1 < columns && !strip_against(strips, strip, above + 1, sink)) return false;
  }
  return true;
}

struct Query {
  template <HitMode Mode>
  static bool run(const StripView& strips, const QueryBatch& batch, PairSink& sink) {
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
          const bool done = sweep(strips, from, end, q, sink, [&](Mask16 hits, std::uint32_t at) {
            report<Mode>(hits, strips.rows.id + at, batch.id[row], batch.moved, sink);
          });
          if (!done) return false;
        }
      }
    }
    return true;
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
