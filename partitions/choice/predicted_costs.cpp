// Adds up StructureCosts (structures/costs.h) for each candidate; see predicted_costs.h.

#include "partitions/choice/predicted_costs.h"

#include "partitions/structures/structure.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr double kNearest = 4.0;  // cost of a nearest query, relative to a ray or a region

struct Candidates {
  std::array<StructureKind, kMaxCandidates> kinds;
  std::size_t count = 0;

  Candidates() noexcept {
    for (const StructureKind kind : all_structures()) {
      if (kind.info()->costs != nullptr && count < kMaxCandidates) kinds[count++] = kind;
    }
  }
};

double level_of(const SceneFeatures& scene) noexcept {
  return static_cast<double>(std::bit_width(scene.objects));
}

double changed_of(const SceneFeatures& scene, const FrameWork& frame) noexcept {
  return static_cast<double>(std::min(frame.changed, scene.objects));
}

}  // namespace

std::span<const StructureKind> candidates() noexcept {
  static const Candidates all;
  return {all.kinds.data(), all.count};
}

std::array<CostTerm, kFrameTerms> frame_terms(const SceneFeatures& scene, const FrameWork& frame,
                                              double pairs) noexcept {
  using Costs = StructureCosts;
  const auto n = static_cast<double>(scene.objects);
  const double changed = changed_of(scene, frame);
  // If more than a quarter of the objects changed, pairs are found for all objects again.
  const bool much = 4.0 * changed > n;
  const auto queries = static_cast<double>(frame.pair_queries);
  const double full = much ? queries : static_cast<double>(frame.full_queries);
  const double partial = queries - full;
  const double querying = full * n + partial * changed;
  const double redone = full * pairs + partial * pairs * changed / std::max(n, 1.0);
  return {{{&Costs::frame, 1.0},
           {&Costs::keep, changed},
           {&Costs::object, full * n},
           {&Costs::level, querying * level_of(scene)},
           {&Costs::crowd, full * n * scene.crowding},
           {&Costs::square, querying * n},
           {&Costs::pair, redone},
           {&Costs::moved, partial * changed},
           {&Costs::rest, partial * n}}};
}

std::array<CostTerm, kBuildTerms> build_terms(const SceneFeatures& scene) noexcept {
  const auto n = static_cast<double>(scene.objects);
  return {{{&StructureCosts::build, n}, {&StructureCosts::build_level, n * level_of(scene)}}};
}

double sum_of(std::span<const CostTerm> terms, const StructureCosts& costs) noexcept {
  double sum = 0.0;
  for (const CostTerm& term : terms) sum += costs.*term.constant * term.times;
  return sum;
}

PredictedCosts::PredictedCosts(const SceneFeatures& scene, const FrameWork& frame,
                               double pairs) noexcept {
  const auto frame_costs = frame_terms(scene, frame, pairs);
  const auto build_costs = build_terms(scene);
  const auto n = static_cast<double>(scene.objects);
  const auto others = static_cast<double>(frame.casts + frame.regions) +
                      kNearest * static_cast<double>(frame.nearest);
  for (std::size_t k = 0; k < candidates().size(); ++k) {
    const StructureCosts& c = *candidates()[k].info()->costs;
    queries_[k] = others * (c.query + c.query_level * level_of(scene) + c.scan * n);
    if (others > 0.0) queries_[k] += c.rows * changed_of(scene, frame);
    total_[k] = sum_of(frame_costs, c) + queries_[k];
    build_[k] = sum_of(build_costs, c);
    const double kept = c.keep * changed_of(scene, frame);
    scattered_[k] = total_[k] + (c.anew == 0.0 ? build_[k] : c.anew * n - kept);
  }
}

std::size_t PredictedCosts::cheapest(double frames) const noexcept {
  std::size_t best = 0;
  for (std::size_t k = 1; k < candidates().size(); ++k) {
    if (build_[k] + frames * total_[k] < build_[best] + frames * total_[best]) best = k;
  }
  return best;
}

}  // namespace winnow
