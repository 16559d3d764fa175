#pragma once

// Processing of masks of hits in kernels: filter tests, tests of volumes inside overlapping boxes,
// and output of pairs to the sink. Small functions are force-inlined, because compilers stop
// inlining in files that instantiate a kernel many times.

#include "partitions/rows/row_view.h"
#include "partitions/tree/block_tree.kernel.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/test_bits.h"

namespace winnow::WINNOW_ISA_NAME {

/// A filter, or the union of the filters below a node. An object of every environment spans all
/// environments, so one interval test applies to objects and nodes.
struct FilterRange {
  std::uint32_t layers;
  std::uint32_t mask;
  std::uint32_t first_environment;
  std::uint32_t last_environment;
};

[[gnu::always_inline]] inline FilterRange range_of(const ObjectFilter& f) {
  const std::uint32_t first = f.environment == kAllEnvironments ? 0U : f.environment;
  return {f.layers, f.mask, first, f.environment};
}

/// The range of node i; the range of the default filter if no filters are stored.
[[gnu::always_inline]] inline FilterRange range_of(const NodeFilters& nodes, std::uint32_t i) {
  if (nodes.layers == nullptr) return range_of(ObjectFilter{});
  return {nodes.layers[i], nodes.mask[i], nodes.first_environment[i], nodes.last_environment[i]};
}

/// True if an object of one range may pass the filter of an object of the other; exact for two
/// objects.
[[gnu::always_inline]] inline bool filters_allow(const FilterRange& a, const FilterRange& b) {
  // Branchless, because layers are unpredictable.
  return static_cast<bool>(static_cast<unsigned>((a.layers & b.mask) != 0) &
                           static_cast<unsigned>((b.layers & a.mask) != 0) &
                           static_cast<unsigned>(a.first_environment <= b.last_environment) &
                           static_cast<unsigned>(b.first_environment <= a.last_environment));
}

/// The filters below node i of a level as a span. Only for trees without environments.
static inline FilterSpan span_of(const NodeFilters& nodes, std::uint32_t i) {
  FilterSpan span;
  span.any_layers = nodes.layers[i];
  span.every_layers = nodes.every_layers[i];
  span.any_mask = nodes.mask[i];
  span.every_mask = nodes.every_mask[i];
  span.any_unpairable = (span.every_layers | span.every_mask) == 0;
  span.all_environments = false;
  return span;
}

/// The lanes whose value is below, or above, a number.
[[gnu::always_inline]] inline Mask16 below(const Uints& v, std::uint32_t number) {
  return test_bits(Uints(number) - min(v, Uints(number)), ~0U);
}
[[gnu::always_inline]] inline Mask16 above(const Uints& v, std::uint32_t number) {
  return test_bits(v - min(v, Uints(number)), ~0U);
}

/// The lanes from `at` on whose layers and mask match `q`.
[[gnu::always_inline]] inline Mask16 matching_lanes(const std::uint32_t* layers,
                                                    const std::uint32_t* mask, std::size_t at,
                                                    const FilterRange& q) {
  return test_bits(Uints::load_unaligned(layers + at), q.mask) &
         test_bits(Uints::load_unaligned(mask + at), q.layers);
}

/// Returns the candidate rows from `first_row` on, none of them empty, whose filters match `q`.
/// `environments` is true if more than one environment is in use.
[[gnu::always_inline]] inline Mask16 passing_rows(const FilterColumns& own, bool environments,
                                                  std::uint32_t first_row, Mask16 candidates,
                                                  const FilterRange& q) {
  if (own.layers == nullptr)
    return filters_allow(range_of(ObjectFilter{}), q) ? candidates : Mask16{0};
  const Mask16 matching = candidates & matching_lanes(own.layers, own.mask, first_row, q);
  // Without environments all objects are in environment 0 or in every environment.
  if (!environments && q.first_environment == 0) return matching;
  const Uints last = Uints::load_unaligned(own.environment + first_row);
  const Mask16 of_one = test_bits(Uints(kAllEnvironments) - last, ~0U);
  const Mask16 behind = above(last, q.last_environment) & of_one;
  return matching & ~behind & ~below(last, q.first_environment);
}
[[gnu::always_inline]] inline Mask16 passing_rows(const RowView& rows, std::uint32_t first_row,
                                                  Mask16 candidates, const FilterRange& q) {
  return passing_rows(rows.filter, rows.environments, first_row, candidates, q);
}

/// Returns the candidates among 16 nodes from `first_node` on of a level whose filters may match
/// `q`.
[[gnu::always_inline]] inline Mask16 passing_nodes(const TreeShape& tree, std::uint32_t level,
                                                   std::uint32_t first_node, Mask16 candidates,
                                                   const FilterRange& q) {
  const NodeFilters& nodes = tree.filters[level];
  if (nodes.layers == nullptr) {
    return filters_allow(range_of(ObjectFilter{}), q) ? candidates : Mask16{0};
  }
  const Mask16 matching = candidates & matching_lanes(nodes.layers, nodes.mask, first_node, q);
  // Without environments all objects are in environment 0 or in every environment.
  if (!tree.environments && q.first_environment == 0) return matching;
  const Uints begin = Uints::load_unaligned(nodes.first_environment + first_node);
  const Uints last = Uints::load_unaligned(nodes.last_environment + first_node);
  return matching & ~above(begin, q.last_environment) & ~below(last, q.first_environment);
}

// Columns of a sphere's centre and radius.
inline constexpr int kBallCenter = 6;
inline constexpr int kBallRadius = 9;

/// Tests spheres against one sphere. The right side of |distance|^2 <= (r1 + r2)^2 is enlarged by
/// more than the rounding of both sides (a few ulp each), so touching spheres are never missed. If
/// a square overflows or underflows the test still errs towards a hit.
[[gnu::always_inline]] inline Mask16 spheres_overlap_one(const Floats* center, const Floats& radius,
                                                         const float* other, float other_radius) {
  constexpr float kSlack = 1.000002F;
  constexpr float kTiny = 1e-37F;
  Floats square = Floats(-kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats d = other[axis] - center[axis];
    square = square + d * d;
  }
  const Floats sum = radius + other_radius;
  const Floats limit = sum * sum * kSlack;
  // An empty row has an infinite centre, whose square is infinite: infinity <= infinity must not be
  // a hit.
  const Mask16 real = bits(center[0] <= kLargest<float>);
  return bits(square <= limit) & real;
}

/// `mask` has the lanes (rows from `at` on) whose boxes overlap the box of row r of `query`.
/// Returns the lanes among them whose further slabs overlap, too.
inline Mask16 further_slabs_overlap(const RowView& rows, std::uint32_t at,
                                    const float* const* query, std::uint32_t r, Mask16 mask) {
  const std::uint32_t slabs = rows.further_slabs;
  for (std::uint32_t low = 6; low < 6 + slabs; ++low) {
    const std::uint32_t high = low + slabs;
    mask &= bits(Floats::load_unaligned(rows.column[low] + at) <= query[high][r]) &
            bits(query[low][r] <= Floats::load_unaligned(rows.column[high] + at));
  }
  return mask;
}

/// As above, for spheres.
inline Mask16 spheres_overlap(const RowView& rows, std::uint32_t at, const float* const* query,
                              std::uint32_t r, Mask16 mask) {
  Floats center[3];
  float other[3];
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = Floats::load_unaligned(rows.column[kBallCenter + axis] + at);
    other[axis] = query[kBallCenter + axis][r];
  }
  const Floats radius = Floats::load_unaligned(rows.column[kBallRadius] + at);
  return mask & spheres_overlap_one(center, radius, other, query[kBallRadius][r]);
}

