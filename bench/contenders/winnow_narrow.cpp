#include "bench/contenders/winnow_narrow.h"

#include "bench/common/need.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {

WinnowNarrow::WinnowNarrow(NarrowTier tier, int threads)
    : options_{.tier = tier,
               .execution = threads > 1 ? Execution::parallel() : Execution::serial()} {}

void WinnowNarrow::run(ContactLevel level, std::span<const BodyPair> pairs) {
  options_.level = level;
  pairs_ = pairs;
  need(narrow_.collide(set_->pool, set_->bodies(), pairs, options_, result_), "pairs");
}

NarrowAnswer WinnowNarrow::answer(std::size_t i) const {
  // All pairs of a set are of one kind, so that the result has them in the order of the input.
  if (result_.pair_of(i) != i) throw std::logic_error("pairs of one kind changed their order");
  NarrowAnswer answer;
  answer.overlap = result_.overlaps(i);
  if (result_.level() == ContactLevel::boolean) return answer;
  answer.distance = result_.distance()[i];
  answer.error_bound = result_.error_bound()[i];
  const Pose& a = set_->poses[pairs_[i].a];
  for (int axis = 0; axis < 3; ++axis) {
    answer.normal[axis] = result_.normal(axis)[i];
    if (result_.level() == ContactLevel::distance) {
      answer.point[axis] = a.position[axis] + result_.point(axis)[i];
    }
  }
  if (result_.level() == ContactLevel::manifold) answer.contacts = result_.contact_count()[i];
  return answer;
}

double WinnowNarrow::recomputed() const {
  const NarrowStatistics& statistics = narrow_.statistics();
  const auto scalar = static_cast<double>(statistics.recomputed + statistics.without_lanes);
  return scalar / static_cast<double>(std::max<std::uint64_t>(statistics.pairs, 1));
}

void WinnowOnePair::run(ContactLevel level, std::span<const BodyPair> pairs) {
  options_.level = level;
  answers_.resize(std::max(answers_.size(), pairs.size()));
  PairAnswer found;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair pair = pairs[i];
    const Pose& a = set_->poses[pair.a];
    need(collide(set_->pool, set_->shapes[pair.a], a, set_->shapes[pair.b], set_->poses[pair.b],
                 options_, found),
         "pair");
    NarrowAnswer& answer = answers_[i];
    answer.overlap = found.overlap;
    if (level == ContactLevel::boolean) continue;
    answer.distance = found.distance;
    answer.error_bound = found.error_bound;
    for (int axis = 0; axis < 3; ++axis) {
      answer.normal[axis] = found.normal[axis];
      if (level == ContactLevel::distance) {
        answer.point[axis] = a.position[axis] + found.point[axis];
      }
    }
    answer.contacts = found.contact_count;
  }
}

}  // namespace winnow::bench
