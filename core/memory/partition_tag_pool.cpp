#include "core/memory/partition_tag_pool.h"

#include <atomic>
#include <bit>

namespace winnow {
namespace {

constexpr std::uint32_t kWordBits = 64;
constexpr std::uint32_t kWords = (PartitionTagPool::kMaxTags + 1) / kWordBits;

// One bit per tag, set while the tag is taken.
std::atomic<std::uint64_t> g_taken[kWords];
// A linked list of the tags of each table: element t is the tag that precedes tag t, or 0. Only the
// table that has tag t reads and writes element t.
std::uint32_t g_earlier[PartitionTagPool::kMaxTags + 1];
// The next search begins here, behind the tag taken last, so that freed tags are reused as late as
// possible.
std::atomic<std::uint32_t> g_next{1};

// Takes the first free tag of a word from a bit on; returns 0 if there is none.
std::uint32_t take_from(std::uint32_t word, std::uint32_t bit) noexcept {
  // Tag 0 is never given out.
  const std::uint64_t unfit = ((std::uint64_t{1} << bit) - 1) | (word == 0 ? 1U : 0U);
  std::uint64_t taken = g_taken[word].load(std::memory_order_relaxed);
  for (;;) {
    const std::uint64_t free = ~(taken | unfit);
    if (free == 0) return 0;
    const auto at = static_cast<std::uint32_t>(std::countr_zero(free));
    if (g_taken[word].compare_exchange_weak(taken, taken | std::uint64_t{1} << at,
                                            std::memory_order_acquire, std::memory_order_relaxed)) {
      return word * kWordBits + at;
    }
  }
}

// Returns 0 if no tag is free.
std::uint32_t take() noexcept {
  const std::uint32_t from = g_next.load(std::memory_order_relaxed);
  // The last step searches the first word again, from its beginning.
  for (std::uint32_t i = 0; i <= kWords; ++i) {
    const std::uint32_t word = (from / kWordBits + i) % kWords;
    const std::uint32_t tag = take_from(word, i == 0 ? from % kWordBits : 0);
    if (tag == 0) continue;
    g_next.store((tag + 1) % (PartitionTagPool::kMaxTags + 1), std::memory_order_relaxed);
    return tag;
  }
  return 0;
}

void give_back(std::uint32_t tag) noexcept {
  const std::uint64_t bit = std::uint64_t{1} << tag % kWordBits;
  g_taken[tag / kWordBits].fetch_and(~bit, std::memory_order_release);
}

}  // namespace

PartitionTagPool::PartitionTagPool() noexcept : latest_(take()) {
  if (latest_ != 0) {
    g_earlier[latest_] = 0;
    return;
  }
  is_own_ = false;
  latest_ = 1 + g_next.fetch_add(1, std::memory_order_relaxed) % kMaxTags;
}

PartitionTagPool::~PartitionTagPool() {
  if (!is_own_) return;
  for (std::uint32_t tag = latest_; tag != 0;) {
    const std::uint32_t earlier = g_earlier[tag];
    give_back(tag);
    tag = earlier;
  }
}

bool PartitionTagPool::renew() noexcept {
  const std::uint32_t tag = take();
  if (tag == 0) return false;
  g_earlier[tag] = is_own_ ? latest_ : 0;
  latest_ = tag;
  is_own_ = true;
  return true;
}

bool PartitionTagPool::claim(std::uint32_t tag) noexcept {
  if (!is_own_ || tag == 0 || tag > kMaxTags) return false;
  if (tag == latest_) return true;
  for (std::uint32_t later = latest_; g_earlier[later] != 0; later = g_earlier[later]) {
    if (g_earlier[later] != tag) continue;
    g_earlier[later] = g_earlier[tag];
    g_earlier[tag] = latest_;
    latest_ = tag;
    return true;
  }
  const std::uint64_t bit = std::uint64_t{1} << tag % kWordBits;
  if ((g_taken[tag / kWordBits].fetch_or(bit, std::memory_order_acquire) & bit) != 0) return false;
  g_earlier[tag] = latest_;
  latest_ = tag;
  return true;
}

}  // namespace winnow
