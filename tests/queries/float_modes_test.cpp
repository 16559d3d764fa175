// All queries of boxes in every floating-point mode of a host: nothing is missed, and the results
// equal the results in the default mode. The expected results are computed in the default mode, in
// exact arithmetic.

#include <winnow/core/volumes.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <deque>
#include <functional>
#include <iterator>
#include <limits>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/float_modes.h"
#include "tests/support/tiny_boxes.h"

namespace winnow::test {
namespace {

/// The result of a query: objects or pairs, and the whole result bit by bit.
struct Answer {
  std::vector<std::uint64_t> found;
  std::vector<std::uint64_t> bits;
};

/// The expected result: every element of `all`; or, if `one_will_do`, at least one object if `all`
/// is not empty.
struct ExpectedResult {
  std::vector<std::uint64_t> all;
  bool one_will_do = false;
};

using Answers = std::vector<Answer>;

struct Tally {
  std::size_t questions = 0;
  std::size_t expected = 0;
  std::size_t missed = 0;
  std::size_t others = 0;  ///< results that differ from the default mode

  void add(Answer answer, const ExpectedResult& expected_result, const Answer& standard) {
    ++questions;
    std::sort(answer.found.begin(), answer.found.end());
    others += answer.bits == standard.bits ? 0 : 1;
    if (expected_result.one_will_do) {
      expected += expected_result.all.empty() ? 0 : 1;
      missed += !expected_result.all.empty() && answer.found.empty() ? 1 : 0;
      return;
    }
    expected += expected_result.all.size();
    for (const std::uint64_t id : expected_result.all) {
      missed += std::binary_search(answer.found.begin(), answer.found.end(), id) ? 0 : 1;
    }
  }
};

Answer answer_of(std::span<const Hit> hits) {
  Answer answer;
  for (const Hit& hit : hits) {
    if (!hit) continue;
    answer.found.push_back(hit.key.id);
    answer.bits.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(hit.t)} << 32U | hit.key.id);
  }
  return answer;
}

Answer answer_of(const PairBuffer& pairs) {
  Answer answer;
  for (const Pair& pair : pairs.pairs()) {
    answer.found.push_back(std::uint64_t{pair.first} << 32U | pair.second);
  }
  answer.bits = answer.found;
  return answer;
}

Answer answer_of(const PairEvents& events) {
  Answer answer;
  for (const KeyPair& pair : events.begun()) {
    answer.found.push_back(std::uint64_t{pair.first.id} << 32U | pair.second.id);
  }
  answer.bits = answer.found;
  return answer;
}

/// Queries of a scene: runs them in the current mode; `expected_results` has the expected results.
struct Questions {
  std::function<Answers(const Partition&)> run;
  std::vector<ExpectedResult> expected_results;
};

std::vector<Ray> rays_among(const std::vector<Cast>& casts) {
  std::vector<Ray> rays;
  for (const Cast& cast : casts) {
    if (const auto* ray = std::get_if<Ray>(&cast)) rays.push_back(*ray);
  }
  return rays;
}

void query_rays(const Partition& partition, const std::vector<Ray>& rays, Answers& answers) {
  HitBuffer all;
  const Status status = partition.all(RayBatch(rays), all);
  EXPECT_EQ(status, Status::ok);
  std::vector<Key> keys(rays.size());
  std::vector<float> t(rays.size());
  const HitColumns columns{.key = keys.data(), .t = t.data()};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    answers.push_back(status == Status::ok ? answer_of(all.of(i)) : Answer{});
  }
  for (const bool any : {false, true}) {
    EXPECT_EQ(
        any ? partition.any(RayBatch(rays), columns) : partition.closest(RayBatch(rays), columns),
        Status::ok);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit hit{keys[i], 0, t[i]};
      answers.push_back(answer_of({&hit, 1}));
    }
  }
}

ExpectedResult expected_of(const CastCandidates& candidates, bool one) {
  ExpectedResult expected_result{{}, one};
  for (const auto& candidate : candidates) {
    if (candidate.truth.must) expected_result.all.push_back(candidate.id);
  }
  return expected_result;
}

Questions casts_of(const QuestionSet& set) {
  Questions questions;
  const std::vector<Ray> rays = rays_among(set.casts);
  questions.run = [&set, rays](const Partition& partition) {
    Answers answers;
    for (const Cast& cast : set.casts) {
      HitBuffer all;
      Hit closest;
      Hit any;
      EXPECT_EQ(partition.all(cast, all), Status::ok);
      closest = expect_ok(partition.closest(cast));
      any = expect_ok(partition.any(cast));
      answers.push_back(answer_of(all.hits()));
      answers.push_back(answer_of({&closest, 1}));
      answers.push_back(answer_of({&any, 1}));
    }
    query_rays(partition, rays, answers);
    return answers;
  };
  for (const CastCandidates& truth : set.cast_truths) {
    for (const bool one : {false, true, true})
      questions.expected_results.push_back(expected_of(truth, one));
  }
  for (const bool one : {false, true, true}) {
    for (std::size_t i = 0; i < set.casts.size(); ++i) {
      if (!std::holds_alternative<Ray>(set.casts[i])) continue;
      questions.expected_results.push_back(expected_of(set.cast_truths[i], one));
    }
  }
  return questions;
}

