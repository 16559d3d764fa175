// LargePages, a best-fit allocator of large blocks on slabs of 2 MB pages, and `default_memory`.
// Slabs and free ranges are sorted arrays under one mutex.

#include <winnow/core/memory.h>

#include "core/memory/catch_bad_alloc.h"
#include "core/memory/new_in.h"
#include "core/memory/prefault_each_page.h"
#include "core/threads/mutex.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <new>
#include <string_view>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace winnow {
namespace {

constexpr std::size_t kLine = Column<std::byte>::kAlignment;
constexpr std::size_t kMaxAhead = std::size_t{32} << 20U;  // most that is mapped ahead of demand
constexpr std::size_t kKept = std::size_t{8} << 20U;       // free bytes that are always kept

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(memory_sanitizer);
#else
constexpr bool kSanitized = false;
#endif

// Returns true if the system gives large pages to programs that request them by madvise.
bool has_large_pages() noexcept {
  std::FILE* const file = std::fopen("/sys/kernel/mm/transparent_hugepage/enabled", "r");
  if (file == nullptr) return false;
  char text[64];
  const std::size_t length = std::fread(text, 1, sizeof text, file);
  (void)std::fclose(file);
  return length != 0 && std::string_view(text, length).find("[never]") == std::string_view::npos;
}

bool large_pages_enabled() noexcept {
  const char* const wish = std::getenv("WINNOW_LARGE_PAGES");
  const bool refused = wish != nullptr && std::string_view(wish) == "0";
  return !kSanitized && !refused && has_large_pages();
}

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) noexcept {
  return (bytes + unit - 1) / unit * unit;
}

struct MemoryRange {
  std::byte* begin;
  std::size_t bytes;

  [[nodiscard]] std::byte* end() const noexcept { return begin + bytes; }
};

/// Returns the bytes from `at` to the next address of this alignment.
std::size_t bytes_to_aligned(const std::byte* at, std::size_t alignment) noexcept {
  const auto address = reinterpret_cast<std::uintptr_t>(at);
  return static_cast<std::size_t>(rounded_up(address, alignment) - address);
}

#ifdef __linux__

constexpr bool kHasSlabs = true;

/// Maps whole large pages; returns null if the system refuses.
std::byte* map_pages(std::size_t bytes) noexcept {
  constexpr std::size_t kPage = LargePages::kPage;
  void* const mapped =
      ::mmap(nullptr, bytes + kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return nullptr;
  // mmap aligns to small pages: the bytes before and behind the large pages are unmapped.
  auto* const from = static_cast<std::byte*>(mapped);
  const std::size_t before = bytes_to_aligned(from, kPage);
  std::byte* const begin = from + before;
  if (before != 0) (void)::munmap(from, before);
  if (before != kPage) (void)::munmap(begin + bytes, kPage - before);
#ifdef MADV_HUGEPAGE
  // Without large pages the range keeps its small pages.
  (void)::madvise(begin, bytes, MADV_HUGEPAGE);
#endif
  return begin;
}

void unmap_pages(const MemoryRange& range) noexcept {
  (void)::munmap(range.begin, range.bytes);
}

#else

constexpr bool kHasSlabs = false;

std::byte* map_pages(std::size_t) noexcept {
  return nullptr;
}
void unmap_pages(const MemoryRange&) noexcept {}

#endif

/// Returns the first range that begins behind an address; the list is in ascending order.
MemoryRange* first_behind(Column<MemoryRange>& list, const std::byte* address) noexcept {
  return std::upper_bound(
      list.begin(), list.end(), address,
      [](const std::byte* at, const MemoryRange& r) { return std::less<>()(at, r.begin); });
}

}  // namespace

/// The slabs and the free ranges in them. Both lists ascend by address. No two free ranges of a
/// slab touch each other.
class LargePages::Slabs {
 public:
  explicit Slabs(std::pmr::memory_resource* memory) noexcept : slabs_(memory), free_(memory) {}
  ~Slabs() { std::for_each(slabs_.begin(), slabs_.end(), unmap_pages); }
  Slabs(const Slabs&) = delete;
  Slabs& operator=(const Slabs&) = delete;

