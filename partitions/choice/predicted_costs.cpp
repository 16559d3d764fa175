#include "partitions/choice/predicted_costs.h"

#include "partitions/structures/costs.h"
#include "partitions/structures/structure.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr double kNearest = 4.0;  // times what a ray or box costs

struct Candidates {
  std::array<StructureKind, kMostCandidates> kinds;
  std::size_t count = 0;

  Candidates() noexcept {
    for (const StructureKind kind : all_structures()) {
      if (kind.info()->costs != nullptr && count < kMostCandidates) kinds[count++] = kind;
    }
  }
};

}  // namespace

std::span<const StructureKind> candidates() noexcept {
  static const Candidates all;
  return {all.kinds.data(), all.count};
}

PredictedCosts::PredictedCosts(const SceneFeatures& scene, const FrameWork& frame,
                               double pairs) noexcept {
  const auto n = static_cast<double>(scene.objects);
  const auto changed = static_cast<double>(std::min(frame.changed, scene.objects));
  const auto level = static_cast<double>(std::bit_width(scene.objects));
  // Past a quarter of the objects no single changes are followed.
  const bool much = 4.0 * changed > n;
  const auto queries = static_cast<double>(frame.pair_queries);
  const double full = much ? queries : static_cast<double>(frame.full_queries);
  const double partial = queries - full;
  const double redone = full * pairs + partial * pairs * changed / std::max(n, 1.0);
  const auto others = static_cast<double>(frame.casts + frame.regions) +
                      kNearest * static_cast<double>(frame.nearest);
  for (std::size_t k = 0; k < candidates().size(); ++k) {
    const StructureCosts& c = *candidates()[k].info()->costs;
    const double meets = c.level * level + c.square * n;
    const double all = c.object + meets + c.crowd * scene.crowding;
    total_[k] = full * n * all + partial * (changed * (c.moved + meets) + c.rest * n);
    total_[k] += c.frame + c.keep * changed + c.pair * redone;
    queries_[k] = others * (c.ask + c.ask_level * level + c.scan * n);
    if (others > 0.0) queries_[k] += c.rows * changed;
    total_[k] += queries_[k];
    build_[k] = n * (c.build + c.build_level * level);
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
