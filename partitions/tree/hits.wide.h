#pragma once

// What kernels do with a mask of hits: which rows the filters let pass, which volumes meet inside
// of boxes that do, and how pairs get to the sink. What is small is inlined by force: compilers
// stop to do so in files that instantiate a kernel many times.

#include "partitions/rows/row_view.h"
#include "partitions/tree/block_tree.kernel.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/shared_bits.h"

namespace winnow::WINNOW_ISA_NAME {

/// A filter, or what the filters below a node have between them. An object of every environment
/// spans them all, so that one test of intervals serves objects and nodes.
struct FilterRange {
  std::uint32_t layers;
  std::uint32_t mask;
  std::uint32_t first_environment;
  std::uint32_t last_environment;
};

[[gnu::always_inline]] inline FilterRange range_of(const ObjectFilter& f) {
  const std::uint32_t first = f.environment == kEveryEnvironment ? 0U : f.environment;
  return {f.layers, f.mask, first, f.environment};
}

/// The range of node i; that of the default filter if no filters are kept.
[[gnu::always_inline]] inline FilterRange range_of(const NodeFilters& nodes, std::uint32_t i) {
  if (nodes.layers == nullptr) return range_of(ObjectFilter{});
  return {nodes.layers[i], nodes.mask[i], nodes.first_environment[i], nodes.last_environment[i]};
}

/// True if something in one range may meet something in the other; exact for two objects.
[[gnu::always_inline]] inline bool may_meet(const FilterRange& a, const FilterRange& b) {
  // Without branches: layers are coin tosses.
  return static_cast<bool>(static_cast<unsigned>((a.layers & b.mask) != 0) &
                           static_cast<unsigned>((b.layers & a.mask) != 0) &
                           static_cast<unsigned>(a.first_environment <= b.last_environment) &
                           static_cast<unsigned>(b.first_environment <= a.last_environment));
}

/// What is below node i of a level of a tree without environments, as a span.
static inline FilterSpan span_of(const NodeFilters& nodes, std::uint32_t i) {
  FilterSpan span;
  span.any_layers = nodes.layers[i];
  span.every_layers = nodes.every_layers[i];
  span.any_mask = nodes.mask[i];
  span.every_mask = nodes.every_mask[i];
  span.mute = (span.every_layers | span.every_mask) == 0;
  span.everywhere = false;
  return span;
}

/// The lanes below or above a number.
[[gnu::always_inline]] inline Mask16 below(const Uints& v, std::uint32_t number) {
  return sharing(Uints(number) - min(v, Uints(number)), ~0U);
}
[[gnu::always_inline]] inline Mask16 above(const Uints& v, std::uint32_t number) {
  return sharing(v - min(v, Uints(number)), ~0U);
}

/// The lanes from `at` on of columns of filters whose layers and masks let them meet `q`.
[[gnu::always_inline]] inline Mask16 matching_lanes(const std::uint32_t* layers,
                                                    const std::uint32_t* mask, std::size_t at,
                                                    const FilterRange& q) {
  return sharing(Uints::load_unaligned(layers + at), q.mask) &
         sharing(Uints::load_unaligned(mask + at), q.layers);
}

/// Those of the candidate rows from `first_row` on, none of them empty, that `q` may meet, by
/// their filters; `environments` is false if all share one.
[[gnu::always_inline]] inline Mask16 passing_rows(const FilterColumns& own, bool environments,
                                                  std::uint32_t first_row, Mask16 candidates,
                                                  const FilterRange& q) {
  if (own.layers == nullptr) return may_meet(range_of(ObjectFilter{}), q) ? candidates : Mask16{0};
  const Mask16 met = candidates & matching_lanes(own.layers, own.mask, first_row, q);
  // Without environments of their own objects are of the first one, or of all.
  if (!environments && q.first_environment == 0) return met;
  const Uints last = Uints::load_unaligned(own.environment + first_row);
  const Mask16 of_one = sharing(Uints(kEveryEnvironment) - last, ~0U);
  const Mask16 behind = above(last, q.last_environment) & of_one;
  return met & ~behind & ~below(last, q.first_environment);
}
[[gnu::always_inline]] inline Mask16 passing_rows(const RowView& rows, std::uint32_t first_row,
                                                  Mask16 candidates, const FilterRange& q) {
  return passing_rows(rows.filter, rows.environments, first_row, candidates, q);
}

/// Those of the candidates among 16 nodes from `first_node` of a level on that may hold something
/// that `q` may meet.
[[gnu::always_inline]] inline Mask16 passing_nodes(const TreeShape& tree, std::uint32_t level,
                                                   std::uint32_t first_node, Mask16 candidates,
                                                   const FilterRange& q) {
  const NodeFilters& nodes = tree.filters[level];
  if (nodes.layers == nullptr) {
    return may_meet(range_of(ObjectFilter{}), q) ? candidates : Mask16{0};
  }
  const Mask16 met = candidates & matching_lanes(nodes.layers, nodes.mask, first_node, q);
  // Without environments of their own objects are of the first one, or of all.
  if (!tree.environments && q.first_environment == 0) return met;
  const Uints begin = Uints::load_unaligned(nodes.first_environment + first_node);
  const Uints last = Uints::load_unaligned(nodes.last_environment + first_node);
  return met & ~above(begin, q.last_environment) & ~below(last, q.first_environment);
}

// Columns of a sphere's centre and radius.
inline constexpr int kBallCenter = 6;
inline constexpr int kBallRadius = 9;

/// Balls against one other. The right side of |distance|^2 <= (r1 + r2)^2 is enlarged by more than
/// the rounding of both sides (a few ulp of each), so that touching balls are never missed; where a
/// square would overflow or underflow the comparison still errs to the side of a hit.
[[gnu::always_inline]] inline Mask16 balls_meet(const Floats* center, const Floats& radius,
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
  // An empty row's centre is infinite, and so is its square: infinity <= infinity must not count.
  const Mask16 real = bits(center[0] <= kLargest<float>);
  return bits(square <= limit) & real;
}

/// Of the lanes `mask` of the rows from `at` on, whose boxes overlap that of row r of the columns
/// `query`, those whose further slabs do so too.
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

/// The same for spheres.
inline Mask16 spheres_overlap(const RowView& rows, std::uint32_t at, const float* const* query,
                              std::uint32_t r, Mask16 mask) {
  Floats center[3];
  float other[3];
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = Floats::load_unaligned(rows.column[kBallCenter + axis] + at);
    other[axis] = query[kBallCenter + axis][r];
  }
  const Floats radius = Floats::load_unaligned(rows.column[kBallRadius] + at);
  return mask & balls_meet(center, radius, other, query[kBallRadius][r]);
}

