// LargePages: blocks that do not overlap, slabs that return to the system, refused memory and
// concurrent threads; and the default memory resource.

#include <gtest/gtest.h>
#include <winnow/core/memory.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <random>
#include <vector>

#include "tests/support/counting_memory.h"
#include "tests/support/platform.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

constexpr std::size_t kMega = std::size_t{1} << 20U;
constexpr std::size_t kKept = 8 * kMega;

#ifdef __linux__
constexpr bool kHasSlabs = true;
#else
constexpr bool kHasSlabs = false;
#endif

/// Blocks of random sizes and alignments, each filled with its own byte.
class Blocks {
 public:
  Blocks(LargePages& memory, unsigned seed) : memory_(memory), random_(seed) {}

  void add() {
    const std::size_t size = std::size_t{1} << below(23);
    Block block{nullptr, size + below(size), std::size_t{1} << below(13), next_++};
    block.at = static_cast<std::uint8_t*>(memory_.allocate(block.bytes, block.alignment));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.at) % block.alignment, 0U);
    std::memset(block.at, block.content, block.bytes);
    blocks_.push_back(block);
  }
  void remove() {
    if (blocks_.empty()) return;
    std::swap(blocks_[below(blocks_.size())], blocks_.back());
    const Block block = blocks_.back();
    blocks_.pop_back();
    EXPECT_TRUE(std::all_of(block.at, block.at + block.bytes,
                            [&](std::uint8_t byte) { return byte == block.content; }))
        << "a block of " << block.bytes << " bytes was written to by another one";
    memory_.deallocate(block.at, block.bytes, block.alignment);
  }
  void remove_all() {
    while (!blocks_.empty()) remove();
  }
  [[nodiscard]] std::size_t large_bytes() const {
    std::size_t sum = 0;
    for (const Block& block : blocks_) {
      if (block.bytes >= LargePages::kLargeBlock) sum += (block.bytes + 63) / 64 * 64;
    }
    return sum;
  }
  [[nodiscard]] std::size_t size() const { return blocks_.size(); }
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

 private:
  struct Block {
    std::uint8_t* at;
    std::size_t bytes;
    std::size_t alignment;
    std::uint8_t content;
  };
  LargePages& memory_;
  std::mt19937 random_;
  std::vector<Block> blocks_;
  std::uint8_t next_ = 0;
};

TEST(LargePages, blocks_do_not_overlap) {
  CountingMemory small;
  {
    LargePages memory(&small);
    Blocks blocks(memory, 1);
    for (unsigned round = 0; round < 1500; ++round) {
      if (blocks.below(blocks.size() + 20) < 20) {
        blocks.add();
      } else {
        blocks.remove();
      }
      if (!kHasSlabs) continue;
      ASSERT_EQ(memory.used_bytes(), blocks.large_bytes());
      ASSERT_GE(memory.held_bytes(), memory.used_bytes());
      ASSERT_EQ(memory.held_bytes() % LargePages::kPage, 0U);
    }
    blocks.remove_all();
    EXPECT_EQ(memory.used_bytes(), 0U);
    EXPECT_LE(memory.held_bytes(), kKept);
  }
  EXPECT_EQ(small.outstanding(), 0U);
}

TEST(LargePages, large_blocks_share_slabs_small_ones_do_not) {
  if (!kHasSlabs) GTEST_SKIP() << "there are no slabs on this system";
  CountingMemory small;
  LargePages memory(&small);
  constexpr std::size_t kBytes = LargePages::kLargeBlock + 1;
  auto* const first = static_cast<std::byte*>(memory.allocate(kBytes, 4));
  auto* const second = static_cast<std::byte*>(memory.allocate(kBytes, 64));
  EXPECT_EQ(second - first, static_cast<std::ptrdiff_t>(LargePages::kLargeBlock + 64));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first) % LargePages::kPage, 0U);
  const std::size_t own = small.outstanding();
  void* const little = memory.allocate(LargePages::kLargeBlock - 1, 64);
  EXPECT_EQ(small.outstanding(), own + LargePages::kLargeBlock - 1);
  memory.deallocate(little, LargePages::kLargeBlock - 1, 64);
  EXPECT_EQ(small.outstanding(), own);
  // The next allocation returns the freed block.
  memory.deallocate(first, kBytes, 4);
  EXPECT_EQ(memory.allocate(kBytes, 64), first);
  memory.deallocate(first, kBytes, 64);
  memory.deallocate(second, kBytes, 64);
  EXPECT_EQ(memory.held_bytes(), LargePages::kPage);
}

