// Pair events: the begun and ended pairs are the difference of the key pairs of two frames,
// whatever happened between the frames and whichever algorithm found them.

#if WINNOW_HAVE_RAPIDCHECK
#include <rapidcheck.h>
#endif

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "tests/support/counting_memory.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Ids = std::pair<ObjectId, ObjectId>;
using Stamps = std::pair<std::uint32_t, std::uint32_t>;
// Key pairs in the order of ids.
using KeyPairs = std::set<std::pair<Ids, Stamps>>;

std::pair<Ids, Stamps> entry_of(const KeyPair& pair) {
  return {{pair.first.id, pair.second.id}, {pair.first.stamp, pair.second.stamp}};
}

std::vector<ClientData> random_data(std::size_t count, std::uint64_t stream) {
  Random random(stream);
  std::vector<ClientData> data(count);
  std::ranges::generate(data, [&] { return random.bits(); });
  return data;
}

// The buffer and events of a frame, the pairs of the frame before, and the client data of each
// object of any frame.
class Frames {
 public:
  explicit Frames(World& world,
                  std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : buffer(memory), events({memory, true}), world_(world) {}

  // Queries the next frame and compares its events with the difference of the key pairs.
  testing::AssertionResult next(const PairOptions& options = {}) {
    const Status status = world_.threads().run(
        [&] { return world_.partition().self_pairs(buffer, events, options); });
    if (status != Status::ok) {
      return testing::AssertionFailure() << "answered " << winnow::to_string(status);
    }
    if (const auto right = world_.has_pairs(buffer); !right) return right;
    const KeyPairs now = keys_of(buffer.pairs());
    for (const auto& [id, entry] : world_.entries()) data_[{id, entry.key.stamp}] = entry.data;
    const auto verdict = agree(now, options.order);
    before_ = now;
    return verdict;
  }

  // Tests the state after a refusal: no pair begins or ends, and the buffer has the pairs of the
  // last frame; ids of removed objects are stale.
  testing::AssertionResult stands() const {
    const bool silent = events.begun().empty() && events.ended().empty() &&
                        events.begun_data().empty() && events.ended_data().empty();
    if (!silent) return testing::AssertionFailure() << "a refused call reported changes";
    std::set<Ids> held;
    for (const auto& [first, second] : buffer.pairs()) held.insert({first, second});
    std::set<Ids> last;
    for (const auto& [ids, stamps] : before_) last.insert(ids);
    if (held != last || buffer.size() != before_.size()) {
      return testing::AssertionFailure() << buffer.size() << " pairs, not " << before_.size();
    }
    return testing::AssertionSuccess();
  }

  // The next frame has no predecessor.
  void forget() { before_.clear(); }

  PairBuffer buffer;
  PairEvents events;

 private:
  [[nodiscard]] KeyPairs keys_of(std::span<const Pair> pairs) const {
    KeyPairs keys;
    for (const auto& [first, second] : pairs) {
      keys.insert(entry_of({world_.partition().key_of(first), world_.partition().key_of(second)}));
    }
    return keys;
  }

  [[nodiscard]] testing::AssertionResult agree(const KeyPairs& now, Order order) const {
    std::vector<std::pair<Ids, Stamps>> begun;
    std::vector<std::pair<Ids, Stamps>> ended;
    std::ranges::set_difference(now, before_, std::back_inserter(begun));
    std::ranges::set_difference(before_, now, std::back_inserter(ended));
    if (!std::ranges::equal(events.begun(), begun, {}, entry_of)) {
      return testing::AssertionFailure()
             << events.begun().size() << " pairs begun, not " << begun.size();
    }
    if (!std::ranges::equal(events.ended(), ended, {}, entry_of)) {
      return testing::AssertionFailure()
             << events.ended().size() << " pairs ended, not " << ended.size();
    }
    if (events.persisting() + begun.size() != buffer.size()) {
      return testing::AssertionFailure() << events.persisting() << " pairs persist";
    }
    if (!has_data(events.begun(), events.begun_data()) ||
        !has_data(events.ended(), events.ended_data())) {
      return testing::AssertionFailure() << "not the client data of these pairs";
    }
    const KeyPairs last = keys_of(buffer.pairs().subspan(events.persisting()));
    if (!std::ranges::equal(last, begun)) {
      return testing::AssertionFailure() << "the last pairs are not the begun pairs";
    }
    const auto middle = buffer.begin() + events.persisting();
    if (order == Order::canonical &&
        !(std::is_sorted(buffer.begin(), middle) && std::is_sorted(middle, buffer.end()))) {
      return testing::AssertionFailure() << "canonical order is not sorted";
    }
    return testing::AssertionSuccess();
  }

  [[nodiscard]] bool has_data(std::span<const KeyPair> pairs,
                              std::span<const ClientDataPair> data) const {
    const auto data_of = [&](const Key& key) { return data_.at({key.id, key.stamp}); };
    return std::ranges::equal(pairs, data, [&](const KeyPair& pair, const ClientDataPair& got) {
      return got == ClientDataPair{data_of(pair.first), data_of(pair.second)};
    });
  }

  World& world_;
  KeyPairs before_;
  std::map<std::pair<ObjectId, std::uint32_t>, ClientData> data_;
};

PairOptions options_of(std::uint64_t choice) {
  return {.order = choice % 3 == 0 ? Order::canonical : Order::fast,
          .incremental = choice % 5 != 0};
}

class Events : public Conformance {
 protected:
  [[nodiscard]] std::size_t scene_size(std::size_t requested) const {
    return config().make().is_exact() ? requested : std::min<std::size_t>(requested, 60);
  }
};

TEST_P(Events, events_are_the_difference_of_moving_frames) {
  for (const Motion motion : kMotions) {
    SCOPED_TRACE(to_string(motion));
    World world(config());
    Frames frames(world);
    std::vector<Aabb> boxes = uniform_boxes(scene_size(400));
    const std::vector<Key> keys = world.insert(boxes, random_data(boxes.size(), 8));
    Random random(3);
    for (std::uint64_t frame = 0; frame < 6; ++frame) {
      ASSERT_TRUE(frames.next(options_of(frame + 1)));
      move(motion, boxes, random);
      world.update(keys, boxes);
    }
  }
}

#if WINNOW_HAVE_RAPIDCHECK
TEST_P(Events, events_follow_any_sequence_of_calls) {
  const bool held = rc::check([this] {
    World world(config());
    Frames frames(world);
    PairBuffer other;
    Random random(*rc::gen::inRange<std::uint64_t>(0, 1U << 20U));
    std::vector<Key> keys;
    const auto some = [&] { return random.below(keys.size()); };
    for (int step = 0; step < 20; ++step) {
      if (keys.empty() || random.chance(0.3)) {
        for (const Aabb& box : uniform_boxes(1 + random.below(12), random.bits())) {
          keys.push_back(world.insert(box, random.bits()));
        }
      }
      const std::size_t moved = random.chance(0.2) ? keys.size() : random.below(4);
      for (std::size_t i = 0; i < moved; ++i) {
        world.update(keys[some()], uniform_boxes(1, random.bits())[0]);
      }
      if (random.chance(0.3)) world.set_filter(keys[some()], {1, 1, random.chance(0.5) ? 0U : 1U});
      // A new object gets the id at once: the old pairs end even if the new ones have equal ids.
      if (random.chance(0.4)) {
        const std::size_t at = some();
        const Aabb box = world.entries().at(keys[at].id).box;
        world.remove(keys[at]);
        keys[at] = world.insert(box, random.bits());
      }
      if (random.chance(0.3)) {
        const std::size_t at = some();
        world.remove(keys[at]);
        keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(at));
      }
      if (random.chance(0.05)) {
        world.clear();
        keys.clear();
      }
      if (random.chance(0.15)) {
        RC_ASSERT(world.self_pairs(other) == Status::ok);
      }
      if (random.chance(0.05)) {
        // Another use of the buffer restarts the events.
        RC_ASSERT(world.self_pairs(frames.buffer) == Status::ok);
        frames.forget();
      }
      RC_ASSERT(frames.next(options_of(random.below(15))));
    }
  });
  EXPECT_TRUE(held);
}
#endif