/// True if rows that ask about each other have to be told apart by their filters.
inline bool are_filtered(const RowView& rows) {
  return rows.filter.layers != nullptr && !rows.all_meet;
}

/// False if the sink is full and cannot grow.
inline bool has_room(PairSink& sink) {
  return sink.cursor <= sink.limit || sink.grow(sink);
}

/// The box that row r of six columns holds.
struct QueryBox {
  float low[3];
  float high[3];
  [[gnu::always_inline]] QueryBox(const float* const* column, std::size_t r)
      : low{column[0][r], column[1][r], column[2][r]},
        high{column[3][r], column[4][r], column[5][r]} {}
};

/// The lanes of the rows from `at` on that row r reports in HitMode::moved: those that did not
/// move, and those that did and stand behind r. `moved` is readable for 32 bits from any row on.
inline Mask16 reported_lanes(const std::uint64_t* moved, std::uint32_t r, std::uint32_t at) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, reinterpret_cast<const unsigned char*>(moved) + (at >> 3U), sizeof bits);
  bits >>= at & 7U;
  const Mask16 up_to_r = r < at ? 0U : r - at >= kLanes ? kAllRows : lanes_below(r - at + 1);
  return ~(bits & up_to_r);
}

/// Filters of those who ask, by their row.
struct AskingFilters {
  FilterColumns filter;
  std::uint32_t step = 1;  // 0: one for all

  explicit AskingFilters(const RowView& rows) : filter(rows.filter) {}
  explicit AskingFilters(const QueryBatch& batch)
      : filter(batch.filter), step(batch.one_filter ? 0U : 1U) {}

  [[nodiscard, gnu::always_inline]] FilterRange of(std::uint32_t row) const {
    if (filter.layers == nullptr) return range_of(ObjectFilter{});
    const std::size_t i = std::size_t{row} * step;
    return range_of({filter.layers[i], filter.mask[i], filter.environment[i]});
  }
};

/// Reports the hits `mask` among the ids at `ids` for query q; there must be room.
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

/// The lanes whose sets of bits, if they are not empty, surely share one with each of some others
/// (see surely_share).
inline Mask16 surely_sharing(const Uints& sets, std::uint32_t any, std::uint32_t every) {
  const Mask16 lack_one = sharing(Uints(any) - (sets & Uints(any)), ~0U);
  return sharing(sets, every) | ((~lack_one | ~sharing(sets, ~every)) & sharing(sets, ~0U));
}

/// Those of a batch's rows that ask, apart by whether they surely meet everything.
class SplitBatch {
 public:
  SplitBatch(const RowView& asked, const QueryBatch& batch, std::uint32_t begin) {
    const FilterSpan& all = asked.span;
    const std::uint32_t left = batch.end - begin;
    const std::uint32_t end = begin + (left < kRoom ? left : kRoom);
    for (std::uint32_t k = begin; k < end; k += kLanes) {
      const SomeFilters some(batch, k, end);
      Mask16 sure = 0;
      if (!all.mute) {
        sure = surely_sharing(some.masks, all.any_layers, all.every_layers) &
               surely_sharing(some.layers, all.any_mask, all.every_mask);
      }
      if (!all.everywhere && (all.apart || batch.environments)) sure &= some.everywhere(all.apart);
      add(some.lanes & sure, some.rows, 1);
      add(some.lanes & ~sure, some.rows, 0);
    }
  }

