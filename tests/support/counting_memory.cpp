#include "tests/support/counting_memory.h"

#include <gtest/gtest.h>

#include <new>

#include "tests/support/platform.h"

namespace winnow::test {
namespace {

// More bytes than any machine has. Such requests are refused here, because sanitizers would end the
// process instead of throwing.
constexpr std::size_t kMaxBytes = ~std::size_t{0} >> (sizeof(std::size_t) > 4 ? 24U : 1U);

}  // namespace

CountingMemory::~CountingMemory() {
  EXPECT_EQ(outstanding_, 0U) << blocks_.size() << " blocks were never freed";
}

std::size_t CountingMemory::outstanding() const {
  const Lock lock(mutex_);
  return outstanding_;
}

std::size_t CountingMemory::requests() const {
  const Lock lock(mutex_);
  return requests_;
}

std::size_t CountingMemory::refusals() const {
  const Lock lock(mutex_);
  return refusals_;
}

std::size_t CountingMemory::requests_from_elsewhere() const {
  const Lock lock(mutex_);
  return requests_from_elsewhere_;
}

void CountingMemory::refuse_after(std::size_t count) {
  const Lock lock(mutex_);
  refuse_from_ = requests_ + count;
  refuse_to_ = kNever;
}

void CountingMemory::refuse_one_after(std::size_t count) {
  const Lock lock(mutex_);
  refuse_from_ = requests_ + count;
  refuse_to_ = refuse_from_ + 1;
}

void CountingMemory::refuse_beyond(std::size_t bytes) {
  const Lock lock(mutex_);
  limit_ = bytes;
}

void CountingMemory::grant_all() {
  const Lock lock(mutex_);
  refuse_from_ = refuse_to_ = limit_ = kNever;
}

void* CountingMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
  const Lock lock(mutex_);
  const std::size_t request = requests_++;
#if WINNOW_TEST_THREADS
  if (std::this_thread::get_id() != owner_) ++requests_from_elsewhere_;
#endif
  const bool too_many = bytes > kMaxBytes || outstanding_ + bytes > limit_;
  if (too_many || (request >= refuse_from_ && request < refuse_to_)) {
    ++refusals_;
    refuse_memory();
  }
  void* block = ::operator new(bytes, std::align_val_t(alignment));
  blocks_[block] = {bytes, alignment};
  outstanding_ += bytes;
  return block;
}

void CountingMemory::do_deallocate(void* block, std::size_t bytes, std::size_t alignment) {
  const Lock lock(mutex_);
  const auto found = blocks_.find(block);
  if (found == blocks_.end()) {
    ADD_FAILURE() << "a block was freed that was never allocated";
    return;
  }
  EXPECT_EQ(found->second.bytes, bytes);
  EXPECT_EQ(found->second.alignment, alignment);
  outstanding_ -= found->second.bytes;
  ::operator delete(block, std::align_val_t(found->second.alignment));
  blocks_.erase(found);
}

bool CountingMemory::do_is_equal(const memory_resource& other) const noexcept {
  return this == &other;
}

}  // namespace winnow::test