TEST(LargePages, most_empty_slabs_return_to_the_system) {
  if (!kHasSlabs) GTEST_SKIP() << "there are no slabs on this system";
  LargePages memory;
  std::array<void*, 40> blocks{};
  for (void*& block : blocks) block = memory.allocate(3 * kMega, 64);
  EXPECT_GE(memory.held_bytes(), 120 * kMega);
  EXPECT_LE(memory.held_bytes(), 180 * kMega);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    memory.deallocate(blocks[i], 3 * kMega, 64);
    const std::size_t free = memory.held_bytes() - memory.used_bytes();
    // The slab of the next block to free cannot return to the system yet.
    EXPECT_LE(free, std::max(memory.used_bytes(), kKept) + 64 * kMega) << "after " << i;
  }
  EXPECT_LE(memory.held_bytes(), kKept);
  // A block that is allocated and freed each frame makes no system call.
  void* block = memory.allocate(6 * kMega, 64);
  const std::size_t held = memory.held_bytes();
  memory.deallocate(block, 6 * kMega, 64);
  EXPECT_EQ(memory.held_bytes(), held);
}

#if WINNOW_TEST_EXCEPTIONS
TEST(LargePages, refused_allocation_changes_nothing) {
  CountingMemory small;
  LargePages memory(&small);
  EXPECT_THROW((void)memory.allocate(std::numeric_limits<std::size_t>::max() - 64, 64),
               std::bad_alloc);
  // More than the address space.
  EXPECT_THROW((void)memory.allocate(std::size_t{1} << 60U, 64), std::bad_alloc);
  EXPECT_EQ(memory.held_bytes(), 0U);
  if (!kHasSlabs) return;
  // Without memory for the records of LargePages, the allocation fails.
  LargePages other(&small);
  small.refuse_after(0);
  EXPECT_THROW((void)other.allocate(kMega, 64), std::bad_alloc);
  EXPECT_EQ(other.held_bytes(), 0U);
  small.grant_all();
  void* const block = other.allocate(kMega, 64);
  EXPECT_EQ(other.used_bytes(), kMega);
  other.deallocate(block, kMega, 64);
}

TEST(LargePages, without_own_memory_blocks_come_from_upstream) {
  CountingMemory small;
  small.refuse_after(0);
  LargePages memory(&small);
  EXPECT_THROW((void)memory.allocate(kMega, 64), std::bad_alloc);
  small.grant_all();
  void* const block = memory.allocate(kMega, 64);
  EXPECT_EQ(small.outstanding(), kMega);
  memory.deallocate(block, kMega, 64);
}
#endif

#if WINNOW_TEST_THREADS
TEST(LargePages, concurrent_threads_keep_blocks_apart) {
  LargePages memory;
  const auto work = [&](unsigned seed) {
    Blocks blocks(memory, seed);
    for (unsigned round = 0; round < 300; ++round) {
      if (blocks.below(blocks.size() + 10) < 10) {
        blocks.add();
      } else {
        blocks.remove();
      }
    }
    blocks.remove_all();
  };
  std::vector<std::thread> threads;
  for (unsigned seed = 0; seed < 4; ++seed) threads.emplace_back(work, seed);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(memory.used_bytes(), 0U);
}
#endif

TEST(DefaultMemory, default_memory_is_the_resource_of_the_program) {
  EXPECT_EQ(default_memory(), default_memory());
  CountingMemory own;
  std::pmr::memory_resource* const before = std::pmr::set_default_resource(&own);
  EXPECT_EQ(default_memory(), &own);
  std::pmr::set_default_resource(before);
  EXPECT_NE(default_memory(), &own);
  void* const block = default_memory()->allocate(kMega, 64);
  std::memset(block, 1, kMega);
  default_memory()->deallocate(block, kMega, 64);
}

}  // namespace
}  // namespace winnow::test
