#include "bench/contenders/winnow_impacts.h"

#include "bench/common/need.h"

namespace winnow::bench {

void WinnowImpacts::run(std::span<const BodyPair> pairs) {
  const PairSet& middle = *set_->middle;
  need(time_of_impact(middle.pool, {middle.shapes, set_->motions}, pairs, {}, result_),
       "moving pairs");
}

}  // namespace winnow::bench
