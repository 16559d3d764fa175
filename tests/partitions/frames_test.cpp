// Motion over many frames with one reused pair buffer, including everything that a caller may do to
// that buffer in between.

#include <algorithm>
#include <optional>
#include <utility>

#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr int kFrames = 30;
// Not a multiple of a block of 16 rows, so that the last block is partial.
constexpr std::size_t kObjects = 405;
constexpr std::size_t kFew = 133;

class Frames : public Conformance {
 protected:
  // Calls `body` with a uniform, a mixed and a clustered scene.
  template <typename Body>
  void from_each_start(std::size_t requested, const Body& body) {
    // Partitions that report false pairs report too many of them in large scenes.
    const std::size_t count = config().make().is_exact() ? requested : std::min(requested, kFew);
    for (const auto& [name, boxes] :
         {std::pair{"uniform", uniform_boxes(count)}, std::pair{"mixed", mixed_boxes(count)},
          std::pair{"clustered", clustered_boxes(count)}}) {
      SCOPED_TRACE(name);
      world_.emplace(config());
      boxes_ = boxes;
      keys_ = world_->insert(boxes_);
      body();
      if (HasFatalFailure()) return;
    }
  }

  // Moves the boxes and updates the partition with the changed ones.
  void step(Motion motion) {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    for (const std::size_t i : move(motion, boxes_, random_)) {
      keys.push_back(keys_[i]);
      boxes.push_back(boxes_[i]);
    }
    world_->update(keys, boxes);
  }

  // Removes some objects and inserts the same number of new ones.
  void exchange(std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t i = random_.below(keys_.size());
      world_->remove(keys_[i]);
      boxes_[i] = boxes_[random_.below(boxes_.size())];
      keys_[i] = world_->insert(boxes_[i], n);
    }
  }

  std::optional<World> world_;
  std::vector<Aabb> boxes_;
  std::vector<Key> keys_;
  Random random_{99};
};

TEST_P(Frames, one_buffer_is_right_for_every_motion) {
  from_each_start(kObjects, [&] {
    for (const Motion motion : kMotions) {
      PairBuffer buffer;
      for (int frame = 0; frame < kFrames; ++frame) {
        step(motion);
        ASSERT_TRUE(world_->agrees(buffer)) << to_string(motion) << ", frame " << frame;
      }
    }
  });
}

TEST_P(Frames, canonical_order_is_right_for_every_motion) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    for (int frame = 0; frame < kFrames; ++frame) {
      const Motion motion = kMotions[static_cast<std::size_t>(frame) % kMotions.size()];
      step(motion);
      ASSERT_TRUE(world_->agrees(buffer, {.order = Order::canonical}))
          << to_string(motion) << ", frame " << frame;
    }
  });
}

TEST_P(Frames, changed_query_options_between_frames_are_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    for (int frame = 0; frame < kFrames; ++frame) {
      step(frame % 3 == 0 ? Motion::still : Motion::few);
      const PairOptions options{.order = frame % 2 == 0 ? Order::fast : Order::canonical,
                                .incremental = frame % 5 != 4};
      ASSERT_TRUE(world_->agrees(buffer, options)) << "frame " << frame;
    }
  });
}

TEST_P(Frames, several_buffers_at_different_rates_are_right) {
  from_each_start(kObjects, [&] {
    PairBuffer every_frame;
    PairBuffer every_third;
    PairBuffer every_seventh;
    for (int frame = 0; frame < kFrames; ++frame) {
      step(Motion::few);
      ASSERT_TRUE(world_->agrees(every_frame)) << "frame " << frame;
      if (frame % 3 == 0) {
        ASSERT_TRUE(world_->agrees(every_third)) << "frame " << frame;
      }
      if (frame % 7 == 0) {
        ASSERT_TRUE(world_->agrees(every_seventh)) << "frame " << frame;
      }
    }
  });
}

