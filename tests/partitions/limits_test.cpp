// More than machines that run tests hold, on memory that is counted and never written to, or
// refused.

#include <sys/mman.h>

#include <algorithm>
#include <new>

#include "partitions/pairs/pair_writer.h"
#include "tests/support/counting_memory.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

/// Hands out addresses of which pages are made when they are first written to.
class UntouchedMemory final : public std::pmr::memory_resource {
 public:
  UntouchedMemory() = default;
  UntouchedMemory(const UntouchedMemory&) = delete;
  UntouchedMemory& operator=(const UntouchedMemory&) = delete;
  ~UntouchedMemory() override { EXPECT_EQ(outstanding_, 0U); }

  [[nodiscard]] std::size_t outstanding() const { return outstanding_; }

 private:
  void* do_allocate(std::size_t bytes, std::size_t /*alignment*/) override {
    void* const block = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (block == MAP_FAILED) throw std::bad_alloc();
    outstanding_ += bytes;
    return block;
  }
  void do_deallocate(void* block, std::size_t bytes, std::size_t /*alignment*/) override {
    ::munmap(block, bytes);
    outstanding_ -= bytes;
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::size_t outstanding_ = 0;
};

/// Takes room for so many pairs, of which it writes the last one alone.
bool put_pairs(PairSink& sink, std::size_t count, Pair last) {
  while (count != 0) {
    if (sink.cursor > sink.limit && !sink.grow(sink)) return false;
    const std::size_t room = static_cast<std::size_t>(sink.limit - sink.cursor) / 2 + kSinkSlack;
    const std::size_t put = std::min(count, room);
    sink.cursor += 2 * put;
    count -= put;
  }
  sink.cursor[-2] = last.first;
  sink.cursor[-1] = last.second;
  return true;
}

TEST(Limits, of_pairs_are_not_those_of_32_bits) {
  constexpr std::size_t kTasks = 9;
  constexpr std::size_t kOfTask = std::size_t{1} << 29U;
  constexpr Execution kSerial = Execution::serial();
  UntouchedMemory memory;
  PairBuffer buffer(&memory);
  if (!PairWriter::reserve(buffer, kTasks * kOfTask, kTasks, kSerial, Pages::untouched)) {
    GTEST_SKIP() << "no addresses for so many pairs";
  }
  const std::size_t reserved = memory.outstanding();
  PairWriter writer(buffer, kSerial);
  ASSERT_EQ(writer.append(kTasks,
                          [](std::size_t task, PairSink& sink) {
                            const auto id = static_cast<ObjectId>(task);
                            return put_pairs(sink, kOfTask, {id, id + 1});
                          }),
            Status::ok);
  ASSERT_EQ(buffer.size(), kTasks * kOfTask);
  for (ObjectId task = 0; task < kTasks; ++task) {
    EXPECT_EQ(buffer[(task + 1) * kOfTask - 1], (Pair{task, task + 1}));
  }
  EXPECT_EQ(memory.outstanding(), reserved);
  EXPECT_EQ(buffer.footprint().total().reserved, reserved);
}

class ObjectLimits : public Conformance {};

TEST_P(ObjectLimits, that_memory_is_refused_for_change_nothing) {
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
