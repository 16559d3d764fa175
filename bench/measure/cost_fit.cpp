// Fits the cost constants of AutoPartition's candidates to measured times: first least squares for
// each candidate, then a search for constants that choose better. commands/fit.cpp calls it.

#include "bench/measure/cost_fit.h"

#include "bench/common/sample.h"
#include "bench/measure/advice.h"
#include "partitions/structures/structure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

namespace winnow::bench {
namespace {

/// A scene in which only a share of the objects moves per frame: in each frame the next few objects
/// get their boxes of the given scene, and all other boxes stay.
class SomeMoving final : public FrameSource {
 public:
  SomeMoving(std::unique_ptr<FrameSource> scene, double share)
      : scene_(std::move(scene)), boxes_(scene_->boxes().begin(), scene_->boxes().end()) {
    const auto all = static_cast<double>(boxes_.size());
    movers_ = std::max<std::size_t>(1, static_cast<std::size_t>(share * all));
  }

  [[nodiscard]] std::string name() const override { return scene_->name(); }
  [[nodiscard]] Aabb world() const override { return scene_->world(); }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return boxes_; }
  bool advance() override {
    if (!scene_->advance()) return false;
    // The stride spreads the moving objects over the scene, like bodies that wake independently.
    constexpr std::size_t kStride = 7919;
    for (std::size_t k = 0; k < movers_; ++k) {
      next_ = (next_ + kStride) % boxes_.size();
      boxes_[next_] = scene_->boxes()[next_];
    }
    return true;
  }

 private:
  std::unique_ptr<FrameSource> scene_;
  std::vector<Aabb> boxes_;
  std::size_t movers_;
  std::size_t next_ = 0;
};

/// Mean without the slowest 2 % of the values, which other load on the machine may have disturbed.
double mean_without_outliers(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.resize(values.size() - values.size() / 50);
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::vector<std::string> candidate_names() {
  std::vector<std::string> names;
  for (const StructureKind kind : candidates()) names.emplace_back(kind.name());
  return names;
}

/// One equation: the sum of terms times constants equals a time.
template <std::size_t N>
struct Equation {
  std::array<CostTerm, N> terms;
  double time;
  double weight;
};

/// Finds nonnegative constants with the least sum of squared weighted errors.
template <std::size_t N>
void solve(const std::vector<Equation<N>>& equations, StructureCosts& costs) {
  constexpr int kIterations = 20'000;
  if (equations.empty()) return;
  std::array<std::array<double, N>, N> square{};
  std::array<double, N> right{};
  for (const Equation<N>& one : equations) {
    const double w = one.weight * one.weight;
    for (std::size_t i = 0; i < N; ++i) {
      right[i] += w * one.terms[i].times * one.time;
      for (std::size_t j = 0; j < N; ++j) {
        square[i][j] += w * one.terms[i].times * one.terms[j].times;
      }
    }
  }
  std::array<double, N> x{};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < N; ++i) {
      if (!(square[i][i] > 0.0)) continue;
      const double sum = std::inner_product(x.begin(), x.end(), square[i].begin(), 0.0);
      x[i] = std::max(0.0, x[i] + (right[i] - sum) / square[i][i]);
    }
  }
  for (std::size_t i = 0; i < N; ++i) costs.*equations.front().terms[i].constant = x[i];
}

double least_of(const std::vector<double>& times) {
  return *std::min_element(times.begin(), times.end());
}

/// Predicted times of the frames of all samples, and the cost of choosing by them.
class ChoiceLoss {
 public:
  ChoiceLoss(const std::vector<CostSample>& samples, const std::vector<StructureCosts>& costs)
      : samples_(samples) {
    for (const CostSample& sample : samples) {
      terms_.push_back(frame_terms(sample.features, sample.work, sample.pairs));
      std::vector<double>& predicted = predicted_.emplace_back();
      for (const StructureCosts& c : costs) predicted.push_back(sum_of(terms_.back(), c));
    }
  }

  /// Updates the predictions for candidate k.
  void update(std::size_t k, const StructureCosts& costs) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      predicted_[i][k] = sum_of(terms_[i], costs);
    }
  }

  /// Sum over the samples of the chosen time over the best, minus 1. Candidates with similar
  /// predictions are weighted as equally likely choices, so that a lucky tie does not count as
  /// success. Prediction errors have a small weight, so that constants keep their meaning.
  [[nodiscard]] double loss() const {
    constexpr double kErrors = 0.05;
    double sum = 0.0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::vector<double>& times = samples_[i].frame;
      const double least = least_of(times);
      sum += regret(predicted_[i], times) - 1.0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        const double error = std::log(std::max(predicted_[i][k], 1.0) / times[k]);
        sum += kErrors * least / times[k] * error * error;
      }
    }
    return sum;
  }

 private:
  static double regret(const std::vector<double>& predicted, const std::vector<double>& times) {
    constexpr double kTie = 0.05;  // predictions within this relative difference count as ties
    const double least = least_of(predicted);
    double weights = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double weight = std::exp((1.0 - predicted[k] / least) / kTie);
      weights += weight;
      sum += weight * times[k];
    }
    return sum / (weights * least_of(times));
  }

  const std::vector<CostSample>& samples_;
  std::vector<std::array<CostTerm, kFrameTerms>> terms_;
  std::vector<std::vector<double>> predicted_;
};

