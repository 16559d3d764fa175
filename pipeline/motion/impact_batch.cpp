#include "pipeline/motion/impact_batch.h"

#include "pipeline/solver/problem.h"

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

}  // namespace

void ImpactBatch::add(std::size_t name, ShapeId a, const RigidMotion& of_a, ShapeId b,
                      const RigidMotion& of_b, const Interval& within) noexcept {
  const bool mirrored = solver::is_prepared_mirrored(a.kind(), b.kind());
  names_[count_] = name;
  mirrored_[count_] = mirrored;
  ImpactQuery& query = queries_[count_];
  if (mirrored) {
    query = {{b, a}, {&of_b, &of_a}, within.first, within.last};
  } else {
    query = {{a, b}, {&of_a, &of_b}, within.first, within.last};
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

void ImpactBatch::search(std::size_t i) noexcept {
  const ImpactQuery& query = queries_[i];
  found_[i] = find_impact(tables_, {query.shape[0], *query.motion[0]},
                          {query.shape[1], *query.motion[1]}, tolerance_,
                          {found_[i].time, query.last});
}

void ImpactBatch::find() noexcept {
  sort_by_kinds();
  ImpactJob job{tables_,    queries_.data(), nullptr,         0,
                tolerance_, found_.data(),   verdicts_.data()};
  for (std::size_t at = 0; at < count_; at += job.count) {
    const std::size_t kinds = kinds_of(queries_[order_[at]]);
    job.order = order_.data() + at;
    job.count = 1;
    while (at + job.count < count_ && job.count < kImpactJobQueries &&
           kinds_of(queries_[job.order[job.count]]) == kinds) {
      ++job.count;
    }
    if (kinds != kNoLanes) {
      impact_lane_kernels().run(job);
      continue;
    }
    for (std::uint32_t i = 0; i < job.count; ++i) {
      verdicts_[job.order[i]] = ImpactVerdict::unsure;
      found_[job.order[i]].time = queries_[job.order[i]].first;
    }
  }
}

}  // namespace impact
}  // namespace winnow
