// Memory of queries: footprints equal the allocated memory, a steady query does not allocate, and
// the partition and the buffer remain usable after a refusal.

#include <winnow/core/eigen.h>
#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/counting_memory.h"
#include "tests/support/heap_count.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

struct Buffers {
  explicit Buffers(std::pmr::memory_resource* memory)
      : hits(memory), batch(memory), objects(memory), pairs(memory) {}

  HitBuffer hits;
  HitBuffer batch;
  OverlapBuffer objects;
  PairBuffer pairs;

  [[nodiscard]] std::size_t reserved() const {
    return hits.footprint().total().reserved + batch.footprint().total().reserved +
           objects.footprint().total().reserved + pairs.footprint().total().reserved;
  }
};

class QueryMemory : public Conformance {
 protected:
  QueryMemory() : world_(config(), &memory_) {
    boxes_ = mixed_boxes(700);
    keys_ = world_.insert(boxes_);
    Random random(51);
    rays_ = plain_rays(boxes_, 150, random);
    Aabb middle = boxes_[0];
    for (const Aabb& box : boxes_) middle.merge(box);
    const Vector3f center = 0.5F * (middle.min + middle.max);
    frustum_ = Frustum::perspective(middle.min, center - middle.min, Vector3f::UnitZ(), 1.0F, 1.5F,
                                    0.1F, 100.0F);
    sphere_ = {center, 0.3F * as_eigen(middle.max - middle.min).maxCoeff()};
  }

  // Returns all queries, which the tests run one after another.
  [[nodiscard]] std::vector<std::function<Status(Buffers&)>> queries() {
    Partition& p = world_.partition();
    const SphereCast thick{{rays_[0].origin, 5.0F}, rays_[0].direction};
    return {
        [this, &p](Buffers& b) { return p.all(rays_[0], b.hits); },
        [thick, &p](Buffers& b) { return p.all(thick, b.hits); },
        [this, &p](Buffers& b) { return p.all(RayBatch(rays_), b.batch); },
        [this, &p](Buffers& b) { return p.overlap(frustum_, b.objects); },
        [this, &p](Buffers& b) { return p.overlap(sphere_, b.objects, {}, Order::canonical); },
        [this, &p](Buffers& b) { return p.overlap(BoxView(boxes_), b.pairs); },
        [this, &p](Buffers& b) {
          return p.overlap(BoxView(boxes_), b.pairs, {}, Order::canonical);
        },
        [this, &p](Buffers& b) { return p.nearest(boxes_[5], 200, 1e9F, b.hits); },
        [this, &p](Buffers&) {
          Hit hit;
          const Status status = p.closest(rays_[1]).get(hit);
          return status == Status::ok ? p.any(rays_[1]).get(hit) : status;
        },
        [this, &p](Buffers&) { return p.closest(RayBatch(rays_), {}); },
    };
  }

  Status run(const std::function<Status(Buffers&)>& query, Buffers& buffers) {
    return world_.threads().run([&] { return query(buffers); });
  }

  CountingMemory memory_;
  CountingMemory results_;
  World world_;
  std::vector<Aabb> boxes_;
  std::vector<Key> keys_;
  std::vector<Ray> rays_;
  Frustum frustum_;
  Sphere sphere_;
};

TEST_P(QueryMemory, footprints_equal_the_allocated_memory) {
  Buffers buffers(&results_);
  EXPECT_EQ(results_.requests(), 0U);
  Random random(52);
  for (int round = 0; round < 3; ++round) {
    for (const auto& query : queries()) {
      ASSERT_EQ(run(query, buffers), Status::ok);
      EXPECT_EQ(buffers.reserved(), results_.outstanding());
      EXPECT_EQ(world_.partition().footprint().total().reserved, memory_.outstanding());
    }
    for (const Bytes& bytes :
         {buffers.hits.footprint().results, buffers.objects.footprint().results}) {
      EXPECT_GT(bytes.used, 0U);
      EXPECT_LE(bytes.used, bytes.reserved);
    }
    move(Motion::much, boxes_, random);
    world_.update(keys_, boxes_);
  }
  EXPECT_EQ(memory_.requests_from_elsewhere(), 0U);
  EXPECT_EQ(results_.requests_from_elsewhere(), 0U);
}