/// True if pairs of these rows must be tested by their filters.
inline bool are_filtered(const RowView& rows) {
  return rows.filter.layers != nullptr && !rows.all_match;
}

/// False if the sink is full and cannot grow.
inline bool has_room(PairSink& sink) {
  return sink.cursor <= sink.limit || sink.grow(sink);
}

/// Returns the lanes, of rows from `at` on, that row r reports in HitMode::moved: rows that did not
/// move, and moved rows behind r. `moved` is readable for 32 bits from any row on.
inline Mask16 reported_lanes(const std::uint64_t* moved, std::uint32_t r, std::uint32_t at) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, reinterpret_cast<const unsigned char*>(moved) + (at >> 3U), sizeof bits);
  bits >>= at & 7U;
  const Mask16 up_to_r = r < at ? 0U : r - at >= kLanes ? kAllRows : lanes_below(r - at + 1);
  return ~(bits & up_to_r);
}

/// Filters of querying rows, by row.
struct QueryFilters {
  FilterColumns filter;
  std::uint32_t step = 1;  // 0: one filter for all

  explicit QueryFilters(const RowView& rows) : filter(rows.filter) {}
  explicit QueryFilters(const QueryBatch& batch)
      : filter(batch.filter), step(batch.one_filter ? 0U : 1U) {}