Questions regions_of(const QuestionSet& set) {
  Questions questions;
  questions.run = [&set](const Partition& partition) {
    Answers answers;
    OverlapBuffer objects;
    for (const Region& region : set.regions) {
      EXPECT_EQ(partition.overlap(region, objects, {}, Order::canonical), Status::ok);
      Answer& answer = answers.emplace_back();
      answer.found.assign(objects.ids().begin(), objects.ids().end());
      answer.bits = answer.found;
      answer.bits.push_back(objects.inside().size());
    }
    HitBuffer nearest;
    for (const Aabb& box : set.boxes) {
      EXPECT_EQ(
          partition.nearest(box, set.boxes.size(), std::numeric_limits<float>::infinity(), nearest),
          Status::ok);
      answers.push_back(answer_of(nearest.hits()));
    }
    return answers;
  };
  for (const RegionCandidates& truth : set.region_truths) {
    ExpectedResult& expected_result = questions.expected_results.emplace_back();
    for (const auto& candidate : truth) {
      if (candidate.truth.must) expected_result.all.push_back(candidate.id);
    }
  }
  ExpectedResult everything;
  for (std::size_t i = 0; i < set.boxes.size(); ++i) everything.all.push_back(i);
  questions.expected_results.insert(questions.expected_results.end(), set.boxes.size(), everything);
  return questions;
}

ExpectedResult expected_of(const std::vector<Pair>& pairs) {
  ExpectedResult expected_result;
  for (const Pair& pair : pairs) {
    expected_result.all.push_back(std::uint64_t{pair.first} << 32U | pair.second);
  }
  return expected_result;
}

template <typename Bound>
ExpectedResult expected_among(const std::vector<Bound>& bounds) {
  ExpectedResult expected_result;
  for (std::size_t first = 0; first < bounds.size(); ++first) {
    for (std::size_t second = first + 1; second < bounds.size(); ++second) {
      if (bounds[first].overlaps(bounds[second]))
        expected_result.all.push_back(first << 32U | second);
    }
  }
  return expected_result;
}

constexpr PairOptions kCanonical{.order = Order::canonical};

template <typename Bound>
Answer query_volumes(std::string_view structure, Volume volume, const std::vector<Bound>& bounds) {
  Partition partition(structure_named(structure),
                      {.execution = Execution::serial(), .volume = volume});
  std::vector<Key> keys(bounds.size());
  EXPECT_EQ(partition.insert(std::span<const Bound>(bounds), {}, keys), Status::ok);
  PairBuffer pairs;
  EXPECT_EQ(partition.self_pairs(pairs, kCanonical), Status::ok);
  return answer_of(pairs);
}

/// Pairs of spheres and pairs of k-DOPs around the boxes of a scene.
Questions pairs_of_volumes(const QuestionSet& set, std::string_view structure) {
  Questions questions;
  std::vector<Sphere> spheres;
  std::vector<Kdop<26>> kdops;
  for (const Aabb& box : set.boxes) {
    spheres.push_back(Sphere::around(box));
    kdops.push_back(Kdop<26>::around(box));
  }
  questions.run = [spheres, kdops, structure](const Partition&) {
    return Answers{query_volumes(structure, Volume::sphere, spheres),
                   query_volumes(structure, Volume::kdop26, kdops)};
  };
  questions.expected_results = {expected_among(spheres), expected_among(kdops)};
  return questions;
}