TEST_P(QueryMemory, steady_queries_do_not_allocate) {
  Buffers buffers(&results_);
  const auto queries = this->queries();
  const auto play = [&] {
    for (const auto& query : queries) ASSERT_EQ(run(query, buffers), Status::ok);
  };
  for (int frame = 0; frame < 4; ++frame) play();
  const std::size_t requests = memory_.requests() + results_.requests();
  const std::size_t heap = heap_requests();
  for (int frame = 0; frame < 6; ++frame) play();
  EXPECT_EQ(memory_.requests() + results_.requests(), requests);
  if (config().threads == 1) {
    EXPECT_EQ(heap_requests(), heap) << "allocated behind the memory resource";
  }
}

TEST_P(QueryMemory, reserved_buffers_do_not_allocate) {
  HitBuffer hits(&results_);
  OverlapBuffer objects(&results_);
  ASSERT_TRUE(hits.reserve(700));
  ASSERT_TRUE(objects.reserve(700));
  EXPECT_GE(hits.footprint().results.reserved, 700 * sizeof(Hit));
  EXPECT_GE(objects.footprint().results.reserved, 700 * sizeof(ObjectId));
  EXPECT_EQ(hits.footprint().total().reserved + objects.footprint().total().reserved,
            results_.outstanding());
}

// Refuses request k of a query, or request k and all later requests, for k = 0, 1, ..., until no
// request is refused.
TEST_P(QueryMemory, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  const auto queries = this->queries();
  for (std::size_t q = 0; q < queries.size(); ++q) {
    SCOPED_TRACE(q);
    bool finished = false;
    for (std::size_t n = 0; n < 200 && !finished; ++n) {
      Buffers buffers(&memory_);
      world_.partition().release_memory();
      world_.update(keys_[n], boxes_[n]);
      const std::size_t refusals = memory_.refusals();
      if (n % 2 == 0) {
        memory_.refuse_after(n / 2);
      } else {
        memory_.refuse_one_after(n / 2);
      }
      const Status status = run(queries[q], buffers);
      memory_.grant_all();
      finished = n % 2 == 0 && memory_.refusals() == refusals;
      if (status != Status::ok) {
        ASSERT_EQ(status, Status::out_of_memory);
        ASSERT_NE(memory_.refusals(), refusals);
        EXPECT_TRUE(buffers.hits.empty());
        EXPECT_TRUE(buffers.batch.empty());
        EXPECT_TRUE(buffers.objects.empty());
        EXPECT_TRUE(buffers.pairs.empty());
      }
      ASSERT_EQ(world_.partition().footprint().total().reserved + buffers.reserved(),
                memory_.outstanding());
      ASSERT_EQ(run(queries[q], buffers), Status::ok);
    }
    EXPECT_TRUE(finished) << "the call never stopped requesting memory";
    ASSERT_TRUE(world_.holds_its_objects());
  }
  HitBuffer hits;
  ASSERT_EQ(world_.partition().all(rays_[0], hits), Status::ok);
  EXPECT_TRUE(
      right_hits(hits.hits(), candidates(Cast(rays_[0]), world_.objects()), world_.partition()));
}

// Buffers with large, then small results, which are used with several partitions.
TEST_P(QueryMemory, buffer_works_with_any_partition) {
  World small(config());
  small.insert(uniform_boxes(20));
  World empty(config());
  Buffers buffers(&results_);
  for (World* world : {&world_, &small, &empty, &world_, &empty, &small}) {
    const Partition& p = world->partition();
    const std::vector<Object> objects = world->objects();
    ASSERT_EQ(p.all(rays_[2], buffers.hits), Status::ok);
    EXPECT_TRUE(right_hits(buffers.hits.hits(), candidates(Cast(rays_[2]), objects), p));
    ASSERT_EQ(p.overlap(Region(sphere_), buffers.objects), Status::ok);
    EXPECT_TRUE(right_objects(buffers.objects, candidates(Region(sphere_), objects), Order::fast));
    ASSERT_EQ(p.nearest(boxes_[0], 30, 1e9F, buffers.hits), Status::ok);
    EXPECT_TRUE(right_nearest(buffers.hits.hits(), boxes_[0], 30, 1e9F, objects, p));
    ASSERT_EQ(p.all(RayBatch(rays_), buffers.batch), Status::ok);
    EXPECT_EQ(buffers.batch.queries(), rays_.size());
  }
}

INSTANTIATE_TEST_SUITE_P(All, QueryMemory, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
