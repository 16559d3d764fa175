// Compares results of narrow-phase engines with reference results: computes the errors of their
// distances, depths and normals. bench/micro/pairs.cpp calls it.

#include "bench/measure/accuracy.h"

#include "bench/contenders/winnow_engines.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace winnow::bench {

namespace {

constexpr double kMaxDegrees = 0.01;

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

PairError error_of(const NarrowAnswer& answer, const oracle::Truth& truth, ContactLevel level) {
  const long double length = std::abs(truth.distance);
  PairError result;
  result.gap = static_cast<double>(length / static_cast<long double>(truth.size));
  result.overlap = truth.overlap;
  result.wrong = answer.overlap != truth.overlap;
  // Manifolds are computed without a margin, so that engines need no result for pairs that are
  // apart.
  if (level == ContactLevel::boolean) return result;
  if (level == ContactLevel::manifold && truth.distance > 0.0L) return result;
  const bool has_normal = answer.normal.all_finite() && !answer.normal.is_zero();
  const bool has_distance = std::isfinite(answer.distance);
  result.missing = !has_distance || !has_normal;
  if (has_distance) {
    const long double off = std::abs(static_cast<long double>(answer.distance) - truth.distance);
    result.error = static_cast<double>(off / (static_cast<long double>(truth.size) + length));
    result.beyond_bound = off > static_cast<long double>(answer.error_bound);
  }
  if (has_normal && truth.normal_unique) {
    result.degrees = degrees_between(answer.normal, truth.normal);
  }
  return result;
}

ErrorSpread spread_of_errors(std::vector<double>& errors) {
  if (errors.empty()) return {};
  const auto at = [&](std::size_t rank) {
    const auto place = errors.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(errors.begin(), place, errors.end());
    return *place;
  };
  const std::size_t count = errors.size();
  return {count, at(count / 2), at((count * 99 + 99) / 100 - 1), at(count - 1)};
}

}  // namespace

std::vector<oracle::Truth> truths_of(const PairSet& set) {
  std::vector<oracle::Truth> truths(set.pairs.size());
#if WINNOW_HAVE_ORACLE
  tbb::parallel_for(std::size_t{0}, truths.size(), [&](std::size_t i) {
    const auto& [a, b] = set.pairs[i];
    truths[i] =
        oracle::solve(set.pool.tables(), set.shapes[a], set.poses[a], set.shapes[b], set.poses[b]);
  });
#else
  const auto reference = make_winnow_narrow(NarrowTier::reference, 2);
  reference->start(set);
  reference->run(ContactLevel::distance, set.pairs);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const NarrowAnswer answer = reference->answer(i);
    truths[i] = {.known = true,
                 .overlap = answer.overlap,
                 .distance = static_cast<long double>(answer.distance),
                 .size = set.radius[set.pairs[i].a] + set.radius[set.pairs[i].b]};
  }
#endif
  return truths;
}

std::string judge_name() {
#if WINNOW_HAVE_ORACLE
  return "100 digits";
#else
  return "reference";
#endif
}

std::vector<PairError> errors_of(const NarrowEngine& engine, ContactLevel level, const PairSet& set,
                                 std::span<const oracle::Truth> truths) {
  std::vector<PairError> errors;
  for (std::size_t i = 0; i < set.pairs.size(); ++i) {
    if (truths[i].known) errors.push_back(error_of(engine.answer(i), truths[i], level));
  }
  return errors;
}

Accuracy summary_of(std::span<const PairError> errors) {
  Accuracy sum;
  sum.pairs = errors.size();
  std::vector<double> all;
  std::vector<double> apart;
  std::vector<double> depth;
  std::vector<double> degrees;
  for (const PairError& one : errors) {
    sum.wrong += one.wrong ? 1 : 0;
    sum.missing += one.missing ? 1 : 0;
    sum.beyond_bound += one.beyond_bound ? 1 : 0;
    sum.normals_off += one.degrees > kMaxDegrees ? 1 : 0;
    if (!std::isnan(one.degrees)) degrees.push_back(one.degrees);
    if (std::isnan(one.error)) continue;
    all.push_back(one.error);
    (one.overlap ? depth : apart).push_back(one.error);
  }
  sum.all = spread_of_errors(all);
  sum.apart = spread_of_errors(apart);
  sum.depth = spread_of_errors(depth);
  sum.degrees = spread_of_errors(degrees);
  return sum;
}

}  // namespace winnow::bench
