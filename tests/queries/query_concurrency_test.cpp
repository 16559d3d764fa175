// Const queries of every kind from several threads at once, right after a change: the results must
// be right, and the thread sanitizer finds races that happen to give the right results.

#include <array>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/answers.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/motion.h"
#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

#if WINNOW_TEST_THREADS
#include <thread>

namespace winnow::test {
namespace {

constexpr std::size_t kReaders = 4;

// The buffers of one reader, which are reused in every frame, and its first error.
struct Reader {
  HitBuffer hits;
  HitBuffer batch;
  OverlapBuffer objects;
  PairBuffer pairs;
  testing::AssertionResult result = testing::AssertionSuccess();

  void expect(testing::AssertionResult one) {
    if (result && !one) result = one;
  }
  void expect_ok(Status status) {
    if (result && status != Status::ok) {
      result = testing::AssertionFailure() << winnow::to_string(status);
    }
  }
};

struct Questions {
  std::vector<Ray> rays;
  std::vector<Cast> casts;
  std::vector<CastCandidates> cast_truths;
  std::deque<std::vector<Plane>> planes;
  std::vector<Region> regions;
  std::vector<RegionCandidates> region_truths;
  std::vector<Aabb> boxes;
  std::vector<Pair> box_truth;
  std::vector<Object> objects;
};

Questions prepare(const World& world, const std::vector<Aabb>& boxes) {
  Random random(42);
  Questions q;
  q.objects = world.objects();
  q.rays = plain_rays(boxes, 20, random);
  q.casts = some_casts(boxes, 8, random);
  q.regions = some_regions(boxes, 7, random, q.planes);
  for (const Cast& cast : q.casts) q.cast_truths.push_back(candidates(cast, q.objects));
  for (const Region& region : q.regions) q.region_truths.push_back(candidates(region, q.objects));
  q.boxes.assign(boxes.begin(), boxes.begin() + 20);
  q.box_truth = cross_pairs(numbered(q.boxes), q.objects);
  return q;
}

// Each reader starts with another query, so that each kind is once the first after a change.
void read(const Partition& p, const Questions& q, std::size_t first, Reader& reader) {
  for (std::size_t n = 0; n < kReaders; ++n) {
    switch ((first + n) % kReaders) {
      case 0:
        for (std::size_t i = 0; i < q.casts.size(); ++i) {
          reader.expect_ok(p.all(q.casts[i], reader.hits));
          reader.expect(right_hits(reader.hits.hits(), q.cast_truths[i], p));
          Hit hit;
          reader.expect_ok(p.closest(q.casts[i]).get(hit));
          reader.expect(is_first_of(hit, reader.hits.hits()));
          reader.expect_ok(p.any(q.casts[i]).get(hit));
          reader.expect(is_any_of(hit, reader.hits.hits()));
        }
        break;
      case 1: {
        reader.expect_ok(p.all(RayBatch(q.rays), reader.batch));
        std::array<Key, 20> keys;
        reader.expect_ok(p.closest(RayBatch(q.rays), {.key = keys.data()}));
        for (std::size_t i = 0; reader.result && i < q.rays.size(); ++i) {
          const auto found = reader.batch.of(i);
          if (keys[i] != (found.empty() ? Key{} : found[0].key)) {
            reader.expect(testing::AssertionFailure() << "ray " << i);
          }
        }
        break;
      }
      case 2:
        for (std::size_t i = 0; i < q.regions.size(); ++i) {
          reader.expect_ok(p.overlap(q.regions[i], reader.objects));
          reader.expect(right_objects(reader.objects, q.region_truths[i], Order::fast));
        }
        reader.expect_ok(p.overlap(BoxView(q.boxes), reader.pairs, {}, Order::canonical));
        reader.expect(right_cross_pairs(reader.pairs.pairs(), q.box_truth, true));
        break;
      default:
        for (const Aabb& box : q.boxes) {
          reader.expect_ok(p.nearest(box, 10, 3.0F, reader.hits));
          reader.expect(right_nearest(reader.hits.hits(), box, 10, 3.0F, q.objects, p));
        }
    }
  }
}

class QueryConcurrency : public Conformance {};

TEST_P(QueryConcurrency, concurrent_queries_after_a_change_are_safe) {
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(400);
  const std::vector<Key> keys = world.insert(boxes);
  std::array<Reader, kReaders> readers;
  Random random(41);
  for (std::size_t frame = 0; frame < 4; ++frame) {
    move(frame % 2 == 0 ? Motion::few : Motion::much, boxes, random);
    world.update(keys, boxes);
    // Ids depend only on the calls, so all configurations have the same reference.
    static std::deque<Questions> frames;
    if (frames.size() == frame) frames.push_back(prepare(world, boxes));
    const Questions& questions = frames[frame];
    const Partition& partition = world.partition();
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kReaders; ++i) {
      threads.emplace_back([&, i] { read(partition, questions, i, readers[i]); });
    }
    for (std::thread& thread : threads) thread.join();
    for (const Reader& reader : readers) ASSERT_TRUE(reader.result) << "frame " << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(All, QueryConcurrency, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test

#endif
