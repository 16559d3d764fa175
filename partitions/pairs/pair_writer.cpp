// Collects the pairs of parallel tasks. The serial path writes into the buffer; the parallel path
// writes pages, which gather_pages copies into the order of tasks. See the class comment in
// pair_writer.h.

#include "partitions/pairs/pair_writer.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kPage = 2048;
constexpr std::size_t kPageContent = kPage - kSinkSlack;

static_assert(sizeof(Pair) == 8 && alignof(Pair) == 4);

std::uint32_t* words(Pair* pair) {
  return reinterpret_cast<std::uint32_t*>(pair);
}

// Points the sink at the pairs [from, end).
void aim(PairSink& sink, Pair* from, Pair* end) {
  sink.cursor = words(from);
  sink.limit = words(end) - 2 * kSinkSlack;
}

// Table entry of a page: the task that filled it and its number of pairs.
constexpr std::uint64_t entry(std::size_t task, std::size_t count) {
  return static_cast<std::uint64_t>(task) << 32U | count;
}
constexpr std::size_t task_of(std::uint64_t e) {
  return static_cast<std::size_t>(e >> 32U);
}
constexpr std::size_t count_of(std::uint64_t e) {
  return static_cast<std::size_t>(e & 0xFFFFFFFFU);
}

}  // namespace

/// State shared by the tasks of a parallel query: pages, their contents, and finished tasks.
struct PairWriter::PageClaims {
  static constexpr std::size_t kNone = ~std::size_t{0};

  Pair* pages = nullptr;
  std::uint64_t* entries = nullptr;
  std::uint64_t* done = nullptr;
  std::size_t limit = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> tests{0};
  std::atomic<bool> full{false};
  // The leading task writes to the buffer's array: all tasks before it are done and wrote there, up
  // to `led`. Only the leading task changes `leading` and `led`. Once a leading task needed a page,
  // no task leads.
  std::atomic<std::size_t> leading{0};
  std::size_t led = 0;
};

Status PairWriter::append(std::size_t tasks, void* context, WriteTask run) {
  return execution_.concurrency() == 1 || tasks <= 1 ? append_serial(tasks, context, run)
                                                     : append_parallel(tasks, context, run);
}

// Returns the number of pages for that many tasks: each task fills all of its pages but one.
std::size_t PairWriter::pages_for(const PairBuffer& out, std::size_t tasks) noexcept {
  const std::size_t pages = out.rows_.capacity() / kPageContent + tasks + 16;
  return std::max(pages, out.pages_.capacity() / kPage);
}

bool PairWriter::reserve(PairBuffer& out, std::size_t pairs, std::size_t tasks,
                         const Execution& execution, Pages pages) noexcept {
  if (!out.rows_.reserve(pairs + 2 * kSinkSlack, pages)) return false;
  if (execution == Execution::serial() || tasks <= 1) return true;
  const std::size_t count = pages_for(out, tasks);
  return out.pages_.reserve(count * kPage, pages) &&
         out.page_table_.reserve(count + tasks + 1, pages);
}

/// Output of the tasks on one thread, one after the other: the buffer's array, or storage beside it
/// until the number of the first pairs is known.
struct PairWriter::SerialOutput {
  const PairWriter& writer;
  Column<Pair>& pairs;
  const std::size_t before;  // pairs in the buffer at the start
  const std::size_t tasks;
  Pair* begin;              // pairs[before], or the storage beside the array
  std::size_t task = 0;     // running task
  std::size_t checked = 0;  // pairs from `begin` on that passed the predicate

  // Capacity to grow to. Growing copies all pairs into fresh pages, which costs more than finding
  // them, so the total is extrapolated from the tasks that are done.
  [[nodiscard]] std::size_t room() const {
    constexpr std::size_t kEnoughTasks = 3;
    const std::size_t least =
        std::max(pairs.capacity() + pairs.capacity() / 2, before + checked + 2 * kSinkSlack);
    if (task < kEnoughTasks) return least;
    const std::size_t expected = checked * tasks / task;
    return std::clamp(before + expected + expected / 16 + 2 * kSinkSlack, least,
                      std::max(least, 4 * pairs.capacity()));
  }

  // Takes over the pairs that the sink received; false if memory is refused.
  [[nodiscard]] bool take(const PairSink& sink) {
    checked += writer.keep_accepted(begin, checked, sink);
    if (!pairs.grow(before + checked)) return false;
    Pair* const array = pairs.data() + before;
    if (begin != array) std::copy_n(std::exchange(begin, array), checked, array);
    pairs.set_size(before + checked);
    return true;
  }
};