// Few objects change in each frame. The buffer is then updated through its links (linked_pairs.h),
// and the pairs of all other objects stay in place.
TEST_P(Events, events_follow_few_objects_among_many) {
  for (const std::uint64_t stream : {1U, 2U, 3U}) {
    World world(config());
    Frames frames(world);
    PairEvents events_only;
    Random random(stream);
    std::vector<Aabb> boxes = stream == 1   ? uniform_boxes(scene_size(500))
                              : stream == 2 ? mixed_boxes(scene_size(200))
                                            : pile_boxes(scene_size(400));
    std::vector<Key> keys = world.insert(boxes, random_data(boxes.size(), stream));
    const auto some = [&] { return random.below(keys.size()); };
    std::uint64_t full = 0;
    for (int frame = 0; frame < 40; ++frame) {
      for (std::size_t change = random.below(4); change != 0; --change) {
        const std::size_t at = some();
        const Aabb box = world.entries().at(keys[at].id).box;
        const Vec3f edge = random.chance(0.2) ? Vec3f(0, 0, 0) : Vec3f(box.max - box.min);
        const Aabb moved{box.min + edge * 0.5F, box.max + edge * 0.5F};
        switch (random.below(6)) {
          case 0:
            world.set_filter(keys[at], {1, 1, random.chance(0.5) ? 0U : 1U});
            break;
          case 1:  // a new object gets its id
            world.remove(keys[at]);
            keys[at] = world.insert(random.chance(0.5) ? box : moved, random.bits());
            break;
          case 2:
            world.remove(keys[at]);
            keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(at));
            break;
          case 3:
            keys.push_back(world.insert(moved, random.bits()));
            break;
          case 4:  // moves onto another object
            world.update(keys[at], world.entries().at(keys[some()].id).box);
            break;
          default:
            world.update(keys[at], moved);
        }
      }
      ASSERT_TRUE(frames.next()) << "scene " << stream << ", frame " << frame;
      if (frame == 3) full = world.partition().statistics().full_queries;
      EXPECT_EQ(frames.buffer.footprint().total().reserved > 0, !frames.buffer.empty());
    }
    EXPECT_EQ(world.partition().statistics().full_queries, full);
  }
}