  [[nodiscard, gnu::always_inline]] FilterRange of(std::uint32_t row) const {
    if (filter.layers == nullptr) return range_of(ObjectFilter{});
    const std::size_t i = std::size_t{row} * step;
    return range_of({filter.layers[i], filter.mask[i], filter.environment[i]});
  }
};

/// Writes the hits `mask` among the ids at `ids` for query q; there must be room.
inline void report(HitMode mode, Mask16 mask, const std::uint32_t* ids, std::uint32_t q,
                   PairSink& sink) {
  if (mode == HitMode::query_first) {
    sink.cursor += 2 * emit_pairs<false>(mask, Uints::load_unaligned(ids), q, sink.cursor);
  } else if (mode == HitMode::query_second) {
    for (; mask != 0; mask &= mask - 1) {
      sink.cursor[0] = ids[first(mask)];
      sink.cursor[1] = q;
      sink.cursor += 2;
    }
  } else {
    sink.cursor += 2 * emit_pairs<true>(mask, Uints::load_unaligned(ids), q, sink.cursor);
  }
}

/// Returns the lanes of `sets` that are not empty and certainly share a bit with each of some other
/// sets, whose union is `any` and whose intersection is `every` (see surely_share).
inline Mask16 surely_sharing(const Uints& sets, std::uint32_t any, std::uint32_t every) {
  const Mask16 lack_one = test_bits(Uints(any) - (sets & Uints(any)), ~0U);
  return test_bits(sets, every) | ((~lack_one | ~test_bits(sets, ~every)) & test_bits(sets, ~0U));
}

/// Divides the rows of a batch into two parts: rows that certainly match all objects, and all other
/// rows.
class SplitBatch {
 public:
  SplitBatch(const RowView& queried, const QueryBatch& batch, std::uint32_t begin) {
    const FilterSpan& all = queried.span;
    const std::uint32_t left = batch.end - begin;
    const std::uint32_t end = begin + (left < kRoom ? left : kRoom);
    for (std::uint32_t k = begin; k < end; k += kLanes) {
      const SomeFilters some(batch, k, end);
      Mask16 sure = 0;
      if (!all.any_unpairable) {
        sure = surely_sharing(some.masks, all.any_layers, all.every_layers) &
               surely_sharing(some.layers, all.any_mask, all.every_mask);
      }
      if (!all.all_environments && (all.environments || batch.environments))
        sure &= some.everywhere(all.environments);
      add(some.lanes & sure, some.rows, 1);
      add(some.lanes & ~sure, some.rows, 0);
    }
  }

  /// Returns the rows that certainly match all objects or, if `matches_all` is false, the other
  /// rows.
  [[nodiscard]] QueryBatch part(const QueryBatch& batch, bool matches_all) const {
    QueryBatch part = batch;
    part.rows = row_[matches_all ? 1 : 0];
    part.begin = 0;
    part.end = count_[matches_all ? 1 : 0];
    return part;
  }

  static constexpr std::uint32_t kRoom = 256;

 private:
  /// Filters of sixteen querying rows.
  struct SomeFilters {
    Uints rows;
    Uints layers;
    Uints masks;
    Mask16 lanes;
    std::uint32_t environment[kLanes];

    SomeFilters(const QueryBatch& batch, std::uint32_t begin, std::uint32_t end) {
      lanes = lanes_below(end - begin < kLanes ? end - begin : kLanes);
      if (batch.rows == nullptr && batch.filter.layers != nullptr) {
        rows = count_from(begin);
        layers = Uints::load_unaligned(batch.filter.layers + begin);
        masks = Uints::load_unaligned(batch.filter.mask + begin);
        Uints::load_unaligned(batch.filter.environment + begin).store_unaligned(environment);
        return;
      }
      const QueryFilters filters(batch);
      std::uint32_t row[kLanes] = {};
      std::uint32_t layer[kLanes] = {};
      std::uint32_t mask[kLanes] = {};
      for (Mask16 left = lanes; left != 0; left &= left - 1) {
        const unsigned i = first(left);
        row[i] = batch.rows != nullptr ? batch.rows[begin + i] : begin + i;
        const FilterRange q = filters.of(row[i]);
        layer[i] = q.layers;
        mask[i] = q.mask;
        environment[i] = q.last_environment;
      }
      rows = Uints::load_unaligned(row);
      layers = Uints::load_unaligned(layer);
      masks = Uints::load_unaligned(mask);
    }

