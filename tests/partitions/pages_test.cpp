// Pages of the system: which pages reserve touches, and sizes with more addresses than memory.

#include <sys/mman.h>

#include <algorithm>

#include "partitions/pairs/pair_writer.h"
#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

// Hands out fresh pages and counts the pages that were written to.
class FreshPages final : public std::pmr::memory_resource {
 public:
  FreshPages()
      : begin_(static_cast<unsigned char*>(::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE,
                                                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1,
                                                  0))) {}
  FreshPages(const FreshPages&) = delete;
  FreshPages& operator=(const FreshPages&) = delete;
  ~FreshPages() override { ::munmap(begin_, kBytes); }

  [[nodiscard]] std::ptrdiff_t written() const {
    std::vector<unsigned char> pages(kBytes / kPage);
    EXPECT_EQ(::mincore(begin_, kBytes, pages.data()), 0);
    return std::ranges::count_if(pages, [](unsigned char page) { return (page & 1U) != 0; });
  }

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 28U;
  static constexpr std::size_t kPage = 4096;

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    used_ = (used_ + alignment - 1) / alignment * alignment + bytes;
    if (used_ > kBytes) refuse_memory();
    return begin_ + used_ - bytes;
  }
  void do_deallocate(void* /*block*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }

  unsigned char* begin_;
  std::size_t used_ = 0;
};

class Touched : public Conformance {};

TEST_P(Touched, reserve_touches_all_pages_of_a_frame) {
  FreshPages pages;
  World world(config(), &pages);
  PairBuffer buffer(&pages);
  const std::vector<Aabb> boxes = mixed_boxes(world.partition().is_exact() ? 4000 : 400);
  ASSERT_EQ(world.partition().reserve(boxes.size(), Pages::prefaulted), Status::ok);
  const std::size_t pairs = world.partition().is_exact() ? 200'000 : boxes.size() * boxes.size();
  ASSERT_EQ(world.partition().reserve_pairs(buffer, pairs, Pages::prefaulted), Status::ok);
  const std::ptrdiff_t before = pages.written();
  EXPECT_GT(before, 20);
  world.insert(boxes);
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  EXPECT_FALSE(buffer.empty());
  EXPECT_EQ(pages.written(), before);
}

INSTANTIATE_TEST_SUITE_P(All, Touched, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

/// Hands out addresses whose pages are created when they are first written to.
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
    if (block == MAP_FAILED) refuse_memory();
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

/// Takes room for `count` pairs, but writes only the last one.
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

TEST(Limits, number_of_pairs_may_exceed_32_bits) {
  constexpr std::size_t kTasks = 9;
  constexpr std::size_t kOfTask = std::size_t{1} << 29U;
  constexpr Execution kSerial = Execution::serial();
  UntouchedMemory memory;
  PairBuffer buffer(&memory);
  if (!PairWriter::reserve(buffer, kTasks * kOfTask, kTasks, kSerial, Pages::untouched)) {
    GTEST_SKIP() << "too few addresses for the pairs";
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

}  // namespace
}  // namespace winnow::test
