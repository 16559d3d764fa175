// Random sequences of all calls, compared with a plain model. rapidcheck shrinks sequences that
// fail; set WINNOW_SEED for others.

#include <rapidcheck.h>
#include <winnow/core/eigen.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/world.h"

namespace winnow::test {
namespace {

struct Step {
  enum Kind {
    insert,
    insert_many,
    update,
    update_many,
    remove,
    remove_many,
    filter,
    clear,
    query,
    cross
  };
  int kind = query;
  std::uint64_t choice = 0;  // selects objects and their number
  std::vector<Aabb> boxes;
};

std::ostream& operator<<(std::ostream& out, const Step& step) {
  static constexpr const char* kNames[] = {"insert", "insert_many", "update", "update_many",
                                           "remove", "remove_many", "filter", "clear",
                                           "query",  "cross"};
  out << kNames[step.kind] << " " << step.choice;
  for (const Aabb& box : step.boxes) {
    out << " [" << as_eigen(box.min).transpose() << " .. " << as_eigen(box.max).transpose() << "]";
  }
  return out;
}

// Mostly small integers, so that boxes touch exactly; sometimes any value.
rc::Gen<float> coordinates() {
  constexpr float inf = std::numeric_limits<float>::infinity();
  return rc::gen::weightedOneOf<float>(
      {{12, rc::gen::map(rc::gen::inRange(-6, 7), [](int i) { return static_cast<float>(i); })},
       {3, rc::gen::map(rc::gen::inRange(-600, 601),
                        [](int i) { return static_cast<float>(i) * 0.01F; })},
       {1, rc::gen::element(-inf, inf, -0.0F, 1e30F, -3e38F, 1e-40F, -1e-30F)}});
}

rc::Gen<Aabb> valid_boxes() {
  const auto any = rc::gen::map(rc::gen::container<std::vector<float>>(6, coordinates()),
                                [](const std::vector<float>& v) {
                                  const Vec3f a(v[0], v[1], v[2]);
                                  const Vec3f b(v[3], v[4], v[5]);
                                  return Aabb{a.min(b), a.max(b)};
                                });
  return rc::gen::suchThat(any, [](const Aabb& box) { return box.is_valid(); });
}

rc::Gen<Step> steps() {
  return rc::gen::build<Step>(
      rc::gen::set(&Step::kind, rc::gen::weightedElement<int>({{6, Step::insert},
                                                               {3, Step::insert_many},
                                                               {4, Step::update},
                                                               {4, Step::update_many},
                                                               {3, Step::remove},
                                                               {2, Step::remove_many},
                                                               {2, Step::filter},
                                                               {1, Step::clear},
                                                               {5, Step::query},
                                                               {1, Step::cross}})),
      rc::gen::set(&Step::choice, rc::gen::inRange<std::uint64_t>(0, 1U << 16U)),
      rc::gen::set(&Step::boxes, rc::gen::container<std::vector<Aabb>>(5, valid_boxes())));
}

// Returns keys of `count` live objects, from the chosen one on.
std::vector<Key> some_keys(const World& world, std::uint64_t choice, std::size_t count) {
  std::vector<Key> all;
  for (const auto& [id, entry] : world.entries()) all.push_back(entry.key);
  std::vector<Key> keys;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) {
    keys.push_back(all[(choice + i * 7) % all.size()]);
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.id < b.id; });
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

// Returns the default filter, a filter that accepts no object, or a filter of few layers and
// environments, so that objects share them.
ObjectFilter some_filter(std::uint64_t choice) {
  if (choice % 5 == 0) return {};
  const auto bits = static_cast<std::uint32_t>(choice);
  const std::uint32_t environment = bits / 64 % 4 == 3 ? kAllEnvironments : bits / 64 % 4;
  return {1U << bits % 3, bits / 8 % 8, environment};
}

void take(const Step& step, World& world, const World& other, PairBuffer& buffer) {
  const std::size_t count = 1 + step.choice % 5;
  const std::span<const Aabb> boxes(step.boxes);
  switch (step.kind) {
    case Step::insert:
      world.insert(boxes[0], step.choice);
      break;
    case Step::insert_many:
      // Many at once, so that sequences use more than one block of rows.
      for (std::size_t n = 0; n < count; ++n) world.insert(boxes);
      break;
    case Step::update:
      for (const Key& key : some_keys(world, step.choice, 1)) world.update(key, boxes[0]);
      break;
    case Step::update_many: {
      const std::vector<Key> keys = some_keys(world, step.choice, count);
      world.update(keys, boxes.first(keys.size()));
      break;
    }
    case Step::remove:
      for (const Key& key : some_keys(world, step.choice, 1)) world.remove(key);
      break;
    case Step::remove_many:
      world.remove(some_keys(world, step.choice, 4 * count));
      break;
    case Step::filter: {
      const std::vector<Key> keys = some_keys(world, step.choice, 3 * count);
      const std::vector<ObjectFilter> filters(keys.size(), some_filter(step.choice));
      world.set_filter(keys, filters);
      break;
    }
    case Step::clear:
      if (step.choice % 4 == 0) world.clear();
      break;
    case Step::query: {
      const Order order = step.choice % 2 == 0 ? Order::fast : Order::canonical;
      RC_ASSERT(world.agrees(buffer, {.order = order, .incremental = step.choice % 8 != 0}));
      break;
    }
    case Step::cross: {
      RC_ASSERT(world.pairs_with(other.partition(), buffer) == Status::ok);
      RC_ASSERT(right_cross_pairs(buffer.pairs(), cross_pairs(world.objects(), other.objects()),
                                  world.partition().is_exact()));
      break;
    }
    default:
      RC_FAIL("no such step");
  }
}

class Sequences : public Conformance {};

TEST_P(Sequences, any_call_sequence_agrees_with_the_model) {
  const bool held = rc::check([this] {
    World world(config());
    World other(config());
    PairBuffer buffer;
    World* current = &world;
    World* rest = &other;
    for (const Step& step : *rc::gen::container<std::vector<Step>>(steps())) {
      take(step, *current, *rest, buffer);
      RC_ASSERT(current->partition().size() == current->entries().size());
      if (step.kind == Step::cross) std::swap(current, rest);
    }
    RC_ASSERT(world.holds_its_objects());
    RC_ASSERT(world.agrees(buffer));
    RC_ASSERT(other.holds_its_objects());
    RC_ASSERT(other.agrees());
  });
  EXPECT_TRUE(held);
}

INSTANTIATE_TEST_SUITE_P(All, Sequences, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