    /// The lanes of every environment, and of environment 0 unless other `environments` are in use.
    [[nodiscard]] Mask16 everywhere(bool environments) const {
      Mask16 found = 0;
      for (Mask16 left = lanes; left != 0; left &= left - 1) {
        const std::uint32_t own = environment[first(left)];
        const bool matches_all = own == kAllEnvironments || (own == 0 && !environments);
        found |= static_cast<Mask16>(matches_all) << first(left);
      }
      return found;
    }
  };

  void add(Mask16 lanes, const Uints& rows, unsigned part) {
    count_[part] += compress_store(lanes, rows, row_[part] + count_[part]);
  }

  std::uint32_t row_[2][kRoom + kLanes];
  std::uint32_t count_[2] = {0, 0};
};

/// Calls Kernel::run<Filtered>(view, batch, sink). Not inlined, because it is called for whole
/// batches and for parts of them.
template <typename Kernel, bool Filtered, typename View>
[[gnu::noinline]] bool run_kernel(const View& view, const QueryBatch& batch, PairSink& sink) {
  return Kernel::template run<Filtered>(view, batch, sink);
}

/// Runs a kernel with the use of filters as a template parameter, for each part of a SplitBatch.
template <typename Kernel, typename View>
inline bool with_filters(const View& view, const QueryBatch& batch, PairSink& sink) {
  const bool filtered = view.rows.filter.layers != nullptr || batch.filter.layers != nullptr;
  if (!filtered || batch.matches_all) return run_kernel<Kernel, false>(view, batch, sink);
  if (batch.one_filter) return run_kernel<Kernel, true>(view, batch, sink);
  for (std::uint32_t k = batch.begin; k < batch.end; k += SplitBatch::kRoom) {
    const SplitBatch split(view.rows, batch, k);
    if (!run_kernel<Kernel, false>(view, split.part(batch, true), sink) ||
        !run_kernel<Kernel, true>(view, split.part(batch, false), sink)) {
      return false;
    }
  }
  return true;
}

/// True if hits of boxes still have to be tested by the rows' volumes.
inline bool has_more_to_test(const RowView& rows) {
  return rows.further_slabs != 0 || rows.spheres;
}

/// Removes the hits whose volumes do not overlap from lists of hits of boxes. Entry i has the hits
/// of row[i] of the columns `query`: lanes mask[i] of the rows from at[i] on. Returns the number of
/// remaining entries. Not inlined, because kernels for boxes never call it.
[[gnu::noinline, maybe_unused]] static unsigned keep_volume_hits(
    const RowView& rows, const float* const* query, std::uint32_t* row, std::uint32_t* at,
    std::uint32_t* mask, unsigned size) {
  unsigned kept = 0;
  for (unsigned i = 0; i < size; ++i) {
    const Mask16 hits = rows.spheres ? spheres_overlap(rows, at[i], query, row[i], mask[i])
                                     : further_slabs_overlap(rows, at[i], query, row[i], mask[i]);
    row[kept] = row[i];
    at[kept] = at[i];
    mask[kept] = hits;
    kept += hits != 0 ? 1U : 0U;
  }
  return kept;
}

/// As above, removes the lanes that are not reported in HitMode::moved. Returns the number of
/// remaining entries.
[[gnu::noinline, maybe_unused]] static unsigned keep_reported(const std::uint64_t* moved,
                                                              std::uint32_t* row, std::uint32_t* at,
                                                              std::uint32_t* mask, unsigned size) {
  unsigned kept = 0;
  for (unsigned i = 0; i < size; ++i) {
    const Mask16 hits = mask[i] & reported_lanes(moved, row[i], at[i]);
    row[kept] = row[i];
    at[kept] = at[i];
    mask[kept] = hits;
    kept += hits != 0 ? 1U : 0U;
  }
  return kept;
}

/// Buffers hits before output. Hits are unpredictable, so tests append without a branch; filters
/// are tested and pairs are written in one long loop.
template <bool Filtered>
class HitList {
 public:
  HitList(const RowView& rows, const QueryBatch& batch, PairSink& sink)
      : rows_(rows),
        query_(batch.column),
        more_to_test_(!batch.is_box && has_more_to_test(rows)),
        query_id_(batch.id),
        mode_(batch.mode),
        moved_(batch.mode == HitMode::moved ? batch.moved : nullptr),
        filters_(batch),
        sink_(sink) {}
  /// Creates a list for rows that query each other.
  HitList(const RowView& rows, PairSink& sink)
      : rows_(rows),
        query_(rows.column),
        more_to_test_(has_more_to_test(rows)),
        query_id_(rows.id),
        mode_(HitMode::unordered),
        moved_(nullptr),
        filters_(rows),
        sink_(sink) {}

