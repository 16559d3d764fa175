// Motion over many frames: with one buffer carried along, and with everything a caller may do to
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
// No multiple of a block of 16 rows, so that the last block is one in part.
constexpr std::size_t kObjects = 405;
constexpr std::size_t kFew = 133;

class Frames : public Conformance {
 protected:
  // Runs a test on scenes that fill the regular part of every partition and on one that does not.
  template <typename Body>
  void from_each_start(std::size_t wanted, const Body& body) {
    // What reports every pair is judged by every pair.
    const std::size_t count = config().make().is_exact() ? wanted : std::min(wanted, kFew);
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

  // Moves the boxes and tells the partition of those that changed.
  void step(Motion motion) {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    for (const std::size_t i : move(motion, boxes_, random_)) {
      keys.push_back(keys_[i]);
      boxes.push_back(boxes_[i]);
    }
    world_->update(keys, boxes);
  }

  // Removes some objects and inserts as many others.
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

TEST_P(Frames, with_one_buffer_are_right_for_every_kind_of_motion) {
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

TEST_P(Frames, in_canonical_order_are_right_for_every_kind_of_motion) {
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

TEST_P(Frames, that_change_order_and_increment_from_frame_to_frame_are_right) {
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

TEST_P(Frames, with_other_buffers_in_between_are_right) {
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

TEST_P(Frames, with_the_buffer_lent_to_another_partition_are_right) {
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

TEST_P(Frames, with_the_buffer_used_for_pairs_with_in_between_are_right) {
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

TEST_P(Frames, with_the_buffer_cleared_or_edited_in_between_are_right) {
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

TEST_P(Frames, with_objects_coming_and_going_are_right) {
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

TEST_P(Frames, with_a_clear_in_between_are_right) {
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

// A box that says the same again has not moved; one that moves away and back has not either.
TEST_P(Frames, in_which_boxes_return_to_where_they_were_are_right) {
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

// Structure that is kept from frame to frame must follow when the scene turns into another.
TEST_P(Frames, that_turn_one_scene_into_another_are_right) {
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

TEST_P(LargeFrames, are_right_for_every_kind_of_motion) {
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