// The events are equal without a buffer.
TEST_P(Events, events_without_a_buffer_are_equal) {
  World with(config());
  World without(config());
  std::vector<Aabb> boxes = uniform_boxes(scene_size(500));
  const std::vector<Key> keys = with.insert(boxes);
  const std::vector<Key> same_keys = without.insert(boxes);
  PairBuffer buffer;
  PairEvents events;
  PairEvents events_only;
  Random random(4);
  for (int frame = 0; frame < 20; ++frame) {
    if (frame % 7 == 6) {
      move(Motion::much, boxes, random);
      with.update(keys, boxes);
      without.update(same_keys, boxes);
    } else {
      const std::size_t at = random.below(keys.size());
      const Aabb box = uniform_boxes(1, random.bits())[0];
      boxes[at] = box;
      with.update(keys[at], box);
      without.update(same_keys[at], box);
    }
    ASSERT_EQ(with.threads().run([&] { return with.partition().self_pairs(buffer, events); }),
              Status::ok);
    ASSERT_EQ(without.threads().run([&] { return without.partition().self_pairs(events_only); }),
              Status::ok);
    const auto ids = [](const KeyPair& pair) { return Ids{pair.first.id, pair.second.id}; };
    EXPECT_TRUE(std::ranges::equal(events.begun(), events_only.begun(), {}, ids, ids)) << frame;
    EXPECT_TRUE(std::ranges::equal(events.ended(), events_only.ended(), {}, ids, ids)) << frame;
    EXPECT_EQ(events.persisting(), events_only.persisting());
  }
}

TEST_P(Events, refused_linked_frame_can_be_continued) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  int failures = 0;
  for (std::size_t granted = 0; granted < 14; ++granted) {
    CountingMemory results;
    World world(config());
    Frames frames(world, &results);
    std::vector<Aabb> boxes = uniform_boxes(scene_size(400));
    const std::vector<Key> keys = world.insert(boxes);
    const auto few = [&](std::size_t frame) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = (17 * frame + 5 * i) % keys.size();
        world.update(keys[at], boxes[(at + 7 * frame) % boxes.size()]);
      }
    };
    for (std::size_t frame = 0; frame < 1 + granted % 4; ++frame) {
      few(frame);
      ASSERT_TRUE(frames.next());
    }
    few(9);
    world.insert(uniform_boxes(3));
    results.refuse_after(granted / 4);
    const Status status = world.threads().run(
        [&] { return world.partition().self_pairs(frames.buffer, frames.events, {}); });
    results.grant_all();
    if (status == Status::ok) continue;
    ++failures;
    ASSERT_EQ(status, Status::out_of_memory);
    ASSERT_TRUE(frames.stands());
    for (std::size_t frame = 10; frame < 14; ++frame) {
      ASSERT_TRUE(frames.next());
      few(frame);
    }
  }
  EXPECT_GT(failures, 0);
}