/// Pairs of the scene, begun pairs, pairs with a partition of the same boxes in reverse order, and
/// overlaps with a view of the reversed boxes.
Questions pairs_of(const QuestionSet& set, std::string_view structure) {
  Questions questions;
  const std::vector<Aabb> others(set.boxes.rbegin(), set.boxes.rend());
  questions.run = [others, structure](const Partition& partition) {
    Answers answers;
    Partition other(structure_named(structure), {.execution = Execution::serial()});
    std::vector<Key> keys(others.size());
    EXPECT_EQ(other.insert(BoxView(others), {}, keys), Status::ok);
    PairBuffer pairs;
    EXPECT_EQ(partition.self_pairs(pairs, kCanonical), Status::ok);
    answers.push_back(answer_of(pairs));
    PairEvents events;
    EXPECT_EQ(partition.self_pairs(events), Status::ok);
    answers.push_back(answer_of(events));
    PairBuffer cross;
    EXPECT_EQ(partition.pairs_with(other, cross, kCanonical), Status::ok);
    answers.push_back(answer_of(cross));
    EXPECT_EQ(partition.overlap(BoxView(others), cross, {}, Order::canonical), Status::ok);
    answers.push_back(answer_of(cross));
    return answers;
  };
  const std::vector<Object> other_objects = numbered(others);
  questions.expected_results.push_back(expected_of(true_pairs(set.objects)));
  questions.expected_results.push_back(questions.expected_results.back());
  questions.expected_results.push_back(expected_of(cross_pairs(set.objects, other_objects)));
  questions.expected_results.push_back(expected_of(cross_pairs(other_objects, set.objects)));
  return questions;
}

/// When the host's mode is set: while objects are inserted, during queries, or both.
struct Phases {
  bool building;
  bool querying;
};
constexpr Phases kPhases[] = {{true, true}, {false, true}, {true, false}};

Partition partition_of(std::string_view structure, const std::vector<Aabb>& boxes) {
  Partition partition(structure_named(structure), {.execution = Execution::serial()});
  std::vector<Key> keys(boxes.size());
  EXPECT_EQ(partition.insert(BoxView(boxes), {}, keys), Status::ok);
  EXPECT_EQ(partition.refresh(), Status::ok);
  return partition;
}

/// All scenes, in every structure, on the narrowest and the widest instruction set.
class FloatModes : public testing::TestWithParam<FloatMode> {
 protected:
  using MakeQuestions = std::function<Questions(const QuestionSet&, std::string_view structure)>;

  static const std::deque<QuestionSet>& sets() {
    static const std::deque<QuestionSet> all = [] {
      std::deque<QuestionSet> made;
      Random random(71);
      for (const TinyScene& scene : tiny_scenes()) {
        const Scene boxes{
            scene.name, boxes_of(scene, std::max<std::size_t>(5, scaled(40)), random), {}};
        add_questions(made, boxes, std::max<std::size_t>(8, scaled(40)),
                      std::max<std::size_t>(8, scaled(28)));
      }
      return made;
    }();
    return all;
  }

  void check(const MakeQuestions& make) {
    Tally tally;
    for (const QuestionSet& set : sets()) {
      for (const std::string_view structure : structure_names()) {
        const Questions questions = make(set, structure);
        for (const Isa isa : {available_isas().front(), available_isas().back()}) {
          const IsaScope scope(isa);
          check(set, structure, questions, tally);
        }
      }
    }
    RecordProperty("questions", std::to_string(tally.questions));
    RecordProperty("expected", std::to_string(tally.expected));
    EXPECT_GT(tally.expected, 0U);
    EXPECT_EQ(tally.missed, 0U) << "of " << tally.expected << " in " << tally.questions
                                << " questions";
    EXPECT_EQ(tally.others, 0U) << "of " << tally.questions << " answers";
  }

 private:
  static void check(const QuestionSet& set, std::string_view structure, const Questions& questions,
                    Tally& tally) {
    const Answers standard = questions.run(partition_of(structure, set.boxes));
    ASSERT_EQ(standard.size(), questions.expected_results.size());
    for (const Phases& phases : kPhases) {
      const FloatMode plain;
      const Partition partition = [&] {
        const FloatModeScope scope(phases.building ? GetParam() : plain);
        return partition_of(structure, set.boxes);
      }();
      const Answers answers = [&] {
        const FloatModeScope scope(phases.querying ? GetParam() : plain);
        return questions.run(partition);
      }();
      ASSERT_EQ(answers.size(), standard.size());
      for (std::size_t i = 0; i < answers.size(); ++i) {
        tally.add(answers[i], questions.expected_results[i], standard[i]);
      }
    }
  }
};

TEST_P(FloatModes, casts_miss_no_tiny_box) {
  check([](const QuestionSet& set, std::string_view) { return casts_of(set); });
}

TEST_P(FloatModes, regions_and_nearest_miss_no_tiny_box) {
  check([](const QuestionSet& set, std::string_view) { return regions_of(set); });
}

TEST_P(FloatModes, pairs_miss_no_tiny_box) {
  check(pairs_of);
}

TEST_P(FloatModes, pairs_miss_no_tiny_volume) {
  check(pairs_of_volumes);
}

INSTANTIATE_TEST_SUITE_P(All, FloatModes, testing::ValuesIn(all_float_modes()),
                         [](const testing::TestParamInfo<FloatMode>& mode) {
                           std::string name = to_string(mode.param);
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace winnow::test
