// First impacts of candidate pairs. A pair whose bounding balls do not overlap in time is skipped.
// With `first_only`, pairs are processed in rounds, ordered by the time at which their balls
// overlap, and a pair is skipped if all of its moving bodies have an earlier impact.
// ContinuousCollision (continuous_collision.cpp) calls this after continuous_candidates.cpp.

#include "core/sort/radix_sort.h"
#include "pipeline/motion/impact_batch.h"
#include "pipeline/scene/continuous_state.h"
#include "pipeline/shapes/two_diff.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <tuple>

namespace winnow {
namespace {

constexpr std::size_t kCandidatesPerRange = 256;
/// Pairs in a round. The impacts of a round may exclude pairs of later rounds.
constexpr std::size_t kPairsPerRound = 1024;
/// Bits of the time by which candidates are sorted, in steps.
constexpr unsigned kTimeBits = 11;
constexpr double kTimeSteps = (1U << kTimeBits) - 1U;
/// Marks a candidate whose balls never overlap.
constexpr std::uint64_t kNoChance = ~std::uint64_t{0};
constexpr std::size_t kPairsAhead = 16;
/// Exceeds the rounding error of times, and the relative rounding error of ball sizes.
constexpr double kRounding = 1e-9;

/// Uninitialized storage for a motion.
union MotionRoom {
  MotionRoom() noexcept {}
  RigidMotion motion;
};

}  // namespace

Approach ContinuousState::approach_of(std::uint32_t a, std::uint32_t b,
                                      double tolerance) const noexcept {
  MovingBall room[2];
  const MovingBall& of_a = ball_of(a, room[0]);
  const MovingBall& of_b = ball_of(b, room[1]);
  return {Eigen::Vector3d::Map(difference(of_b.start, of_a.start).difference),
          Eigen::Vector3d::Map(of_b.travel) - Eigen::Vector3d::Map(of_a.travel),
          (of_a.radius + of_b.radius) * (1.0 + tolerance)};
}

/// Computes the first impacts of at most one batch of pairs. Writes an element of `impacts_of` only
/// if it sets `hits_of` to 1.
void ContinuousState::find_impacts(std::span<const CandidatePair> requested,
                                   const ContinuousOptions& options, impact::BodyImpact* impacts_of,
                                   std::uint8_t* hits_of) const noexcept {
  const auto answer = [&](std::size_t i, const impact::BodyImpact& found_impact) {
    const impact::Impact& impact = found_impact.impact;
    hits_of[i] = impact.hit && (options.touching || !touches_at_start(impact)) ? 1 : 0;
    if (hits_of[i] != 0) impacts_of[i] = found_impact;
  };
  impact::ImpactBatch batch(bodies.shapes.tables(), options.tolerance);
  std::array<MotionRoom, impact::ImpactBatch::kRoom> stationary;
  // At most one body of a pair is at rest.
  const auto motion = [&](std::size_t i, std::uint32_t body) -> const RigidMotion& {
    if (mover_of[body] != kNoMover) return motions[mover_of[body]];
    return *std::construct_at(&stationary[i].motion, RigidMotion::stationary(bodies.pose[body]));
  };
  const auto answer_single = [&](std::size_t i) {
    const auto [a, b] = bodies_of(requested[i].candidate);
    const impact::ImpactRequest request{
        options.tolerance, approach_of(a, b, 0.0).window(), 1.0,
        options.touching ? impact::StartTouch::impact : impact::StartTouch::ignored};
    answer(i, impact::find_impact_of_balls(parts, {bodies.shape[a], motion(i, a)},
                                           {bodies.shape[b], motion(i, b)}, request));
  };
  for (std::size_t i = 0; i < requested.size(); ++i) {
    const auto [a, b] = bodies_of(requested[i].candidate);
    hits_of[i] = 0;
    if (approach_of(a, b, 0.0).begin() == kNever) continue;
    if (impact::ImpactBatch::takes(bodies.shape[a], bodies.shape[b])) {
      batch.add(i, bodies.shape[a], motion(i, a), bodies.shape[b], motion(i, b),
                requested[i].until);
    } else {
      answer_single(i);
    }
  }
  batch.run([&](std::size_t i, const impact::Impact& impact, bool) {
    // The shapes nearly touch at the start, and may slide.
    const bool may_slide =
        !options.touching && impact.hit && impact.time == 0.0 && impact.gap > 0.0;
    if (may_slide) return answer_single(i);
    answer(i, {impact});
  });
}

/// Finds the first impact of every pair.
Status ContinuousState::find_all(const ContinuousOptions& options) {
  if (!found.resize(candidates.size()) || !hits.resize(candidates.size())) {
    return Status::out_of_memory;
  }
  for_each_range(bodies.options.execution, candidates.size(), impact::ImpactBatch::kRoom,
                 [&](std::size_t begin, std::size_t end) {
                   std::array<CandidatePair, impact::ImpactBatch::kRoom> requested;
                   for (std::size_t i = begin; i < end; ++i) {
                     requested[i - begin] = {static_cast<std::uint32_t>(i), 1.0};
                   }
                   find_impacts({requested.data(), end - begin}, options, found.data() + begin,
                                hits.data() + begin);
                 });
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    if (hits[i] != 0 && !order.push_back({found[i].impact.time, i, i})) {
      return Status::out_of_memory;
    }
  }
  return Status::ok;
}

