#include "tests/support/heap_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/platform.h"

namespace {
std::atomic<std::size_t> requests{0};
}  // namespace

namespace winnow::test {
std::size_t heap_requests() noexcept {
  return requests.load();
}
}  // namespace winnow::test

#if WINNOW_TEST_EXCEPTIONS && !defined(_WIN32)
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !(defined(__has_feature) && defined(__clang__))
#define WINNOW_COUNT_HEAP 1
#elif defined(__clang__)
#if !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer)
#define WINNOW_COUNT_HEAP 1
#endif
#endif
#endif

#ifdef WINNOW_COUNT_HEAP

void* operator new(std::size_t bytes) {
  requests.fetch_add(1, std::memory_order_relaxed);
  if (void* block = std::malloc(bytes != 0 ? bytes : 1)) return block;
  winnow::test::refuse_memory();
}

void* operator new(std::size_t bytes, std::align_val_t alignment) {
  requests.fetch_add(1, std::memory_order_relaxed);
  const auto line = static_cast<std::size_t>(alignment);
  if (void* block = std::aligned_alloc(line, (bytes + line - 1) / line * line)) return block;
  winnow::test::refuse_memory();
}

void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  std::free(block);
}

#endif