TEST_P(Events, reused_id_ends_and_begins_its_pairs) {
  World world(config());
  Frames frames(world);
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  const Key stays = world.insert(box);
  const Key goes = world.insert(box);
  ASSERT_TRUE(frames.next());
  world.remove(goes);
  const Key comes = world.insert(box);
  ASSERT_EQ(comes.id, goes.id);
  ASSERT_TRUE(frames.next());
  ASSERT_EQ(frames.events.begun().size(), 1U);
  ASSERT_EQ(frames.events.ended().size(), 1U);
  EXPECT_EQ(frames.events.ended()[0], (KeyPair{stays, goes}));
  EXPECT_EQ(frames.events.begun()[0], (KeyPair{stays, comes}));
  EXPECT_EQ(frames.events.persisting(), 0U);
}

TEST_P(Events, ended_pairs_have_the_client_data) {
  World world(config());
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  PairBuffer buffer;
  PairEvents events({.memory = std::pmr::get_default_resource(), .client_data = true});
  const auto next = [&] { ASSERT_EQ(world.partition().self_pairs(buffer, events), Status::ok); };
  world.insert(box, 11);
  Key other = world.insert(box, 12);
  next();
  ASSERT_EQ(events.begun_data().size(), 1U);
  EXPECT_EQ(events.begun_data()[0], (ClientDataPair{11, 12}));
  EXPECT_TRUE(events.ended_data().empty());
  // A new object gets the id, and its filter rejects all others.
  world.remove(other);
  other = world.insert(box, 13);
  world.set_filter(other, {1, 1, 1});
  next();
  EXPECT_TRUE(events.begun_data().empty());
  ASSERT_EQ(events.ended_data().size(), 1U);
  EXPECT_EQ(events.ended_data()[0], (ClientDataPair{11, 12}));
  world.set_filter(other, {});
  next();
  ASSERT_EQ(events.begun_data().size(), 1U);
  EXPECT_EQ(events.begun_data()[0], (ClientDataPair{11, 13}));
  world.clear();
  next();
  ASSERT_EQ(events.ended_data().size(), 1U);
  EXPECT_EQ(events.ended_data()[0], (ClientDataPair{11, 13}));
  events.clear();
  EXPECT_TRUE(events.ended_data().empty());
}

TEST_P(Events, client_data_memory_is_taken_only_on_request) {
  World world(config());
  World reference(config());
  std::vector<Aabb> boxes = uniform_boxes(scene_size(300));
  const std::vector<ClientData> data = random_data(boxes.size(), 5);
  const std::vector<Key> keys = world.insert(boxes, data);
  const std::vector<Key> reference_keys = reference.insert(boxes, data);
  PairEvents without;
  PairEvents with({.memory = std::pmr::get_default_resource(), .client_data = true});
  Random random(2);
  for (const Motion motion : {Motion::much, Motion::few, Motion::few}) {
    ASSERT_EQ(world.partition().self_pairs(without), Status::ok);
    ASSERT_EQ(reference.partition().self_pairs(with), Status::ok);
    EXPECT_TRUE(without.begun_data().empty() && without.ended_data().empty());
    static_assert(sizeof(ClientDataPair) == sizeof(KeyPair));
    EXPECT_EQ(with.footprint().results.used, 2 * without.footprint().results.used);
    EXPECT_EQ(with.footprint().scratch.used,
              without.footprint().scratch.used + boxes.size() * sizeof(ClientData));
    move(motion, boxes, random);
    world.update(keys, boxes);
    reference.update(reference_keys, boxes);
  }
}

