// The automatic structure while it switches from one structure to another, which must not change
// any result. Its common behaviour is tested together with all structures, by name.

#include <winnow/partitions/partition.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "tests/support/counting_memory.h"
#include "tests/support/motion.h"
#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

constexpr std::size_t kFew = 20;     // brute force is the best choice in any scene
constexpr std::size_t kMany = 1200;  // brute force is the worst choice
constexpr std::size_t kFramesOfEach = 120;

// A world whose number of objects changes enough to switch its structure.
class TurningWorld {
 public:
  explicit TurningWorld(const Config& config,
                        std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : world(config, memory) {}

  void fill(std::size_t count) {
    if (keys.size() > count) {
      world.remove(std::span<const Key>(keys).subspan(count));
      keys.resize(count);
      boxes.resize(count);
      return;
    }
    const std::vector<Aabb> all = mixed_boxes(kMany);
    const std::vector<Aabb> added(all.begin() + static_cast<std::ptrdiff_t>(keys.size()),
                                  all.begin() + static_cast<std::ptrdiff_t>(count));
    const std::vector<Key> fresh = world.insert(added, std::vector<ClientData>(added.size(), 7));
    keys.insert(keys.end(), fresh.begin(), fresh.end());
    boxes.insert(boxes.end(), added.begin(), added.end());
  }
  void step(Motion motion) {
    move(motion, boxes, random_);
    world.update(keys, boxes);
  }
  [[nodiscard]] const Partition& partition() const { return world.partition(); }
  /// The name of the structure in use.
  [[nodiscard]] std::string_view chosen() const { return partition().choice().structure.name(); }
  [[nodiscard]] std::uint64_t changes() const { return partition().choice().changes; }

  World world;
  std::vector<Aabb> boxes;
  std::vector<Key> keys;

 private:
  Random random_{17};
};

// The numbers of objects in successive frames: few, many, few, many, few.
std::vector<std::size_t> turning_counts() {
  std::vector<std::size_t> counts;
  for (const std::size_t count : {kFew, kMany, kFew, kMany, kFew})
    counts.insert(counts.end(), kFramesOfEach, count);
  return counts;
}

std::vector<Config> auto_configs() {
  std::vector<Config> configs;
  for (const Config& config : all_configs()) {
    if (config.partition == "AutoPartition") configs.push_back(config);
  }
  return configs;
}

class AutomaticChoice : public Conformance {};

TEST_P(AutomaticChoice, switch_keeps_keys_filters_data_and_pairs) {
  TurningWorld scene(config());
  PairBuffer buffer;
  std::set<std::string_view> chosen;
  scene.fill(kFew);
  scene.world.set_filter(scene.keys[3], {.layers = 2});
  scene.world.set_filter(scene.keys[5], {.environment = 4});
  for (const std::size_t count : turning_counts()) {
    scene.fill(count);
    scene.step(Motion::few);
    ASSERT_TRUE(scene.world.agrees(buffer)) << count << " objects";
    ASSERT_TRUE(scene.world.holds_its_objects()) << count << " objects";
    chosen.insert(scene.chosen());
  }
  EXPECT_GE(scene.changes(), 2U);
  EXPECT_GE(chosen.size(), 2U);
}

// With at most kFew objects, brute force is chosen without a comparison of costs.
TEST_P(AutomaticChoice, few_objects_begin_with_brute_force) {
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{8}, kFew}) {
    TurningWorld scene(config());
    PairBuffer buffer;
    scene.fill(count);
    ASSERT_TRUE(scene.world.agrees(buffer));
    EXPECT_EQ(scene.chosen(), "BoundsNSquared") << count << " objects";
  }
}

TEST_P(AutomaticChoice, scene_with_many_infinite_boxes_is_handled) {
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(kMany);
  for (std::size_t i = 0; i < boxes.size(); i += 5) {
    boxes[i].min[static_cast<int>(i % 3)] = -kEndless;
    if (i % 2 == 0) boxes[i].max[static_cast<int>(i % 3)] = kEndless;
  }
  (void)world.insert(boxes, std::vector<ClientData>(boxes.size(), 7));
  PairBuffer buffer;
  EXPECT_TRUE(world.agrees(buffer));
  EXPECT_TRUE(std::isfinite(world.partition().choice().features.crowding));
}

// Returns the ids of pairs that began or ended.
std::vector<Pair> ids_of(std::span<const KeyPair> pairs) {
  std::vector<Pair> ids;
  for (const auto& [first, second] : pairs) ids.push_back({first.id, second.id});
  return ids;
}