// Drops the pairs behind the first `checked` that the predicate does not accept; returns how many
// of them it keeps.
std::size_t PairWriter::keep_accepted(Pair* begin, std::size_t checked,
                                      const PairSink& sink) const noexcept {
  const std::size_t count = static_cast<std::size_t>(sink.cursor - words(begin)) / 2 - checked;
  if (predicate_.accept == nullptr) return count;
  Pair* const pairs = begin + checked;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair pair = pairs[i];
    if (predicate_.accept(predicate_.context, pair.first, pair.second)) pairs[kept++] = pair;
  }
  return kept;
}

Status PairWriter::append_serial(std::size_t tasks, void* context, WriteTask run) {
  Column<Pair>& pairs = out_.rows_;
  const std::size_t before = pairs.size();
  // The slack that kernels need (kSinkSlack) is many times the number of pairs of a small scene.
  // The first pairs are therefore written beside the array, which then grows to the actual number.
  constexpr std::size_t kBeside = 2 * kSinkSlack;
  alignas(Pair) std::byte bytes[kBeside * sizeof(Pair)];  // uninitialized, unlike Pair[]
  auto* const beside = reinterpret_cast<Pair*>(bytes);
  const bool is_tight = before + kBeside > pairs.capacity();
  SerialOutput output{*this, pairs, before, tasks, is_tight ? beside : pairs.data() + before};
  PairSink sink;
  aim(sink, output.begin, is_tight ? beside + kBeside : pairs.data() + pairs.capacity());
  sink.owner = &output;
  sink.grow = [](PairSink& full) {
    auto& o = *static_cast<SerialOutput*>(full.owner);
    if (!o.take(full)) return false;
    Column<Pair>& column = o.pairs;
    const std::size_t used = column.size();
    // The predicate may have freed enough room.
    const bool enough = used + 2 * kSinkSlack <= column.capacity();
    if (!enough && !column.reserve(o.room()) && !column.reserve(used + 2 * kSinkSlack)) {
      return false;
    }
    o.begin = column.data() + o.before;
    aim(full, column.data() + used, column.data() + column.capacity());
    return true;
  };
  bool done = true;
  for (; done && output.task < tasks; ++output.task) done = run(context, output.task, sink);
  if (!done || !output.take(sink)) {
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  tests_ += sink.tests;
  return Status::ok;
}

Status PairWriter::append_parallel(std::size_t tasks, void* context, WriteTask run) {
  PageClaims claims;
  claims.led = out_.rows_.size();
  // Initial guess: the pages for as many pairs as the buffer has room for.
  std::size_t pages = pages_for(out_, tasks);
  while (make_pages(claims, pages, tasks)) {
    run_on_pages(tasks, claims, context, run);
    if (!claims.full.load()) {
      tests_ += claims.tests.load();
      return gather_pages(tasks, claims);
    }
    pages = more_pages(claims, tasks);
  }
  return Status::out_of_memory;
}

// Allocates pages; pages that are already written are moved.
bool PairWriter::make_pages(PageClaims& claims, std::size_t pages, std::size_t tasks) {
  Column<Pair>& content = out_.pages_;
  Column<std::uint64_t>& table = out_.page_table_;
  const bool first = claims.limit == 0;
  content.set_size(claims.limit * kPage);
  table.set_size(first ? 0 : tasks + 1 + claims.limit);
  const bool made = content.reserve(pages * kPage) && table.reserve(tasks + 1 + pages);
  content.clear();
  table.clear();
  if (!made) return false;
  claims.pages = content.data();
  claims.done = table.data();
  claims.entries = table.data() + tasks + 1;
  claims.limit = pages;
  claims.full.store(false);
  if (first) std::fill_n(claims.done, tasks, 0U);
  return true;
}

// Returns the number of pages to continue with, extrapolated from the tasks that are done. Discards
// the output of unfinished tasks.
std::size_t PairWriter::more_pages(PageClaims& claims, std::size_t tasks) {
  claims.next.store(claims.limit);
  std::size_t done = 1;
  for (std::size_t task = 0; task < tasks; ++task) done += claims.done[task];
  for (std::uint64_t& e : std::span(claims.entries, claims.limit)) {
    if (claims.done[task_of(e)] == 0) e = entry(task_of(e), 0);
  }
  return std::clamp(claims.limit * tasks / done, 2 * claims.limit, 4 * claims.limit);
}

/// Output of one task: the buffer's array while it leads and the array has room, then pages.
struct PairWriter::TaskOutput {
  const PairWriter& writer;
  PageClaims& claims;
  const std::size_t task;
  Pair* begin = nullptr;  // current destination, or null
  Pair* end = nullptr;
  std::size_t checked = 0;               // pairs from `begin` on that passed the predicate
  std::size_t page = PageClaims::kNone;  // the last claimed one
  std::size_t in_array = 0;              // pairs written to the array

  bool write(void* context, WriteTask run) {
    const bool leads = claims.leading.load(std::memory_order_acquire) == task;
    std::uint32_t none = 0;
    PairSink sink;
    sink.owner = this;
    sink.grow = [](PairSink& full) {
      return static_cast<TaskOutput*>(full.owner)->next_destination(full);
    };
    if (leads) {
      begin = writer.out_.rows_.data() + claims.led;
      end = writer.out_.rows_.data() + writer.out_.rows_.capacity();
    }
    if (has_room()) {
      aim(sink, begin, end);
    } else {
      // Start without a page, so that a task without pairs takes none.
      begin = nullptr;
      sink.cursor = &none + 1;
      sink.limit = &none;
    }
    const bool done = run(context, task, sink);
    take(sink);
    claims.tests.fetch_add(done ? sink.tests : 0, std::memory_order_relaxed);
    if (done && leads) {
      claims.led += in_array;
      claims.leading.store(page == PageClaims::kNone ? task + 1 : PageClaims::kNone,
                           std::memory_order_release);
    }
    return done;
  }

  [[nodiscard]] bool has_room() const {
    return end - begin >= static_cast<std::ptrdiff_t>(checked + kSinkSlack);
  }

  void take(const PairSink& sink) {
    if (begin == nullptr) return;
    checked += writer.keep_accepted(begin, checked, sink);
    if (page == PageClaims::kNone) {
      in_array = checked;
    } else {
      claims.entries[page] = entry(task, checked);
    }
  }

  bool next_destination(PairSink& sink) {
    take(sink);
    // Reuse the room of rejected pairs, so that the number of pages depends on accepted pairs.
    if (begin == nullptr || !has_room()) {
      begin = nullptr;
      page = claims.next.fetch_add(1, std::memory_order_relaxed);
      if (page >= claims.limit) return false;
      begin = claims.pages + page * kPage;
      end = begin + kPage;
      checked = 0;
    }
    aim(sink, begin + checked, end);
    return true;
  }
};

void PairWriter::run_on_pages(std::size_t tasks, PageClaims& claims, void* context, WriteTask run) {
  execution_.for_each(tasks, [&](std::size_t task) {
    if (claims.done[task] != 0 || claims.full.load(std::memory_order_relaxed)) return;
    TaskOutput output{*this, claims, task};
    if (output.write(context, run)) {
      claims.done[task] = 1;
    } else {
      claims.full.store(true, std::memory_order_relaxed);
    }
  });
}

// Copies the pages behind the pairs in the array.
Status PairWriter::gather_pages(std::size_t tasks, PageClaims& claims) {
  // Counting sort of pages by task; a task claimed its pages in ascending order.
  const std::size_t pages = claims.next.load();
  std::uint64_t* const offset = claims.done;
  std::fill_n(offset, tasks + 1, 0U);
  for (std::size_t p = 0; p < pages; ++p) {
    offset[task_of(claims.entries[p]) + 1] += count_of(claims.entries[p]);
  }
  for (std::size_t t = 0; t < tasks; ++t) offset[t + 1] += offset[t];
  Column<Pair>& pairs = out_.rows_;
  const std::size_t before = pairs.size();
  pairs.set_size(claims.led);
  // All pages may be empty, and then the array may be unallocated.
  if (offset[tasks] == 0) return Status::ok;
  const auto all = static_cast<std::size_t>(claims.led + offset[tasks]);
  if (!pairs.grow(all)) {
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  pairs.set_size(all);
  // From here on an entry contains the destination of its page instead of the task.
  for (std::size_t p = 0; p < pages; ++p) {
    const std::uint64_t e = claims.entries[p];
    const std::uint64_t to = offset[task_of(e)];
    offset[task_of(e)] += count_of(e);
    claims.entries[p] = to << 12U | count_of(e);
  }
  static_assert(kPage < (1U << 12U));
  constexpr std::size_t kPagesPerTask = 16;
  execution_.for_each((pages + kPagesPerTask - 1) / kPagesPerTask, [&](std::size_t task) {
    for (std::size_t p = task * kPagesPerTask; p < std::min(pages, (task + 1) * kPagesPerTask);
         ++p) {
      const std::uint64_t e = claims.entries[p];
      std::memcpy(static_cast<void*>(pairs.data() + claims.led + (e >> 12U)),
                  claims.pages + p * kPage, (e & 0xFFFU) * sizeof(Pair));
    }
  });
  return Status::ok;
}

}  // namespace winnow