TEST_P(Events, events_of_another_buffer_or_partition_restart) {
  World world(config());
  World other(config());
  Frames frames(world);
  const auto boxes = uniform_boxes(60);
  world.insert(boxes);
  other.insert(boxes);
  ASSERT_TRUE(frames.next());
  PairBuffer second;
  ASSERT_EQ(world.partition().self_pairs(second, frames.events), Status::ok);
  EXPECT_EQ(frames.events.begun().size(), second.size());
  EXPECT_TRUE(frames.events.ended().empty());
  ASSERT_EQ(other.partition().self_pairs(second, frames.events), Status::ok);
  EXPECT_EQ(frames.events.begun().size(), second.size());
  EXPECT_TRUE(frames.events.ended().empty());
  PairEvents taken(std::move(frames.events));
  ASSERT_EQ(other.partition().self_pairs(second, taken), Status::ok);
  EXPECT_TRUE(taken.begun().empty());
  ASSERT_EQ(other.partition().self_pairs(second, frames.events), Status::ok);
  EXPECT_EQ(frames.events.begun().size(), second.size());
  EXPECT_EQ(frames.events.begun_data().size(), second.size());
}

// The memory that is refused: of the partition, of the buffer and events, or of both.
struct Refused {
  bool partition;
  bool results;
};

TEST_P(Events, events_continue_after_any_refusal) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  int failures = 0;
  for (const auto& [motion, options] : {std::pair(Motion::few, PairOptions{}),
                                        std::pair(Motion::much, PairOptions{Order::canonical}),
                                        std::pair(Motion::few, PairOptions{Order::fast, false})}) {
    for (const Refused refused :
         {Refused{true, false}, Refused{false, true}, Refused{true, true}}) {
      // Refuses all requests from the n-th on, for each n, until none is refused.
      bool was_refused = true;
      for (std::size_t granted = 0; was_refused && granted < 40; ++granted) {
        CountingMemory memory;
        CountingMemory results;
        World world(config(), &memory);
        std::vector<Aabb> boxes = uniform_boxes(scene_size(150));
        std::vector<Key> keys = world.insert(boxes, random_data(boxes.size(), 8));
        Random random(1);
        Frames frames(world, &results);
        const auto change = [&] {
          move(motion, boxes, random);
          world.update(keys, boxes);
          world.remove(keys.front());
          keys.erase(keys.begin());
          boxes.erase(boxes.begin());
          keys.push_back(world.insert(boxes[3]));
          boxes.push_back(boxes[3]);
        };
        for (int frame = 0; frame < 2; ++frame) {
          ASSERT_TRUE(frames.next(options));
          change();
        }
        // More objects than there is room for.
        for (const Key& key : world.insert(uniform_boxes(40, 9))) keys.push_back(key);
        for (const Aabb& box : uniform_boxes(40, 9)) boxes.push_back(box);
        const std::size_t before = memory.refusals() + results.refusals();
        if (refused.partition) memory.refuse_after(granted);
        if (refused.results) results.refuse_after(granted);
        const Status status = world.threads().run(
            [&] { return world.partition().self_pairs(frames.buffer, frames.events, options); });
        memory.grant_all();
        results.grant_all();
        was_refused = memory.refusals() + results.refusals() != before;
        if (status == Status::ok) continue;
        ++failures;
        ASSERT_EQ(status, Status::out_of_memory);
        ASSERT_TRUE(frames.stands());
        change();
        ASSERT_TRUE(frames.next(options)) << granted;
        change();
        ASSERT_TRUE(frames.next()) << granted;
      }
    }
  }
  EXPECT_GT(failures, 0);
}

TEST_P(Events, events_respect_the_predicate) {
  World world(config());
  std::vector<Aabb> boxes = uniform_boxes(scene_size(800));
  const std::vector<Key> keys = world.insert(boxes);
  // Accepts half of all pairs; called from several threads.
  const auto accept = [](void*, ObjectId first, ObjectId second) {
    return (first + second) % 2 == 0;
  };
  const PairPredicate predicate{accept, nullptr};
  PairBuffer all;
  PairBuffer some;
  PairEvents events;
  Random random(6);
  for (const bool incremental : {true, false}) {
    for (int frame = 0; frame < 4; ++frame) {
      move(Motion::few, boxes, random);
      world.update(keys, boxes);
      ASSERT_EQ(world.threads().run([&] {
        return world.partition().self_pairs(some, events, {Order::fast, incremental, predicate});
      }),
                Status::ok);
      ASSERT_EQ(world.self_pairs(all, {.incremental = false}), Status::ok);
      std::vector<Pair> expected;
      std::ranges::copy_if(all, std::back_inserter(expected), [&](const Pair& pair) {
        return accept(nullptr, pair.first, pair.second);
      });
      ASSERT_EQ(expected.size(), some.size());
      std::ranges::sort(expected);
      std::vector<Pair> got(some.begin(), some.end());
      std::ranges::sort(got);
      EXPECT_EQ(got, expected);
    }
  }
  ASSERT_EQ(world.pairs_with(world.partition(), all), Status::ok);
  ASSERT_EQ(world.pairs_with(world.partition(), some, {Order::fast, true, predicate}), Status::ok);
  const auto accepted = std::ranges::count_if(
      all, [&](const Pair& pair) { return accept(nullptr, pair.first, pair.second); });
  EXPECT_EQ(some.size(), static_cast<std::size_t>(accepted));
}

