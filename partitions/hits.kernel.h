#pragma once

// What kernels do with a mask of hits.

#include <winnow/partitions/pair_sink.h>
#include <winnow/simd/compress.h>

namespace winnow::WINNOW_ISA_NAME {

/// False if the sink is full and cannot grow.
inline bool has_room(PairSink& sink) {
  return sink.cursor <= sink.limit || sink.grow(sink);
}

/// The box that row r of six columns holds.
struct QueryBox {
  float low[3];
  float high[3];
  QueryBox(const float* const* column, std::size_t r)
      : low{column[0][r], column[1][r], column[2][r]},
        high{column[3][r], column[4][r], column[5][r]} {}
};

inline bool is_moved(const std::uint64_t* moved, std::uint32_t id) {
  return (moved[id >> 6U] >> (id & 63U) & 1U) != 0;
}

/// Reports the hits `mask` among the ids at `ids` for query q; there must be room.
template <HitMode Mode>
inline void report(Mask16 mask, const std::uint32_t* ids, std::uint32_t q,
                   const std::uint64_t* moved, PairSink& sink) {
  if constexpr (Mode == HitMode::unordered) {
    sink.cursor += 2 * emit_pairs<true>(mask, load_unaligned(ids), q, sink.cursor);
  } else if constexpr (Mode == HitMode::query_first) {
    sink.cursor += 2 * emit_pairs<false>(mask, load_unaligned(ids), q, sink.cursor);
  } else {
    for (; mask != 0; mask &= mask - 1) {
      const std::uint32_t c = ids[first(mask)];
      if constexpr (Mode == HitMode::query_second) {
        sink.cursor[0] = c;
        sink.cursor[1] = q;
        sink.cursor += 2;
      } else if (c != q && !(c < q && is_moved(moved, c))) {
        sink.cursor[0] = c < q ? c : q;
        sink.cursor[1] = c < q ? q : c;
        sink.cursor += 2;
      }
    }
  }
}

/// Calls Kernel::run<Mode>(view, batch, sink) with the batch's mode as a constant.
template <typename Kernel, typename View>
inline bool with_mode(const View& view, const QueryBatch& batch, PairSink& sink) {
  switch (batch.mode) {
    case HitMode::unordered:
      return Kernel::template run<HitMode::unordered>(view, batch, sink);
    case HitMode::query_first:
      return Kernel::template run<HitMode::query_first>(view, batch, sink);
    case HitMode::query_second:
      return Kernel::template run<HitMode::query_second>(view, batch, sink);
    case HitMode::moved:
      return Kernel::template run<HitMode::moved>(view, batch, sink);
  }
  return true;
}

/// Every overlapping pair of one row of block a and one row of block b, a != b; there must be room
/// for a block's worth of pairs. `a_rows` are the rows of a worth testing.
inline void block_pair(const RowView& rows, std::size_t a, Mask16 a_rows, const Box16& b,
                       const Uint16& b_ids, PairSink& sink) {
  sink.tests += count(a_rows);
  for (; a_rows != 0; a_rows &= a_rows - 1) {
    const std::size_t r = a * kLanes + first(a_rows);
    const QueryBox q(rows.column, r);
    const Mask16 hits = overlap(b, q.low, q.high);
    if (hits != 0) sink.cursor += 2 * emit_pairs<true>(hits, b_ids, rows.id[r], sink.cursor);
  }
}

/// Every overlapping pair within one block; there must be room for a block's worth of pairs.
inline void block_self(const RowView& rows, std::size_t a, PairSink& sink) {
  const Box16 box = load_slabs<3>(rows.column, a * kLanes);
  const Uint16 ids = load_unaligned(rows.id + a * kLanes);
  sink.tests += kLanes - 1;
  for (unsigned i = 0; i + 1 < kLanes; ++i) {
    const std::size_t r = a * kLanes + i;
    const QueryBox q(rows.column, r);
    const Mask16 hits = overlap(box, q.low, q.high) & ~lanes_below(i + 1);
    if (hits != 0) sink.cursor += 2 * emit_pairs<true>(hits, ids, rows.id[r], sink.cursor);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME
