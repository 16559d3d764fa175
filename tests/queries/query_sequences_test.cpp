// Random sequences of changes and queries of every kind, compared with a plain model. rapidcheck
// shrinks sequences that fail; set WINNOW_SEED for others.

#include <rapidcheck.h>

#include <algorithm>
#include <limits>

#include "tests/queries/questions.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

struct Step {
  enum Kind { insert, update, remove, clear, refilter, cast, batch, region, boxes, near, pairs };
  int kind = cast;
  std::uint64_t seed = 0;
};

std::ostream& operator<<(std::ostream& out, const Step& step) {
  static constexpr const char* kNames[] = {"insert", "update", "remove", "clear", "filter", "cast",
                                           "batch",  "region", "boxes",  "near",  "pairs"};
  return out << kNames[step.kind] << " " << step.seed;
}

rc::Gen<Step> steps() {
  return rc::gen::build<Step>(
      rc::gen::set(&Step::kind, rc::gen::weightedElement<int>({{6, Step::insert},
                                                               {4, Step::update},
                                                               {4, Step::remove},
                                                               {1, Step::clear},
                                                               {2, Step::refilter},
                                                               {4, Step::cast},
                                                               {2, Step::batch},
                                                               {4, Step::region},
                                                               {2, Step::boxes},
                                                               {4, Step::near},
                                                               {1, Step::pairs}})),
      rc::gen::set(&Step::seed, rc::gen::inRange<std::uint64_t>(0, 1U << 20U)));
}

// Mostly small integers, so that boxes touch exactly.
Aabb some_box(Random& random) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    const double low = random.chance(0.7) ? static_cast<double>(random.below(12)) - 6.0
                                          : random.uniform(-6.0, 6.0);
    box.min[k] = static_cast<float>(low);
    box.max[k] = static_cast<float>(low + static_cast<double>(random.below(3)));
    if (random.chance(0.02)) box.max[k] = std::numeric_limits<float>::infinity();
  }
  return box;
}

/// A world, the filters of its objects, and buffers that are reused.
class Play {
 public:
  explicit Play(const Config& config) : world_(config) {}

  void take(const Step& step) {
    Random random(step.seed);
    switch (step.kind) {
      case Step::insert:
        // Many at once, so that sequences use more than one block of rows.
        for (std::size_t n = random.below(40); n > 0; --n) insert(some_box(random), random);
        break;
      case Step::update:
        for (const Key& key : some_keys(random)) world_.update(key, some_box(random));
        break;
      case Step::remove:
        for (const Key& key : some_keys(random)) {
          world_.remove(key);
          filters_.erase(key.id);
        }
        break;
      case Step::clear:
        if (random.chance(0.3)) clear();
        break;
      case Step::refilter:
        for (const Key& key : some_keys(random)) set_filter(key, random);
        break;
      default:
        run_query(step.kind, random);
    }
  }

 private:
  void insert(const Aabb& box, Random& random) { world_.insert(box, random.bits()); }
  void clear() {
    world_.clear();
    filters_.clear();
  }

  void set_filter(Key key, Random& random) {
    const ObjectFilter filter{1U << random.below(2),
                              1U + static_cast<std::uint32_t>(random.below(3)),
                              static_cast<std::uint32_t>(random.below(2))};
    RC_ASSERT(world_.partition().set_filter(key, filter) == Status::ok);
    filters_[key.id] = filter;
  }

  std::vector<Key> some_keys(Random& random) {
    std::vector<Key> keys;
    for (const auto& [id, entry] : world_.entries()) {
      if (random.chance(0.2)) keys.push_back(entry.key);
    }
    return keys;
  }

  // Returns the objects that pass a filter.
  std::vector<Object> objects(const Filter& filter) const {
    std::vector<Object> all = world_.objects();
    std::erase_if(all, [&](const Object& object) {
      const auto at = filters_.find(object.id);
      return !filters_allow(at == filters_.end() ? ObjectFilter{} : at->second, filter.object());
    });
    return all;
  }

  void run_query(int kind, Random& random) {
    Filter filter;
    if (random.chance(0.5)) filter.mask = 1U + static_cast<std::uint32_t>(random.below(3));
    if (random.chance(0.3)) filter.layers = 1U + static_cast<std::uint32_t>(random.below(3));
    if (random.chance(0.3)) filter.environment = static_cast<std::uint32_t>(random.below(3));
    const std::vector<Object> objects = this->objects(filter);
    const Aabb box = some_box(random);
    const Aabb boxes[] = {box, some_box(random)};
    const Partition& p = world_.partition();
    if (kind == Step::cast) {
      const Cast cast =
          random.chance(0.5) ? Cast(hostile_ray(box, random)) : hostile_cast(box, random);
      RC_ASSERT(p.all(cast, hits_, filter) == Status::ok);
      RC_ASSERT(right_hits(hits_.hits(), candidates(cast, objects), p));
      Hit hit;
      RC_ASSERT(p.closest(cast, filter).get(hit) == Status::ok);
      RC_ASSERT(is_first_of(hit, hits_.hits()));
      RC_ASSERT(p.any(cast, filter).get(hit) == Status::ok);
      RC_ASSERT(is_any_of(hit, hits_.hits()));
    } else if (kind == Step::batch) {
      const std::vector<Ray> rays = plain_rays(boxes, 70, random);
      RC_ASSERT(world_.threads().run([&] { return p.all(RayBatch(rays), batch_, filter); }) ==
                Status::ok);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        RC_ASSERT(right_hits(batch_.of(i), candidates(Cast(rays[i]), objects), p));
      }
    } else if (kind == Step::region) {
      std::deque<std::vector<Plane>> planes;
      for (const Region& region : some_regions(boxes, 7, random, planes)) {
        RC_ASSERT(p.overlap(region, objects_, filter) == Status::ok);
        RC_ASSERT(right_objects(objects_, candidates(region, objects), Order::fast));
      }
    } else if (kind == Step::boxes) {
      RC_ASSERT(p.overlap(BoxView(std::span<const Aabb>(boxes)), pairs_, filter,
                          Order::canonical) == Status::ok);
      RC_ASSERT(std::ranges::equal(pairs_, cross_pairs(numbered(boxes), objects)));
    } else if (kind == Step::near) {
      const float radius = random.chance(0.5) ? 1e30F : static_cast<float>(random.below(6));
      const std::size_t count = random.below(20);
      const Aabb from = finite(box);
      RC_ASSERT(p.nearest(from, count, radius, hits_, filter) == Status::ok);
      RC_ASSERT(right_nearest(hits_.hits(), from, count, radius, objects, p));
    } else {
      RC_ASSERT(world_.partition().self_pairs(pairs_) == Status::ok);
    }
  }

  World world_;
  std::map<ObjectId, ObjectFilter> filters_;
  HitBuffer hits_;
  HitBuffer batch_;
  OverlapBuffer objects_;
  PairBuffer pairs_;
};

class QuerySequences : public Conformance {};

TEST_P(QuerySequences, any_sequence_agrees_with_the_model) {
  const bool held = rc::check([this] {
    Play play(config());
    for (const Step& step : *rc::gen::container<std::vector<Step>>(steps())) play.take(step);
  });
  EXPECT_TRUE(held);
}

INSTANTIATE_TEST_SUITE_P(All, QuerySequences, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