  /// Returns null if memory is refused.
  [[nodiscard]] void* take(std::size_t bytes, std::size_t alignment) noexcept;
  void give_back(void* block, std::size_t bytes) noexcept;

  [[nodiscard]] std::size_t held_bytes() noexcept {
    const Lock lock(mutex_);
    return held_;
  }
  [[nodiscard]] std::size_t used_bytes() noexcept {
    const Lock lock(mutex_);
    return used_;
  }

 private:
  [[nodiscard]] bool reserve_ranges() noexcept;
  [[nodiscard]] MemoryRange* best_fit(std::size_t bytes, std::size_t alignment) noexcept;
  [[nodiscard]] MemoryRange* add_slab(std::size_t bytes) noexcept;
  void cut(MemoryRange* from, std::size_t gap, std::size_t bytes) noexcept;
  [[nodiscard]] MemoryRange* insert(Column<MemoryRange>& list, const MemoryRange& range) noexcept;
  static void erase(Column<MemoryRange>& list, const MemoryRange* range) noexcept;
  [[nodiscard]] MemoryRange* slab_of(const std::byte* at) noexcept;
  void return_empty_slabs() noexcept;

  Mutex mutex_;
  Column<MemoryRange> slabs_;
  Column<MemoryRange> free_;
  std::size_t blocks_ = 0;
  std::size_t held_ = 0;
  std::size_t used_ = 0;
};

void* LargePages::Slabs::take(std::size_t bytes, std::size_t alignment) noexcept {
  const Lock lock(mutex_);
  if (!reserve_ranges()) return nullptr;
  const std::size_t needed = rounded_up(bytes, kLine);
  MemoryRange* range = best_fit(needed, alignment);
  if (range == nullptr) range = add_slab(needed);
  if (range == nullptr) return nullptr;
  const std::size_t gap = bytes_to_aligned(range->begin, alignment);
  std::byte* const block = range->begin + gap;
  cut(range, gap, needed);
  ++blocks_;
  used_ += needed;
  return block;
}

// Deallocation must not fail, so its list entries are reserved here: there may be a free range
// behind every block and at the beginning of every slab.
bool LargePages::Slabs::reserve_ranges() noexcept {
  return slabs_.grow(slabs_.size() + 1) && free_.grow(blocks_ + slabs_.size() + 3);
}

// Returns the shortest free range with enough room; null if there is none.
MemoryRange* LargePages::Slabs::best_fit(std::size_t bytes, std::size_t alignment) noexcept {
  MemoryRange* best = nullptr;
  for (MemoryRange& range : free_) {
    if (range.bytes < bytes || (best != nullptr && best->bytes <= range.bytes)) continue;
    if (range.bytes - bytes >= bytes_to_aligned(range.begin, alignment)) best = &range;
  }
  return best;
}

// Maps a slab for a block, or for half of the bytes of all slabs, at most 32 MB, if that is more,
// and returns its free range. Returns null if the system refuses.
MemoryRange* LargePages::Slabs::add_slab(std::size_t bytes) noexcept {
  const std::size_t ahead = std::min(held_ / 2, kMaxAhead);
  const std::size_t pages = rounded_up(std::max(bytes, ahead), kPage);
  const MemoryRange slab{map_pages(pages), pages};
  if (slab.begin == nullptr) return nullptr;
  held_ += pages;
  (void)insert(slabs_, slab);
  return insert(free_, slab);
}

// Removes [gap, gap + bytes) from a free range.
void LargePages::Slabs::cut(MemoryRange* from, std::size_t gap, std::size_t bytes) noexcept {
  const MemoryRange behind{from->begin + gap + bytes, from->bytes - gap - bytes};
  from->bytes = gap;
  if (gap == 0 && behind.bytes == 0) return erase(free_, from);
  if (gap == 0) {
    *from = behind;
  } else if (behind.bytes != 0) {
    (void)insert(free_, behind);
  }
}

