// Sizes beyond the memory of test machines, with memory that is refused.

#include "tests/support/counting_memory.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class ObjectLimits : public Conformance {};

TEST_P(ObjectLimits, reserve_of_too_many_objects_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  World world(config(), &memory);
  const std::vector<Key> keys = world.insert(uniform_boxes(100));
  const std::size_t before = memory.outstanding();
  memory.refuse_beyond(std::size_t{1} << 26U);
  for (const unsigned bits : {28U, 30U, 31U}) {
    EXPECT_EQ(world.partition().reserve((std::size_t{1} << bits) + 1), Status::out_of_memory);
  }
  EXPECT_EQ(world.partition().reserve(0xFFFFFFFEU), Status::out_of_memory);
  EXPECT_EQ(world.partition().reserve(std::size_t{1} << 32U), Status::too_many_objects);
  EXPECT_EQ(world.partition().footprint().total().reserved, memory.outstanding());
  EXPECT_LE(memory.outstanding(), before + (std::size_t{1} << 26U));
  memory.grant_all();
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

INSTANTIATE_TEST_SUITE_P(All, ObjectLimits, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