/// Coordinate search: changes each constant up and down in turn, with decreasing steps, and keeps
/// each change that reduces the loss.
void choose_better(const std::vector<CostSample>& samples, std::vector<StructureCosts>& costs) {
  constexpr double kAtFirst = 0.5;
  constexpr double kAtLast = 0.01;
  constexpr int kRounds = 12;
  // First value for constants that are zero: a hundredth of the nanoseconds of a typical object.
  constexpr double kMinTerm = 0.01;
  if (samples.empty()) return;
  ChoiceLoss judgement(samples, costs);
  const auto terms = frame_terms(samples[0].features, samples[0].work, samples[0].pairs);
  double loss = judgement.loss();
  for (double step = kAtFirst; step > kAtLast; step /= 1.5) {
    for (int round = 0; round < kRounds; ++round) {
      const double before = loss;
      for (std::size_t k = 0; k < costs.size(); ++k) {
        for (const CostTerm& term : terms) {
          for (const double factor : {1.0 + step, 1.0 / (1.0 + step)}) {
            const double held = costs[k].*term.constant;
            costs[k].*term.constant = std::max(held, factor > 1.0 ? kMinTerm : 0.0) * factor;
            judgement.update(k, costs[k]);
            const double now = judgement.loss();
            if (now < loss) {
              loss = now;
            } else {
              costs[k].*term.constant = held;
              judgement.update(k, costs[k]);
            }
          }
        }
      }
      if (loss > 0.999 * before) break;
    }
  }
}

/// Median relative error of the predicted frame time of candidate k.
double median_error(const std::vector<CostSample>& samples, const StructureCosts& costs,
                    std::size_t k) {
  std::vector<double> errors;
  for (const CostSample& sample : samples) {
    const auto terms = frame_terms(sample.features, sample.work, sample.pairs);
    errors.push_back(std::abs(sum_of(terms, costs) / sample.frame[k] - 1.0));
  }
  return median_of(std::move(errors));
}

}  // namespace

std::unique_ptr<FrameSource> some_moving(std::unique_ptr<FrameSource> scene, double share) {
  if (share >= 1.0 || scene->objects() != scene->boxes().size()) return scene;
  return std::make_unique<SomeMoving>(std::move(scene), share);
}

CostSample measure_costs(FrameSource& scene, double moving, std::size_t frames) {
  std::vector<std::string> names = candidate_names();
  names.emplace_back(automatic().name());
  const Advice advice = advise(scene, names, frames, 1);
  CostSample sample;
  sample.scene = advice.scene;
  sample.moving = moving;
  sample.features = advice.features;
  sample.features.objects = advice.objects;
  sample.pairs = advice.pairs;
  sample.work.changed =
      static_cast<std::size_t>(std::lround(advice.moving * static_cast<double>(advice.objects)));
  sample.work.pair_queries = 1;
  names.pop_back();
  for (const std::string& name : names) {
    for (const Advised& one : advice.ranking) {
      if (one.partition != name) continue;
      const double mean = mean_without_outliers(one.settled);
      sample.frame.push_back(1e6 * 0.5 * (one.median_ms + mean));
      sample.first.push_back(1e6 * one.first_ms);
    }
  }
  return sample;
}

std::vector<StructureCosts> present_costs() {
  std::vector<StructureCosts> costs;
  for (const StructureKind kind : candidates()) costs.push_back(*kind.info()->costs);
  return costs;
}

FittedCosts fit_costs(const std::vector<CostSample>& samples) {
  FittedCosts fitted;
  fitted.costs = present_costs();
  for (std::size_t k = 0; k < fitted.costs.size(); ++k) {
    StructureCosts& costs = fitted.costs[k];
    std::vector<Equation<kFrameTerms>> frames;
    std::vector<Equation<kBuildTerms>> builds;
    for (const CostSample& sample : samples) {
      const double time = sample.frame[k];
      const auto terms = frame_terms(sample.features, sample.work, sample.pairs);
      frames.push_back({terms, time, std::sqrt(least_of(sample.frame) / time) / time});
    }
    solve(frames, costs);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      // The first frame consists of a build and a frame in which all objects count as changed.
      FrameWork all = samples[i].work;
      all.changed = samples[i].features.objects;
      const auto terms = frame_terms(samples[i].features, all, samples[i].pairs);
      const double build = std::max(0.0, samples[i].first[k] - sum_of(terms, costs));
      builds.push_back({build_terms(samples[i].features), build, 1.0 / samples[i].first[k]});
    }
    solve(builds, costs);
  }
  choose_better(samples, fitted.costs);
  for (std::size_t k = 0; k < fitted.costs.size(); ++k) {
    fitted.error.push_back(median_error(samples, fitted.costs[k], k));
  }
  return fitted;
}

double regret_of(const CostSample& sample, const std::vector<StructureCosts>& costs,
                 std::size_t& chosen, std::size_t& best) {
  const auto terms = frame_terms(sample.features, sample.work, sample.pairs);
  chosen = best = 0;
  for (std::size_t k = 1; k < costs.size(); ++k) {
    if (sum_of(terms, costs[k]) < sum_of(terms, costs[chosen])) chosen = k;
    if (sample.frame[k] < sample.frame[best]) best = k;
  }
  return sample.frame[chosen] / sample.frame[best];
}

}  // namespace winnow::bench