/// Returns kNoChance if the candidate has no impact. Otherwise the upper half of the result is the
/// time step before which the candidate has no impact, and the lower half is the number of the
/// candidate.
std::uint64_t ContinuousState::chance_of(std::size_t candidate, double tolerance) const noexcept {
  const auto [a, b] = bodies_of(candidate);
  // A gap within the tolerance is an impact, and rounding may make it earlier.
  const double contact_time = approach_of(a, b, tolerance + kRounding).begin();
  if (contact_time == kNever) return kNoChance;
  const double soonest = std::max(0.0, contact_time - kRounding);
  return static_cast<std::uint64_t>(soonest * kTimeSteps) << 32U | candidate;
}

/// Lists the candidates whose balls overlap, the earliest overlap first.
Status ContinuousState::list_chances(double tolerance) {
  const std::size_t count = candidates.size();
  if (!chances.resize(count)) return Status::out_of_memory;
  for_each_range(bodies.options.execution, count, kCandidatesPerRange,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) {
                     if (i + kPairsAhead < end) fetch_ball(i + kPairsAhead);
                     chances[i] = chance_of(i, tolerance);
                   }
                 });
  std::uint64_t* const end = std::remove(chances.begin(), chances.end(), kNoChance);
  const auto size = static_cast<std::size_t>(end - chances.begin());
  const std::uint64_t* const sorted =
      radix_sort(chances.data(), spare.data(), size, kTimeBits, bodies.options.execution);
  if (sorted != chances.data()) std::copy_n(sorted, size, chances.data());
  chances.set_size(size);
  return Status::ok;
}

/// Fills a round with candidates from `at` on that may be the first impact of a body. Returns false
/// if memory is refused.
bool ContinuousState::list_round(std::size_t& at) noexcept {
  listed.clear();
  for (; at < chances.size() && listed.size() < kPairsPerRound; ++at) {
    if (at + kPairsAhead < chances.size()) {
      __builtin_prefetch(&candidates[static_cast<std::uint32_t>(chances[at + kPairsAhead])]);
    }
    const auto candidate = static_cast<std::uint32_t>(chances[at]);
    double latest = 0.0;
    for (const std::uint32_t body : bodies_of(candidate)) {
      const std::uint32_t mover = mover_of[body];
      if (mover != kNoMover) latest = std::max(latest, first_time[mover]);
    }
    // Times are compared in whole steps, plus one step for rounding.
    if (static_cast<double>(chances[at] >> 32U) > latest * kTimeSteps + 1.0) continue;
    if (!listed.push_back({candidate, latest})) return false;
  }
  return sort_round() && answers.resize(round.size()) && hits.resize(round.size());
}