TEST_P(AutomaticChoice, pair_events_equal_those_of_one_structure) {
  TurningWorld turning(config());
  TurningWorld steady({"LinearBvh", config().isa, config().threads});
  PairBuffer turning_pairs;
  PairBuffer steady_pairs;
  PairEvents turning_events;
  PairEvents steady_events;
  const PairOptions canonical{.order = Order::canonical};
  for (const std::size_t count : turning_counts()) {
    for (TurningWorld* scene : {&turning, &steady}) {
      scene->fill(count);
      scene->step(Motion::few);
    }
    ASSERT_EQ(turning.world.partition().self_pairs(turning_pairs, turning_events, canonical),
              Status::ok);
    ASSERT_EQ(steady.world.partition().self_pairs(steady_pairs, steady_events, canonical),
              Status::ok);
    ASSERT_EQ(ids_of(turning_events.begun()), ids_of(steady_events.begun())) << count;
    ASSERT_EQ(ids_of(turning_events.ended()), ids_of(steady_events.ended())) << count;
    ASSERT_EQ(turning_events.persisting(), steady_events.persisting()) << count;
  }
  EXPECT_GE(turning.changes(), 2U);
}

// A query for changes only must not turn into a full query.
TEST_P(AutomaticChoice, switch_keeps_tracked_buffers_up_to_date) {
  TurningWorld scene(config());
  PairBuffer buffer;
  scene.fill(kMany);
  ASSERT_TRUE(scene.world.agrees(buffer));
  scene.fill(kFew);
  ASSERT_TRUE(scene.world.agrees(buffer));
  const std::uint64_t changes = scene.changes();
  scene.fill(kMany / 2);
  const std::uint64_t full = scene.partition().statistics().full_queries;
  ASSERT_TRUE(scene.world.agrees(buffer));
  ASSERT_GT(changes, 0U);
  scene.world.update(scene.keys[0], scene.boxes[1]);
  ASSERT_TRUE(scene.world.agrees(buffer));
  EXPECT_LE(scene.partition().statistics().full_queries, full + 1);
}

TEST_P(AutomaticChoice, choice_does_not_depend_on_isa_and_threads) {
  const auto choices = [](const Config& config) {
    const IsaScope isa(config.isa);
    TurningWorld scene(config);
    PairBuffer buffer;
    std::vector<std::string_view> chosen;
    for (const std::size_t count : turning_counts()) {
      scene.fill(count);
      scene.step(Motion::little);
      EXPECT_EQ(scene.world.self_pairs(buffer), Status::ok);
      chosen.push_back(scene.chosen());
    }
    return chosen;
  };
  EXPECT_EQ(choices(config()), choices(auto_configs().front()));
}

TEST_P(AutomaticChoice, refused_calls_do_not_change_the_choice) {
  TurningWorld plain(config());
  TurningWorld refused(config());
  PairBuffer pairs;
  PairBuffer same_pairs;
  for (TurningWorld* scene : {&plain, &refused}) scene->fill(kMany);
  Partition& partition = refused.world.partition();
  std::vector<Key> stale_keys = refused.keys;
  stale_keys.back() = {};
  std::vector<Aabb> no_boxes = refused.boxes;
  no_boxes.back().min[0] = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t frame = 0; frame < kFramesOfEach; ++frame) {
    for (TurningWorld* scene : {&plain, &refused}) {
      scene->world.update(scene->keys[frame], scene->boxes[frame]);
    }
    ASSERT_EQ(partition.update(stale_keys, refused.boxes), Status::invalid_key);
    ASSERT_EQ(partition.update(refused.keys, no_boxes), Status::invalid_bounds);
    ASSERT_EQ(partition.update(refused.keys[0], no_boxes.back()), Status::invalid_bounds);
    ASSERT_EQ(partition.remove(stale_keys), Status::invalid_key);
    ASSERT_EQ(partition.insert(no_boxes, {}, stale_keys), Status::invalid_bounds);
    ASSERT_EQ(plain.world.self_pairs(pairs), Status::ok);
    ASSERT_EQ(refused.world.self_pairs(same_pairs), Status::ok);
    ASSERT_EQ(refused.chosen(), plain.chosen()) << "frame " << frame;
    ASSERT_EQ(refused.changes(), plain.changes()) << "frame " << frame;
  }
  // The update of one object per frame changes the choice, an update of all objects would not.
  EXPECT_GE(plain.changes(), 1U);
}