TEST_P(Frames, buffer_used_by_another_partition_is_right) {
  from_each_start(kObjects, [&] {
    for (const std::string_view name : structure_names()) {
      World other({std::string(name), config().isa, config().threads});
      std::vector<Aabb> boxes = uniform_boxes(200);
      const std::vector<Key> keys = other.insert(boxes);
      PairBuffer buffer;
      for (int frame = 0; frame < 8; ++frame) {
        step(Motion::few);
        ASSERT_TRUE(world_->agrees(buffer)) << name << ", frame " << frame;
        move(Motion::few, boxes, random_);
        other.update(keys, boxes);
        ASSERT_TRUE(other.agrees(buffer)) << name << ", frame " << frame;
      }
    }
  });
}

TEST_P(Frames, buffer_used_for_pairs_with_is_right) {
  from_each_start(kObjects, [&] {
    World other(config());
    other.insert(uniform_boxes(200));
    PairBuffer buffer;
    for (int frame = 0; frame < 10; ++frame) {
      step(Motion::few);
      ASSERT_EQ(world_->pairs_with(other.partition(), buffer), Status::ok);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    }
  });
}

TEST_P(Frames, cleared_or_edited_buffer_is_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    for (int frame = 0; frame < kFrames; ++frame) {
      step(Motion::few);
      if (frame % 4 == 1) buffer.clear();
      if (frame % 4 == 2 && !buffer.empty()) buffer.edit()[0] = {0, 0};
      if (frame % 4 == 3) buffer.edit().set_size(0);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    }
  });
}

TEST_P(Frames, objects_that_come_and_go_are_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    for (int frame = 0; frame < kFrames; ++frame) {
      step(frame % 2 == 0 ? Motion::few : Motion::little);
      exchange(random_.below(12));
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    }
    EXPECT_TRUE(world_->holds_its_objects());
  });
}

TEST_P(Frames, clear_between_frames_is_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    for (int round = 0; round < 4; ++round) {
      for (int frame = 0; frame < 3; ++frame) {
        step(Motion::few);
        ASSERT_TRUE(world_->agrees(buffer)) << "round " << round << ", frame " << frame;
      }
      world_->clear();
      ASSERT_TRUE(world_->agrees(buffer)) << "round " << round;
      EXPECT_TRUE(buffer.empty());
      keys_ = world_->insert(boxes_);
    }
  });
}

// An update with an equal box, or a move away and back, changes nothing.
TEST_P(Frames, boxes_that_return_are_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    const std::vector<Aabb> start = boxes_;
    for (int frame = 0; frame < 6; ++frame) {
      world_->update(keys_, start);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
      step(Motion::teleport);
      world_->update(keys_, start);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
      step(Motion::few);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
      boxes_ = start;
    }
  });
}

// A structure that is kept from frame to frame must follow if the scene changes completely.
TEST_P(Frames, scene_that_turns_into_another_is_right) {
  from_each_start(kObjects, [&] {
    PairBuffer buffer;
    const std::size_t n = boxes_.size();
    const std::vector<std::vector<Aabb>> scenes{
        uniform_boxes(n),   wall_boxes(n, 0),   wall_boxes(n, 1),
        clustered_boxes(n), outlier_boxes(n),   exponential_boxes(n),
        mixed_boxes(n, 5),  two_scale_boxes(n), wall_boxes(n, 2)};
    for (const std::vector<Aabb>& scene : scenes) {
      world_->update(keys_, scene);
      ASSERT_TRUE(world_->agrees(buffer));
      boxes_ = scene;
      step(Motion::few);
      ASSERT_TRUE(world_->agrees(buffer));
    }
  });
}

class LargeFrames : public Frames {};

TEST_P(LargeFrames, large_scenes_are_right_for_every_motion) {
  from_each_start(scaled(2504) + 1, [&] {
    PairBuffer buffer;
    for (const Motion motion : kMotions) {
      for (int frame = 0; frame < 4; ++frame) {
        step(motion);
        if (frame == 2) exchange(5);
        ASSERT_TRUE(world_->agrees(buffer)) << to_string(motion) << ", frame " << frame;
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(All, Frames, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(All, LargeFrames, testing::ValuesIn(exact_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
