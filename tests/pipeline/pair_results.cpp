#include "tests/pipeline/pair_results.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace winnow::test {
namespace {

bool same_contact(const ContactPoint& p, const ContactPoint& q) {
  return p.position == q.position && p.depth == q.depth && p.feature == q.feature;
}

PairResults answer_of(const NarrowResult& result, std::size_t i) {
  PairResults answer;
  answer.overlap = result.overlaps(i);
  if (result.level() == ContactLevel::boolean) return answer;
  answer.distance = result.distance()[i];
  answer.error_bound = result.error_bound()[i];
  for (int axis = 0; axis < 3; ++axis) answer.normal[axis] = result.normal(axis)[i];
  if (result.level() == ContactLevel::distance) {
    for (int axis = 0; axis < 3; ++axis) answer.point[axis] = result.point(axis)[i];
    return answer;
  }
  const std::uint32_t first = result.contact_first()[i];
  const std::uint32_t count = result.contact_count()[i];
  EXPECT_LE(first + count, result.contacts());
  EXPECT_LE(count, kManifoldPoints);
  for (std::uint32_t k = first; k < first + count; ++k) {
    answer.contacts.push_back(result.contact(k));
  }
  return answer;
}

}  // namespace

bool same(const PairResults& p, const PairResults& q) {
  return p.overlap == q.overlap && p.distance == q.distance && p.error_bound == q.error_bound &&
         p.normal == q.normal && p.point == q.point &&
         std::equal(p.contacts.begin(), p.contacts.end(), q.contacts.begin(), q.contacts.end(),
                    same_contact);
}

std::vector<PairResults> answers_of(const NarrowResult& result, std::size_t pairs) {
  EXPECT_EQ(result.size(), pairs);
  std::vector<PairResults> answers(pairs);
  std::vector<int> seen(pairs);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint32_t pair = result.pair_of(i);
    if (pair >= pairs || seen[pair]++ != 0) {
      ADD_FAILURE() << "pair " << pair << " twice, or not one of " << pairs;
      continue;
    }
    answers[pair] = answer_of(result, i);
  }
  return answers;
}

std::vector<PairResults> compute_results(const PairScene& scene, const NarrowOptions& options) {
  NarrowPhase phase;
  NarrowResult result;
  EXPECT_EQ(phase.collide(scene.pool, scene.bodies(), scene.pairs, options, result), Status::ok);
  return answers_of(result, scene.pairs.size());
}

}  // namespace winnow::test
