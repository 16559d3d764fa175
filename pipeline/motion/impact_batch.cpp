#include "pipeline/motion/impact_batch.h"

#include "pipeline/solver/problem.h"

#include <algorithm>

namespace winnow {

WINNOW_DEFINE_KERNELS(ImpactLaneKernels, impact_lane_kernels)

namespace impact {
namespace {

constexpr std::size_t kLaneKinds = 8;
/// Of pairs without lanes.
constexpr std::size_t kNoLanes = kLaneKinds * kLaneKinds;

[[nodiscard]] std::size_t kinds_of(const ImpactQuery& query) noexcept {
  const ShapeKind a = query.shape[0].kind();
  const ShapeKind b = query.shape[1].kind();
  if (!has_impact_lanes(a) || !has_impact_lanes(b)) return kNoLanes;
  return static_cast<std::size_t>(a) * kLaneKinds + static_cast<std::size_t>(b);
}

[[nodiscard]] Impact search(const ShapeTables& tables, const ImpactQuery& query, double tolerance,
                            const Interval& within) noexcept {
  return find_impact(tables, {query.shape[0], *query.motion[0]}, {query.shape[1], *query.motion[1]},
                     tolerance, within);
}

}  // namespace

void ImpactBatch::add(std::size_t name, ShapeId a, const RigidMotion& of_a, ShapeId b,
                      const RigidMotion& of_b) noexcept {
  const bool mirrored = solver::is_prepared_mirrored(a.kind(), b.kind());
  names_[count_] = name;
  mirrored_[count_] = mirrored;
  ImpactQuery& query = queries_[count_];
  if (mirrored) {
    query = {{b, a}, {&of_b, &of_a}, 0.0, 1.0};
  } else {
    query = {{a, b}, {&of_a, &of_b}, 0.0, 1.0};
  }
  ++count_;
}

void ImpactBatch::sort_by_kinds() noexcept {
  std::array<std::uint16_t, kNoLanes + 2> first{};
  for (std::size_t i = 0; i < count_; ++i) ++first[kinds_of(queries_[i]) + 1];
  for (std::size_t k = 1; k < first.size(); ++k) {
    first[k] = static_cast<std::uint16_t>(first[k] + first[k - 1]);
  }
  for (std::size_t i = 0; i < count_; ++i) {
    order_[first[kinds_of(queries_[i])]++] = static_cast<std::uint16_t>(i);
  }
}

Impact ImpactBatch::found_of(const ImpactQuery& query, const ImpactLane& lane) const noexcept {
  if (lane.verdict == ImpactVerdict::unsure) {
    return search(tables_, query, tolerance_, {lane.time, query.last});
  }
  Impact impact;
  if (lane.verdict == ImpactVerdict::apart) return impact;
  impact.hit = true;
  impact.time = lane.time;
  impact.gap = lane.gap;
  impact.error_bound = lane.error_bound;
  std::copy_n(lane.normal, 3, impact.normal);
  std::copy_n(lane.point, 3, impact.point);
  return impact;
}

/// Of one pair of kinds.
void ImpactBatch::find_in_lanes(std::size_t begin, std::size_t end) noexcept {
  std::array<ImpactQuery, kImpactJobQueries> queries;
  std::array<ImpactLane, kImpactJobQueries> lanes;
  ImpactJob job{tables_, queries.data(), 0, tolerance_, lanes.data()};
  for (; begin < end; begin += job.count) {
    job.count = static_cast<std::uint32_t>(std::min<std::size_t>(end - begin, kImpactJobQueries));
    for (std::uint32_t i = 0; i < job.count; ++i) queries[i] = queries_[order_[begin + i]];
    impact_lane_kernels().run(job);
    for (std::uint32_t i = 0; i < job.count; ++i) {
      found_[order_[begin + i]] = found_of(queries[i], lanes[i]);
    }
  }
}

void ImpactBatch::find() noexcept {
  sort_by_kinds();
  std::size_t at = 0;
  while (at < count_) {
    const std::size_t kinds = kinds_of(queries_[order_[at]]);
    std::size_t end = at + 1;
    while (end < count_ && kinds_of(queries_[order_[end]]) == kinds) ++end;
    if (kinds != kNoLanes) {
      find_in_lanes(at, end);
    } else {
      for (; at < end; ++at) {
        const ImpactQuery& query = queries_[order_[at]];
        found_[order_[at]] = search(tables_, query, tolerance_, {query.first, query.last});
      }
    }
    at = end;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    if (!mirrored_[i] || !found_[i].hit) continue;
    mirror_impact(*queries_[i].motion[1], *queries_[i].motion[0], found_[i]);
  }
}

}  // namespace impact
}  // namespace winnow
