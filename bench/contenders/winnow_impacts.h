#pragma once

#include <winnow/pipeline/time_of_impact.h>
#include "bench/common/need.h"
#include "bench/contenders/impact_engine.h"

namespace winnow::bench {

/// winnow's `time_of_impact`, on one thread.
class WinnowImpacts final : public ImpactEngine {
 public:
  [[nodiscard]] std::string name() const override { return "winnow"; }
  [[nodiscard]] bool takes(const PairKind&, PairTurn) const override { return true; }
  void start(const MovingPairSet& set) override { set_ = &set; }
  /// Throws std::runtime_error if winnow returns an error.
  void run(std::span<const BodyPair> pairs) override {
    const PairSet& middle = *set_->middle;
    need(time_of_impact(middle.pool, {middle.shapes, set_->motions}, pairs, {}, result_),
         "moving pairs");
  }
  [[nodiscard]] ImpactAnswer answer(std::size_t i) const override {
    return {result_.hits(i), result_.time()[i]};
  }

 private:
  const MovingPairSet* set_ = nullptr;
  ImpactResult result_;
};

}  // namespace winnow::bench
