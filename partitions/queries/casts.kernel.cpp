// Kernels of casts: closest, any and all hits of up to kMaxCasts casts. casts.cpp calls them. The
// casts first traverse the trees together (joint_casts.wide.h), for closest and any hits only up to
// the end of a first segment; the rest of each cast visits blocks (descent.wide.h) and tests their
// rows (cast_tests.wide.h).

#include "partitions/queries/cast.kernel.h"
#include "partitions/queries/cast_tests.wide.h"
#include "partitions/queries/joint_casts.wide.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Calls found(t, id), with exact t, for each of the 16 rows from `first_row` on that the cast
/// touches at or before `limit`; rows slightly behind the limit may be included. `found` returns
/// false to end the descent.
template <typename Found>
bool test_rows(const QueryView& view, const KernelCast& cast, const CastTest& probe,
               const CandidateFilter& candidate_filter, std::uint32_t first_row, const float& limit,
               Found&& found) {
  const ExactCastTest exact(cast, view.column);
  Mask16 mask = candidate_filter.rows(first_row, probe.test(view.column, first_row, limit));
  for (; mask != 0; mask &= mask - 1) {
    const unsigned lane = first(mask);
    const double t = exact.touch(cast, first_row + lane);
    if (t < 0.0) continue;
    if (!found(t, view.id[first_row + lane])) return false;
  }
  return true;
}

inline std::uint64_t hit_of(double t, std::uint32_t id) {
  return std::uint64_t{order_of_rounded_down(t)} << 32U | id;
}

/// Keeps the least hit of every cast.
class NearestHits {
 public:
  NearestHits(const KernelCast* casts, const CandidateFilter& candidate_filter, std::uint64_t* best,
              float* limit)
      : casts_(casts), candidate_filter_(candidate_filter), best_(best), limit_(limit) {}

  static bool make_room() { return true; }
  void touched(std::uint32_t s, double t, std::uint32_t id) {
    const std::uint64_t hit = hit_of(t, id);
    if (candidate_filter_.has_predicate() && (hit >= best_[s] || !candidate_filter_.accepts(id)))
      return;
    // Branchless: the comparison is unpredictable.
    const std::uint64_t best = hit < best_[s] ? hit : best_[s];
    best_[s] = best;
    // The limit is that of the next float t, because an object with the same rounded t may have a
    // smaller id.
    const float next_t = value_of(static_cast<std::uint32_t>(best >> 32U) + 1);
    const float next_limit = scaled_limit(casts_[s], static_cast<double>(next_t));
    limit_[s] = next_limit < limit_[s] ? next_limit : limit_[s];
  }

 private:
  const KernelCast* casts_;
  const CandidateFilter& candidate_filter_;
  std::uint64_t* best_;
  float* limit_;
};

/// Keeps the first found hit of every cast, and ends that cast.
class AnyHits {
 public:
  AnyHits(const KernelCast*, const CandidateFilter& candidate_filter, std::uint64_t* found,
          float* limit)
      : candidate_filter_(candidate_filter), found_(found), limit_(limit) {}

  static bool make_room() { return true; }
  void touched(std::uint32_t s, double t, std::uint32_t id) {
    if (found_[s] != kNoHit || !candidate_filter_.accepts(id)) return;
    found_[s] = hit_of(t, id);
    limit_[s] = kBeforeAll;
  }

 private:
  // Every cast begins at t >= 0.
  static constexpr float kBeforeAll = -1.0F;

  const CandidateFilter& candidate_filter_;
  std::uint64_t* found_;
  float* limit_;
};

/// Traces the first segment of all casts together, then each cast without a hit there on its own.
/// The segment reaches about as far as the first hits in a scene of even density.
template <typename Hits>
class FirstSegmentThenRest {
 public:
  FirstSegmentThenRest(const QueryView& view, const KernelCast* casts, std::uint32_t count,
                       const QueryFilter& filter, std::uint64_t* found)
      : view_(view),
        casts_(casts),
        candidate_filter_(view, filter),
        hits_(casts, candidate_filter_, found, limit_),
        count_(count) {
    // If there are no trees, every cast tests all rows, so the first segment is the whole cast.
    const float edge = view.leaf_edge;
    const float segment = edge > 0.0F ? kSegment * edge : __builtin_inff();
    for (std::uint32_t s = 0; s < count; ++s) {
      found[s] = kNoHit;
      from_[s] = casts[s].scaled_from;
      last_[s] = scaled_limit(casts[s], casts[s].max_t);
      // One unit of scaled t is about one unit of length.
      const float end = from_[s] + segment;
      end_[s] = limit_[s] = end < last_[s] ? end : last_[s];
    }
  }

  /// Calls visit_blocks(probe, candidate_filter, limit, test) for each cast that continues behind
  /// its segment; `visit_blocks` must call test(first_row) for blocks of rows.
  template <typename VisitBlocks>
  void run(VisitBlocks&& visit_blocks) {
    JointCasts<Hits>(view_, casts_, from_, limit_, candidate_filter_, hits_).run(count_);
    for (std::uint32_t s = 0; s < count_; ++s) {
      if (is_finished(s)) continue;
      const CastTest probe(casts_[s], end_[s]);
      float& limit = limit_[s];
      limit = last_[s];  // the next row that the cast touches lowers it to the best hit
      visit_blocks(probe, candidate_filter_, limit, [&](std::uint32_t first_row) {
        return test_rows(view_, casts_[s], probe, candidate_filter_, first_row, limit,
                         [&](double t, std::uint32_t id) {
                           hits_.touched(s, t, id);
                           return limit >= 0.0F;
                         });
      });
    }
  }