void LargePages::Slabs::give_back(void* block, std::size_t bytes) noexcept {
  const Lock lock(mutex_);
  const std::size_t taken = rounded_up(bytes, kLine);
  --blocks_;
  used_ -= taken;
  const MemoryRange* const slab = slab_of(static_cast<std::byte*>(block));
  MemoryRange* range = insert(free_, {static_cast<std::byte*>(block), taken});
  MemoryRange* const next = range + 1;
  if (next != free_.end() && next->begin == range->end() && next->begin < slab->end()) {
    range->bytes += next->bytes;
    erase(free_, next);
  }
  if (range != free_.begin() && range[-1].end() == range->begin && range->begin > slab->begin) {
    range[-1].bytes += range->bytes;
    erase(free_, range--);
  }
  if (range->bytes == slab->bytes) return_empty_slabs();
}

void LargePages::Slabs::return_empty_slabs() noexcept {
  for (std::size_t i = free_.size(); i-- > 0 && held_ - used_ > std::max(used_, kKept);) {
    const MemoryRange range = free_[i];
    const MemoryRange* const slab = slab_of(range.begin);
    if (range.bytes != slab->bytes) continue;
    erase(free_, free_.begin() + i);
    erase(slabs_, slab);
    held_ -= range.bytes;
    unmap_pages(range);
  }
}

// The list must have room; see `reserve_ranges`.
MemoryRange* LargePages::Slabs::insert(Column<MemoryRange>& list,
                                       const MemoryRange& range) noexcept {
  MemoryRange* const at = first_behind(list, range.begin);
  list.set_size(list.size() + 1);
  std::move_backward(at, list.end() - 1, list.end());
  *at = range;
  return at;
}

void LargePages::Slabs::erase(Column<MemoryRange>& list, const MemoryRange* range) noexcept {
  MemoryRange* const at = list.begin() + (range - list.begin());
  std::move(at + 1, list.end(), at);
  list.set_size(list.size() - 1);
}

MemoryRange* LargePages::Slabs::slab_of(const std::byte* at) noexcept {
  return first_behind(slabs_, at) - 1;
}

LargePages::LargePages(std::pmr::memory_resource* small_blocks) noexcept
    : small_blocks_(small_blocks),
      slabs_(kHasSlabs ? new_in<Slabs>(small_blocks, small_blocks) : nullptr) {}

LargePages::~LargePages() {
  delete_in(small_blocks_, slabs_);
}

std::size_t LargePages::held_bytes() const noexcept {
  return slabs_ == nullptr ? 0 : slabs_->held_bytes();
}

std::size_t LargePages::used_bytes() const noexcept {
  return slabs_ == nullptr ? 0 : slabs_->used_bytes();
}

namespace {

/// True if slabs, if there are any, have room for such a block.
[[nodiscard]] bool is_large(std::size_t bytes, std::size_t alignment) noexcept {
  return bytes >= LargePages::kLargeBlock && alignment <= LargePages::kPage;
}

}  // namespace

void* LargePages::do_allocate(std::size_t bytes, std::size_t alignment) {
  if (slabs_ == nullptr || !is_large(bytes, alignment))
    return small_blocks_->allocate(bytes, alignment);
  // No system has that much memory, and rounding the size up could overflow.
  void* const block = bytes > ~std::size_t{0} / 2 ? nullptr : slabs_->take(bytes, alignment);
  if (block == nullptr) throw_bad_alloc();
  // Prefaults on this thread, because threads that write first to a page at the same time block
  // each other.
  prefault_each_page(block, bytes, kPage);
  return block;
}

void LargePages::do_deallocate(void* block, std::size_t bytes, std::size_t alignment) {
  if (slabs_ == nullptr || !is_large(bytes, alignment))
    return small_blocks_->deallocate(block, bytes, alignment);
  slabs_->give_back(block, bytes);
}

std::pmr::memory_resource* default_memory() noexcept {
  static const bool enabled = large_pages_enabled();
  std::pmr::memory_resource* const set = std::pmr::get_default_resource();
  if (!enabled || !set->is_equal(*std::pmr::new_delete_resource())) return set;
  // Never destroyed: objects with static lifetime may free memory at the end of the process.
  alignas(LargePages) static std::byte room[sizeof(LargePages)];
  static LargePages* const pages = ::new (static_cast<void*>(room)) LargePages();
  return pages;
}

}  // namespace winnow