/// Sorts the pairs of a round by shape kinds, so that batches have few kinds.
bool ContinuousState::sort_round() noexcept {
  constexpr std::size_t kKinds = 16;
  const auto kinds_of = [&](const CandidatePair& pair) {
    const auto [a, b] = bodies_of(pair.candidate);
    const auto kind = [&](std::uint32_t body) {
      return static_cast<std::size_t>(bodies.shape[body].kind()) % kKinds;
    };
    return std::min(kind(a), kind(b)) * kKinds + std::max(kind(a), kind(b));
  };
  if (!round.resize(listed.size())) return false;
  std::array<std::uint32_t, kKinds * kKinds + 1> place{};
  for (const CandidatePair& pair : listed) ++place[kinds_of(pair) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  for (const CandidatePair& pair : listed) round[place[kinds_of(pair)]++] = pair;
  return true;
}

/// Updates the first impact of each of the two bodies.
void ContinuousState::keep_first(std::uint32_t candidate,
                                 const impact::BodyImpact& impact) noexcept {
  for (const std::uint32_t body : bodies_of(candidate)) {
    const std::uint32_t mover = mover_of[body];
    if (mover == kNoMover) continue;
    if (first[mover] != kNoImpact &&
        std::tuple(first_time[mover], first[mover]) <= std::tuple(impact.impact.time, candidate)) {
      continue;
    }
    found[mover] = impact;
    first_time[mover] = impact.impact.time;
    first[mover] = candidate;
  }
}

Status ContinuousState::find_first(const ContinuousOptions& options) {
  if (const Status status = list_chances(options.tolerance); status != Status::ok) return status;
  const std::size_t count = movers.size();
  if (!found.resize(count) || !first_time.resize(count)) return Status::out_of_memory;
  std::fill(first_time.begin(), first_time.end(), 1.0);
  std::fill(first.begin(), first.end(), kNoImpact);
  for (std::size_t at = 0; at < chances.size();) {
    if (!list_round(at)) return Status::out_of_memory;
    for_each_range(bodies.options.execution, round.size(), impact::ImpactBatch::kRoom,
                   [&](std::size_t begin, std::size_t end) {
                     find_impacts({round.data() + begin, end - begin}, options,
                                  answers.data() + begin, hits.data() + begin);
                   });
    for (std::size_t i = 0; i < round.size(); ++i) {
      if (hits[i] != 0) keep_first(round[i].candidate, answers[i]);
    }
  }
  for (std::uint32_t mover = 0; mover < count; ++mover) {
    if (first[mover] == kNoImpact) continue;
    // An impact that is the first one of both bodies is listed once.
    const bool shown_before = std::ranges::any_of(bodies_of(first[mover]), [&](std::uint32_t body) {
      const std::uint32_t other = mover_of[body];
      return other < mover && first[other] == first[mover];
    });
    if (shown_before) continue;
    if (!order.push_back({first_time[mover], first[mover], mover})) return Status::out_of_memory;
  }
  return Status::ok;
}

SceneImpact ContinuousState::shown(std::uint64_t candidate,
                                   const impact::BodyImpact& of_bodies) const noexcept {
  const impact::Impact& impact = of_bodies.impact;
  SceneImpact result;
  result.a = bodies.keys.key_of(static_cast<std::uint32_t>(candidate >> 32U));
  result.b = bodies.keys.key_of(static_cast<std::uint32_t>(candidate));
  result.data_a = bodies.keys.client_data(result.a.id);
  result.data_b = bodies.keys.client_data(result.b.id);
  result.part_a = of_bodies.part_a;
  result.part_b = of_bodies.part_b;
  result.time = impact.time;
  result.gap = impact.gap;
  result.error_bound = impact.error_bound;
  const RigidMotion of_a = motion_of(result.a.id);
  for (int i = 0; i < 3; ++i) {
    result.normal[i] = impact.normal[i];
    result.point[i] = of_a.start.position[i] + impact.time * of_a.travel[i] + impact.point[i];
  }
  return result;
}

/// Sorts and writes the impacts, and finds the index of each mover's first impact. Returns false if
/// memory is refused.
bool ContinuousState::show_impacts() noexcept {
  // Candidate numbers are in the order of body ids.
  std::sort(order.begin(), order.end(), [](const FoundImpact& a, const FoundImpact& b) {
    return std::tuple(a.time, a.candidate) < std::tuple(b.time, b.candidate);
  });
  if (!impacts.resize(order.size())) return false;
  for_each_range(bodies.options.execution, order.size(), kMoversPerRange,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t i = begin; i < end; ++i) {
                     impacts[i] = shown(candidates[order[i].candidate], found[order[i].at]);
                   }
                 });
  std::fill(first.begin(), first.end(), kNoImpact);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    for (const std::uint32_t body : bodies_of(order[i].candidate)) {
      const std::uint32_t mover = mover_of[body];
      if (mover != kNoMover) first[mover] = std::min(first[mover], i);
    }
  }
  return true;
}

}  // namespace winnow