// Each switch must save twice as much as the switch before it. The number of switches therefore
// grows only with the logarithm of the number of frames.
TEST_P(AutomaticChoice, alternating_scene_switches_less_and_less) {
  TurningWorld scene(config());
  PairBuffer buffer;
  std::array<std::uint64_t, 2> changes{};
  for (int frame = 0; frame < 160; ++frame) {
    scene.fill(frame % 2 == 0 ? kFew : kMany);
    ASSERT_EQ(scene.world.self_pairs(buffer), Status::ok);
    if (frame == 39) changes[0] = scene.changes();
  }
  changes[1] = scene.changes();
  EXPECT_LE(changes[0], 10U);
  EXPECT_LE(changes[1] - changes[0], 4U)
      << "in the three times as many frames after " << changes[0];
}

TEST_P(AutomaticChoice, refused_memory_during_a_switch_is_recoverable) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  for (const auto& [from, to] : {std::pair{kFew, kMany}, std::pair{kMany, kFew}}) {
    bool refused = true;
    for (std::size_t n = 0; refused; ++n) {
      ASSERT_LT(n, 100U) << "never enough memory";
      TurningWorld scene(config(), &memory);
      PairBuffer buffer;
      scene.fill(from);
      ASSERT_TRUE(scene.world.agrees(buffer));
      const std::string_view before = scene.chosen();
      scene.fill(to);
      const std::size_t refusals = memory.refusals();
      memory.refuse_after(n);
      const Status status = scene.world.threads().run([&] { return scene.partition().refresh(); });
      memory.grant_all();
      refused = memory.refusals() != refusals;
      ASSERT_TRUE(status == Status::ok || (refused && status == Status::out_of_memory));
      if (!refused) {
        EXPECT_NE(scene.chosen(), before);
      }
      ASSERT_TRUE(scene.world.holds_its_objects()) << "refused after " << n;
      EXPECT_EQ(scene.partition().footprint().total().reserved, memory.outstanding());
      ASSERT_TRUE(scene.world.agrees(buffer)) << "refused after " << n;
    }
  }
}

TEST(AutomaticReserve, reserve_suffices_for_each_possible_structure) {
  const auto reserved_by = [](StructureKind kind) {
    Partition partition(kind);
    EXPECT_EQ(partition.reserve(kMany), Status::ok);
    return partition.footprint().total().reserved;
  };
  const std::size_t together = reserved_by(automatic());
  for (const StructureKind kind : {bounds_n_squared(), hierarchical_grid(), linear_bvh()}) {
    EXPECT_GE(together, reserved_by(kind)) << kind.name();
  }
}

#if WINNOW_TEST_THREADS
TEST_P(AutomaticChoice, concurrent_queries_during_a_switch_are_safe) {
  TurningWorld scene(config());
  constexpr std::size_t kReaders = 4;
  std::array<PairBuffer, kReaders> buffers;
  std::array<bool, kReaders> right{};
  for (const std::size_t count : turning_counts()) {
    scene.fill(count);
    scene.step(Motion::few);
    const Partition& p = scene.partition();
    const std::vector<Pair> truth = true_pairs(scene.world.objects());
    std::vector<std::thread> readers;
    for (std::size_t i = 0; i < kReaders; ++i) {
      readers.emplace_back([&, i] {
        Aabb box;
        right[i] = p.size() == count && p.contains(scene.keys[i]) &&
                   p.bounds(scene.keys[i]).get(box) == Status::ok && !scene.chosen().empty() &&
                   p.footprint().total().reserved != 0 && p.self_pairs(buffers[i]) == Status::ok &&
                   box == scene.boxes[i] && right_pairs(buffers[i].pairs(), truth, true);
      });
    }
    for (std::thread& reader : readers) reader.join();
    for (const bool one : right) ASSERT_TRUE(one) << count << " objects";
  }
  EXPECT_GE(scene.changes(), 2U);
}
#endif

TEST_P(AutomaticChoice, pairs_with_is_right_during_a_switch) {
  TurningWorld a(config());
  TurningWorld b(config());
  b.fill(kFew);
  PairBuffer buffer;
  for (const std::size_t count : turning_counts()) {
    a.fill(count);
    b.fill(kMany + kFew - count);
    ASSERT_EQ(a.world.pairs_with(b.world.partition(), buffer), Status::ok);
    ASSERT_TRUE(
        right_cross_pairs(buffer.pairs(), cross_pairs(a.world.objects(), b.world.objects()), true))
        << count << " objects";
  }
  EXPECT_GE(a.changes() + b.changes(), 2U);
}

INSTANTIATE_TEST_SUITE_P(All, AutomaticChoice, testing::ValuesIn(auto_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
