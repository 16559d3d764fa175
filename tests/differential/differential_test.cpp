// Compares all exact partitions with each other on moving scenes, larger than the brute-force
// reference can check, on every instruction set. Set WINNOW_SEED for other scenes.

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "tests/support/hostile_scenes.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Maker = std::vector<Aabb> (*)(std::size_t, std::uint64_t);

struct Start {
  const char* name;
  Maker make;
};

const Start kStarts[] = {
    {"uniform", uniform_boxes},
    {"clustered", clustered_boxes},
    {"mixed", mixed_boxes},
    {"wall", [](std::size_t n, std::uint64_t stream) { return wall_boxes(n, 1, stream); }},
    {"two_scales", two_scale_boxes},
    {"outlier", outlier_boxes},
};

struct Case {
  const Start* start;
  Isa isa;
};

std::string to_string(const Case& each) {
  return std::string(each.start->name) + "_" + winnow::to_string(each.isa);
}
void PrintTo(const Case& each, std::ostream* out) {
  *out << to_string(each);
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const Start& start : kStarts) {
    for (const Isa isa : available_isas()) cases.push_back({&start, isa});
  }
  return cases;
}

// The partitions that are compared: exact ones, alternately on one thread and on several, each with
// its own pair buffer that is reused in every frame.
class Field {
 public:
  Field(Isa isa, const std::vector<Aabb>& boxes) {
    for (const std::string_view name : structure_names()) {
      const int threads = thread_counts()[players_.size() % thread_counts().size()];
      auto world = std::make_unique<World>(Config{std::string(name), isa, threads});
      if (!world->partition().is_exact()) continue;
      keys_ = world->insert(boxes);
      players_.push_back({std::move(world), PairBuffer()});
    }
  }

  void update(const std::vector<std::size_t>& changed, const std::vector<Aabb>& boxes) {
    for (Player& player : players_) {
      std::vector<Key> keys;
      std::vector<Aabb> moved;
      for (const std::size_t i : changed) {
        keys.push_back(player.world->partition().key_of(keys_[i].id));
        moved.push_back(boxes[i]);
      }
      player.world->update(keys, moved);
    }
  }

  // Returns the canonical pairs if all partitions have the same ones.
  std::optional<std::vector<Pair>> agreed_pairs() {
    std::optional<std::vector<Pair>> agreed;
    for (Player& player : players_) {
      EXPECT_EQ(player.world->self_pairs(player.buffer, {.order = Order::canonical}), Status::ok);
      if (!agreed) agreed.emplace(player.buffer.begin(), player.buffer.end());
      if (!std::ranges::equal(player.buffer, *agreed)) {
        ADD_FAILURE() << player.world->partition().name() << " found " << player.buffer.size()
                      << " pairs, " << players_[0].world->partition().name() << " "
                      << agreed->size() << ", or others";
        return std::nullopt;
      }
    }
    return agreed;
  }

 private:
  struct Player {
    std::unique_ptr<World> world;
    PairBuffer buffer;
  };
  std::vector<Player> players_;
  std::vector<Key> keys_;  // of the last partition; all partitions have equal ids
};

class Differential : public testing::TestWithParam<Case> {};

TEST_P(Differential, partitions_agree_frame_by_frame) {
  const IsaScope isa(GetParam().isa);
  Random random(77);
  for (int round = 0; round < 3; ++round) {
    const std::size_t count = scaled(static_cast<std::size_t>(random.log_uniform(500, 20000)));
    const std::uint64_t stream = random.bits();
    SCOPED_TRACE(testing::Message() << count << " objects, stream " << stream);
    std::vector<Aabb> boxes = GetParam().start->make(count, stream);
    Field field(GetParam().isa, boxes);
    for (int frame = 0; frame < 6; ++frame) {
      const Motion motion = kMotions[random.below(kMotions.size())];
      field.update(move(motion, boxes, random), boxes);
      const auto agreed = field.agreed_pairs();
      ASSERT_TRUE(agreed.has_value()) << to_string(motion) << ", frame " << frame;
      // Agreement is no proof: compares with an independent sweep.
      if (frame == 5) {
        EXPECT_EQ(*agreed, swept_pairs(numbered(boxes)));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Differential, testing::ValuesIn(all_cases()),
                         testing::PrintToStringParamName());

// Compares the fast reference of the tests with the slow one, since all large scenes rely on it.
TEST(Twins, sweep_reference_agrees_with_brute_force) {
  for (const Start& start : kStarts) {
    const std::vector<Object> objects = numbered(start.make(1200, 9));
    EXPECT_EQ(swept_pairs(objects), brute_force_pairs(objects)) << start.name;
  }
  for (const auto* scenes : {&degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      const std::vector<Object> objects = numbered(scene.boxes);
      EXPECT_EQ(swept_pairs(objects), brute_force_pairs(objects)) << scene.name;
    }
  }
}

}  // namespace
}  // namespace winnow::test