TEST_P(Events, steady_frames_do_not_allocate) {
  for (const auto& [motion, client_data] :
       {std::pair(Motion::few, false), std::pair(Motion::much, false), std::pair(Motion::few, true),
        std::pair(Motion::much, true)}) {
    World world(config());
    CountingMemory results;
    PairBuffer buffer(&results);
    PairEvents events({&results, client_data});
    std::vector<std::vector<Aabb>> frames{uniform_boxes(scene_size(500))};
    Random random(1);
    while (frames.size() < 4) {
      frames.push_back(frames.back());
      move(motion, frames.back(), random);
    }
    const std::vector<Key> keys = world.insert(frames[0]);
    const auto play = [&](std::size_t frame) {
      world.update(keys, frames[frame % frames.size()]);
      ASSERT_EQ(
          world.threads().run([&] { return world.partition().self_pairs(buffer, events, {}); }),
          Status::ok);
    };
    for (std::size_t frame = 0; frame < 12; ++frame) play(frame);
    const std::size_t requests = results.requests();
    for (std::size_t frame = 12; frame < 24; ++frame) play(frame);
    EXPECT_EQ(results.requests(), requests);
    EXPECT_EQ(buffer.footprint().total().reserved + events.footprint().total().reserved,
              results.outstanding());
  }
}

INSTANTIATE_TEST_SUITE_P(All, Events, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

// Frames are byte-identical on every instruction set and number of threads.
TEST(EventsOfAnyConfig, events_are_equal_in_every_config) {
  for (const std::string_view name : structure_names()) {
    std::vector<std::tuple<std::vector<Pair>, std::size_t, std::size_t>> expected;
    for (const Config& config : all_configs()) {
      if (config.partition != name) continue;
      const IsaScope isa(config.isa);
      World world(config);
      PairBuffer buffer;
      PairEvents events;
      std::vector<Aabb> boxes = uniform_boxes(world.partition().is_exact() ? 3000 : 100);
      const std::vector<Key> keys = world.insert(boxes);
      Random random(9);
      for (std::size_t frame = 0; frame < 12; ++frame) {
        if (frame < 5) {
          move(frame % 2 == 0 ? Motion::few : Motion::little, boxes, random);
          world.update(keys, boxes);
        } else {
          // Only one object changes, so that the buffer is updated through its links
          // (linked_pairs.h).
          const std::size_t at = random.below(keys.size());
          boxes[at] = boxes[random.below(keys.size())];
          world.update(keys[at], boxes[at]);
        }
        ASSERT_EQ(
            world.threads().run([&] { return world.partition().self_pairs(buffer, events, {}); }),
            Status::ok);
        const std::tuple got(std::vector<Pair>(buffer.begin(), buffer.end()), events.begun().size(),
                             events.ended().size());
        if (expected.size() == frame) expected.push_back(got);
        EXPECT_EQ(got, expected[frame]) << to_string(config);
      }
    }
  }
}

// A frame without motion compares nothing: its cost does not depend on the number of pairs.
TEST(EventsOfAStillFrame, still_frame_has_no_events_and_no_tests) {
  for (const std::string_view name : structure_names()) {
    World world(Config{std::string(name), active_isa(), 1});
    Frames frames(world);
    world.insert(uniform_boxes(100));
    ASSERT_TRUE(frames.next());
    ASSERT_TRUE(frames.next());
    EXPECT_EQ(world.partition().statistics().last_tests, 0U);
    EXPECT_EQ(frames.events.persisting(), frames.buffer.size());
  }
}

}  // namespace
}  // namespace winnow::test
