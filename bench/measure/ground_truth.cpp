#include "bench/measure/ground_truth.h"

#include "bench/contenders/winnow_narrow.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#if WINNOW_HAVE_ORACLE
#include "bench/oracle/oracle.h"
#endif

namespace winnow::bench {
namespace {

#if WINNOW_HAVE_ORACLE
PairTruth query_oracle(const PairSet& set, const BodyPair& pair) {
  const oracle::Truth truth =
      oracle::solve(set.pool.tables(), set.shapes[pair.a], set.poses[pair.a], set.shapes[pair.b],
                    set.poses[pair.b]);
  PairTruth result{.known = truth.known,
                   .overlap = truth.overlap,
                   .distance = truth.distance,
                   .normal_unique = truth.normal_unique,
                   .size = truth.size};
  result.normal = truth.normal;
  return result;
}
#else

std::vector<PairTruth> query_reference(const PairSet& set) {
  WinnowNarrow reference(NarrowTier::reference, 2);
  reference.start(set);
  reference.run(ContactLevel::distance, set.pairs);
  std::vector<PairTruth> truths(set.pairs.size());
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const NarrowAnswer answer = reference.answer(i);
    const BodyPair& pair = set.pairs[i];
    truths[i].known = true;
    truths[i].overlap = answer.overlap;
    truths[i].distance = static_cast<long double>(answer.distance);
    truths[i].size = set.radius[pair.a] + set.radius[pair.b];
  }
  return truths;
}
#endif

}  // namespace

std::vector<PairTruth> truths_of(const PairSet& set) {
#if WINNOW_HAVE_ORACLE
  std::vector<PairTruth> truths(set.pairs.size());
  tbb::parallel_for(std::size_t{0}, truths.size(),
                    [&](std::size_t i) { truths[i] = query_oracle(set, set.pairs[i]); });
  return truths;
#else
  return query_reference(set);
#endif
}

std::string judge_name() {
#if WINNOW_HAVE_ORACLE
  return "100 digits";
#else
  return "reference";
#endif
}

}  // namespace winnow::bench
