#include "narrow/accuracy.h"

#include "engine/sample.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace winnow::bench {
namespace {

constexpr double kMostDegrees = 0.01;

double degrees_between(const double (&a)[3], const double (&b)[3]) {
  const Eigen::Vector3d u(a[0], a[1], a[2]);
  const Eigen::Vector3d v(b[0], b[1], b[2]);
  return std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / std::numbers::pi;
}

bool is_finite(const double (&v)[3]) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

class Tally {
 public:
  Tally(Accuracy& accuracy, NarrowLevel level) : to_(accuracy), level_(level) {}

  void add(const NarrowAnswer& answer, const PairTruth& truth) {
    if (!truth.known) return;
    ++to_.pairs;
    to_.wrong += answer.overlap == truth.overlap ? 0 : 1;
    if (level_ == NarrowLevel::boolean) return;
    // Manifolds are asked for without a margin: of other pairs nothing needs to be known.
    if (level_ == NarrowLevel::manifold && truth.distance > 0.0L) return;
    if (!std::isfinite(answer.distance) || !is_finite(answer.normal)) {
      ++to_.missing;
      return;
    }
    add_distance(answer, truth);
    if (truth.normal_unique) add_normal(answer, truth);
  }

  void finish() {
    to_.measured = errors_.size();
    if (errors_.empty()) return;
    const auto at = errors_.begin() + static_cast<std::ptrdiff_t>(errors_.size() * 99 / 100);
    std::nth_element(errors_.begin(), at, errors_.end());
    to_.p99_error = *at;
  }

 private:
  void add_distance(const NarrowAnswer& answer, const PairTruth& truth) {
    const long double off = std::abs(static_cast<long double>(answer.distance) - truth.distance);
    const long double scale = static_cast<long double>(truth.size) + std::abs(truth.distance);
    const auto error = static_cast<double>(off / scale);
    errors_.push_back(error);
    to_.worst_error = std::max(to_.worst_error, error);
    if (std::isnan(answer.error_bound)) return;
    to_.beyond_bound += off > static_cast<long double>(answer.error_bound) ? 1 : 0;
  }

  void add_normal(const NarrowAnswer& answer, const PairTruth& truth) {
    ++to_.normals;
    const double degrees = degrees_between(answer.normal, truth.normal);
    to_.worst_degrees = std::max(to_.worst_degrees, degrees);
    to_.normals_off += degrees > kMostDegrees ? 1 : 0;
  }

  Accuracy& to_;
  NarrowLevel level_;
  std::vector<double> errors_;
};

}  // namespace

Accuracy judge_engine(NarrowEngine& engine, NarrowLevel level, const PairSet& set,
                      std::span<const PairTruth> truths) {
  Accuracy accuracy;
  accuracy.engine = engine.name();
  accuracy.level = level;
  std::array<double, 3> ns{};
  for (double& one : ns) {
    const ThreadStopwatch clock;
    engine.run(level, set.pairs);
    one = clock.ms() * 1e6 / static_cast<double>(set.pairs.size());
  }
  accuracy.ns = median_of(ns);
  accuracy.recomputed = engine.recomputed();
  Tally tally(accuracy, level);
  for (std::size_t i = 0; i < set.pairs.size(); ++i) tally.add(engine.answer(i), truths[i]);
  tally.finish();
  return accuracy;
}

}  // namespace winnow::bench