  /// Adds the hits of row `r` in lanes `mask` of the rows from `at` on; adds nothing if the mask is
  /// empty. There must be room.
  void add(std::uint32_t r, std::uint32_t at, Mask16 mask) {
    row_[size_] = r;
    at_[size_] = at;
    mask_[size_] = mask;
    size_ += mask != 0 ? 1U : 0U;
  }

  /// Makes room for one more entry. Returns false if the sink is full.
  bool make_room() { return __builtin_expect(size_ < kRoom, 1) != 0 || flush(); }

  /// Writes all entries to the sink. Returns false if the sink is full.
  [[gnu::noinline]] bool flush() {
    if (moved_ != nullptr) size_ = keep_reported(moved_, row_, at_, mask_, size_);
    if (more_to_test_) size_ = keep_volume_hits(rows_, query_, row_, at_, mask_, size_);
    for (unsigned i = 0; i < size_; ++i) {
      Mask16 mask = mask_[i];
      const std::uint32_t q = query_id_[row_[i]];
      if constexpr (Filtered) {
        mask = passing_rows(rows_, at_[i], mask, filters_.of(row_[i]));
      }
      if (!has_room(sink_)) return false;
      report(mode_, mask, rows_.id + at_[i], q, sink_);
    }
    size_ = 0;
    return true;
  }

 private:
  static constexpr unsigned kRoom = 512;

  const RowView& rows_;
  const float* const* query_;
  bool more_to_test_;
  const std::uint32_t* query_id_;
  const HitMode mode_;
  const std::uint64_t* const moved_;  // null in other modes
  const QueryFilters filters_;
  PairSink& sink_;
  unsigned size_ = 0;
  std::uint32_t row_[kRoom];
  std::uint32_t at_[kRoom];
  std::uint32_t mask_[kRoom];
};

/// For ranges of rows that are tested to their end.
struct AllRows {
  bool operator()(const QueryBox&, std::uint32_t) const { return true; }
};

/// Ranges of rows to be tested, each against one box. Their lengths are unpredictable, so one long
/// loop tests 16 rows of every range, and unfinished ranges are kept for the next round.
/// `NeedsRows(q, at)` returns whether box q needs the rows from `at` on.
template <bool Filtered, typename NeedsRows>
class RunList {
 public:
  /// `query` has the columns of the querying boxes.
  RunList(const RowView& rows, const float* const* query, HitList<Filtered>& hits,
          const NeedsRows& needs_rows, PairSink& sink)
      : rows_(rows), query_(query), hits_(hits), needs_rows_(needs_rows), sink_(sink) {}

  /// Adds rows [at, end) for the box of row r of the query columns. Returns false if the sink is
  /// full.
  bool add(std::uint32_t r, std::uint32_t at, std::uint32_t end) {
    if (size_ == kRoom && !finish()) return false;
    row_[size_] = r;
    at_[size_] = at;
    end_[size_] = end;
    size_ += at < end ? 1U : 0U;
    return true;
  }

  /// Tests all ranges. Returns false if the sink is full.
  bool finish() {
    while (size_ != 0) {
      unsigned next = 0;
      sink_.tests += size_;
      for (unsigned k = 0; k < size_; ++k) {
        const std::uint32_t at = at_[k];
        const std::uint32_t end = end_[k];
        const std::uint32_t left = end - at < kLanes ? end - at : kLanes;
        const QueryBox q(query_, row_[k]);
        const Box16 box = load_slabs_unaligned<3>(rows_.column, at);
        if (!hits_.make_room()) return false;
        hits_.add(row_[k], at, overlap(box, q.low, q.high) & lanes_below(left));
        row_[next] = row_[k];
        at_[next] = at + left;
        end_[next] = end;
        next += at + left < end && needs_rows_(q, at + left) ? 1U : 0U;
      }
      size_ = next;
    }
    return true;
  }

 private:
  static constexpr unsigned kRoom = 256;

  const RowView& rows_;
  const float* const* query_;
  HitList<Filtered>& hits_;
  const NeedsRows needs_rows_;
  PairSink& sink_;
  unsigned size_ = 0;
  std::uint32_t row_[kRoom + 1];
  std::uint32_t at_[kRoom + 1];
  std::uint32_t end_[kRoom + 1];
};

}  // namespace winnow::WINNOW_ISA_NAME