  /// The rows that meet all, or those that do not.
  [[nodiscard]] QueryBatch part(const QueryBatch& batch, bool meets_all) const {
    QueryBatch part = batch;
    part.rows = row_[meets_all ? 1 : 0];
    part.begin = 0;
    part.end = count_[meets_all ? 1 : 0];
    return part;
  }

  static constexpr std::uint32_t kRoom = 256;

 private:
  /// Sixteen that ask.
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
      const AskingFilters filters(batch);
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

    /// Those of every environment, or of the first one if no object is `apart` in another.
    [[nodiscard]] Mask16 everywhere(bool apart) const {
      Mask16 found = 0;
      for (Mask16 left = lanes; left != 0; left &= left - 1) {
        const std::uint32_t own = environment[first(left)];
        const bool meets_all = own == kEveryEnvironment || (own == 0 && !apart);
        found |= static_cast<Mask16>(meets_all) << first(left);
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

/// Kernel::run<Filtered>(view, batch, sink), not inlined: it is called for whole batches and for
/// parts of them.
template <typename Kernel, bool Filtered, typename View>
[[gnu::noinline]] bool run_kernel(const View& view, const QueryBatch& batch, PairSink& sink) {
  return Kernel::template run<Filtered>(view, batch, sink);
}

/// Runs a kernel with what every test asks as a constant: whether filters are in use.
template <typename Kernel, typename View>
inline bool with_filters(const View& view, const QueryBatch& batch, PairSink& sink) {
  const bool filtered = view.rows.filter.layers != nullptr || batch.filter.layers != nullptr;
  if (!filtered || batch.meets_all) return run_kernel<Kernel, false>(view, batch, sink);
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

/// True if hits of boxes are not yet hits of the rows' volumes.
inline bool has_more_to_test(const RowView& rows) {
  return rows.further_slabs != 0 || rows.spheres;
}

/// Hits of boxes, kept in lists: lanes mask[i] of the rows from at[i] on for row[i] of the columns
/// `query`. Keeps those of the volumes in the boxes, and returns how many entries are left. One for
/// all kernels of a file: what boxes alone never call must not bloat them.
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

/// Hits in such lists, without the lanes that are not reported in HitMode::moved. Returns how many
/// entries are left.
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

/// Hits on their way to the sink. Whether a test hits is a coin toss to the branch predictor: tests
/// append without a branch, and filters are looked up and pairs written in one long loop.
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
  /// For rows that ask about each other.
  HitList(const RowView& rows, PairSink& sink)
      : rows_(rows),
        query_(rows.column),
        more_to_test_(has_more_to_test(rows)),
        query_id_(rows.id),
        mode_(HitMode::unordered),
        moved_(nullptr),
        filters_(rows),
        sink_(sink) {}

  /// Notes that row `r` hits the lanes `mask` of the rows from `at` on; does nothing for no lanes.
  /// There must be room.
  void add(std::uint32_t r, std::uint32_t at, Mask16 mask) {
    row_[size_] = r;
    at_[size_] = at;
    mask_[size_] = mask;
    size_ += mask != 0 ? 1U : 0U;
  }

  /// Makes room for one more entry. False if the sink is full.
  bool make_room() { return __builtin_expect(size_ < kRoom, 1) != 0 || flush(); }

  /// Writes everything to the sink.
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
  const AskingFilters filters_;
  PairSink& sink_;
  unsigned size_ = 0;
  std::uint32_t row_[kRoom];
  std::uint32_t at_[kRoom];
  std::uint32_t mask_[kRoom];
};

/// A run of rows is tested to its end.
struct ToTheEnd {
  bool operator()(const QueryBox&, std::uint32_t) const { return true; }
};

/// Runs of rows to be tested, each against one box. How long a run is is as unpredictable as a hit:
/// one step of 16 rows of every run is made in a long loop, and runs that go on are kept for the
/// next round. `GoesOn(q, at)` says whether box q needs the rows from `at` on.
template <bool Filtered, typename GoesOn>
class RunList {
 public:
  /// `query` holds the columns of the boxes that ask.
  RunList(const RowView& rows, const float* const* query, HitList<Filtered>& hits,
          const GoesOn& goes_on, PairSink& sink)
      : rows_(rows), query_(query), hits_(hits), goes_on_(goes_on), sink_(sink) {}

  /// Adds rows [at, end) for the box of row r of the query columns. False if the sink is full.
  bool add(std::uint32_t r, std::uint32_t at, std::uint32_t end) {
    if (size_ == kRoom && !finish()) return false;
    row_[size_] = r;
    at_[size_] = at;
    end_[size_] = end;
    size_ += at < end ? 1U : 0U;
    return true;
  }

  /// Tests everything. False if the sink is full.
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
        next += at + left < end && goes_on_(q, at + left) ? 1U : 0U;
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
  const GoesOn goes_on_;
  PairSink& sink_;
  unsigned size_ = 0;
  std::uint32_t row_[kRoom + 1];
  std::uint32_t at_[kRoom + 1];
  std::uint32_t end_[kRoom + 1];
};

}  // namespace winnow::WINNOW_ISA_NAME