 private:
  static constexpr float kSegment = 0.4F;

  /// True if the cast ends with the segment, or if its hit is before the end of the segment by
  /// more than the rounding error of the tests.
  [[nodiscard]] bool is_finished(std::uint32_t s) const {
    return limit_[s] < end_[s] || !(end_[s] < last_[s]);
  }

  const QueryView& view_;
  const KernelCast* casts_;
  const CandidateFilter candidate_filter_;
  Hits hits_;
  std::uint32_t count_;
  // Scaled t of each cast: its start, its limit, the end of its segment, and its end.
  float from_[kMaxCasts];
  float limit_[kMaxCasts];
  float end_[kMaxCasts];
  float last_[kMaxCasts];
};

void closest(const QueryView& view, const KernelCast* casts, std::uint32_t count,
             const QueryFilter& filter, std::uint64_t* best) {
  FirstSegmentThenRest<NearestHits>(view, casts, count, filter, best)
      .run([&](const CastTest& probe, const CandidateFilter& candidate_filter, const float& limit,
               auto&& test) { visit_nearest_first(view, probe, candidate_filter, limit, test); });
}

/// Finds any hit of one cast, which needs no joint traversal.
void any_of_one(const QueryView& view, const KernelCast& cast, const QueryFilter& filter,
                std::uint64_t& found) {
  const CandidateFilter candidate_filter(view, filter);
  const CastTest probe(cast);
  const float limit = scaled_limit(cast, cast.max_t);
  found = kNoHit;
  visit_in_row_order(view, probe, candidate_filter, limit, [&](std::uint32_t first_row) {
    return test_rows(view, cast, probe, candidate_filter, first_row, limit,
                     [&](double t, std::uint32_t id) {
                       if (!candidate_filter.accepts(id)) return true;
                       found = hit_of(t, id);
                       return false;
                     });
  });
}

void any(const QueryView& view, const KernelCast* casts, std::uint32_t count,
         const QueryFilter& filter, std::uint64_t* found) {
  if (count == 1) return any_of_one(view, casts[0], filter, found[0]);
  FirstSegmentThenRest<AnyHits>(view, casts, count, filter, found)
      .run([&](const CastTest& probe, const CandidateFilter& candidate_filter, float limit,
               auto&& test) { visit_in_row_order(view, probe, candidate_filter, limit, test); });
}

/// Writes every hit.
class AllHits {
 public:
  AllHits(const CandidateFilter& candidate_filter, const std::uint32_t* query, PairSink& sink)
      : candidate_filter_(candidate_filter), query_(query), sink_(sink) {}

  /// A hit takes two pairs. A sink that is not full has room for 272 pairs, enough for 128 hits.
  bool make_room() { return has_room(sink_); }
  void touched(std::uint32_t s, double t, std::uint32_t id) {
    if (!candidate_filter_.accepts(id)) return;
    sink_.cursor[0] = query_[s];
    sink_.cursor[1] = id;
    sink_.cursor[2] = order_of_rounded_down(t);
    sink_.cursor[3] = 0;
    sink_.cursor += 4;
  }

 private:
  const CandidateFilter& candidate_filter_;
  const std::uint32_t* query_;
  PairSink& sink_;
};

bool all(const QueryView& view, const KernelCast* casts, std::uint32_t count,
         const std::uint32_t* query, const QueryFilter& filter, PairSink& sink) {
  const CandidateFilter candidate_filter(view, filter);
  float from[kMaxCasts];
  float limit[kMaxCasts];
  for (std::uint32_t s = 0; s < count; ++s) {
    from[s] = casts[s].scaled_from;
    limit[s] = scaled_limit(casts[s], casts[s].max_t);
  }
  AllHits hits(candidate_filter, query, sink);
  return JointCasts<AllHits>(view, casts, from, limit, candidate_filter, hits).run(count);
}

/// Counting rank sort: finds the position of each element by 16 comparisons at a time, without
/// data-dependent branches. The keys are the upper bits of t with the element's index in the low
/// bits, so that all keys are distinct. An insertion sort then orders elements that differ only in
/// the other bits.
void sort_few(std::uint64_t* results, std::uint32_t size) {
  alignas(64) float key[kMaxSorted];
  std::uint64_t copy[kMaxSorted];
  const std::uint32_t blocks = (size + kLanes - 1) / kLanes;
  for (std::uint32_t i = 0; i < size; ++i) {
    copy[i] = results[i];
    const auto t = static_cast<std::uint32_t>(results[i] >> 33U);
    key[i] = value_of((t & ~(kMaxSorted - 1)) | i);
  }
  for (std::uint32_t i = size; i < blocks * kLanes; ++i) key[i] = __builtin_inff();
  for (std::uint32_t i = 0; i < size; ++i) {
    const Floats own = Floats(key[i]);
    std::uint32_t place = blocks * kLanes;
    for (std::uint32_t b = 0; b < blocks; ++b) {
      place -= count(bits(own <= Floats::load(key + b * kLanes)));
    }
    results[place] = copy[i];
  }
  for (std::uint32_t i = 1; i < size; ++i) {
    const std::uint64_t moved = results[i];
    std::uint32_t place = i;
    for (; place > 0 && results[place - 1] > moved; --place) results[place] = results[place - 1];
    results[place] = moved;
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const CastKernels WINNOW_KERNEL_TABLE(cast_kernels) = {
    WINNOW_ISA_NAME::closest, WINNOW_ISA_NAME::any, WINNOW_ISA_NAME::all,
    WINNOW_ISA_NAME::sort_few};

}  // namespace winnow
