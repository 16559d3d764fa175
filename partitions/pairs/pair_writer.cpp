#include "partitions/pairs/pair_writer.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

namespace winnow {
namespace {

constexpr std::size_t kPage = 2048;
constexpr std::size_t kPageContent = kPage - kSinkSlack;

static_assert(sizeof(Pair) == 8 && alignof(Pair) == 4);

std::uint32_t* words(Pair* pair) {
  return reinterpret_cast<std::uint32_t*>(pair);
}

// Points the sink at [from, end) of pairs.
void aim(PairSink& sink, Pair* from, Pair* end) {
  sink.cursor = words(from);
  sink.limit = words(end) - 2 * kSinkSlack;
}

// A page's table entry: the task that filled it and how much it holds.
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

/// The pages, of which tasks take the next one; what is in each, and which tasks are done.
struct PairWriter::PageClaims {
  static constexpr std::size_t kNone = ~std::size_t{0};

  Pair* pages = nullptr;
  std::uint64_t* entries = nullptr;
  std::uint64_t* done = nullptr;
  std::size_t limit = 0;
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> tests{0};
  std::atomic<bool> full{false};
  // The task before which all have written to the buffer's array, up to `led`. It alone changes
  // the two; none leads any more once one has needed a page.
  std::atomic<std::size_t> leading{0};
  std::size_t led = 0;
};

Status PairWriter::append(std::size_t tasks, void* context, Task run) {
  return execution_.concurrency() == 1 || tasks <= 1 ? append_serial(tasks, context, run)
                                                     : append_parallel(tasks, context, run);
}

// Pages for the pairs of so many tasks: all but one of a task's are full.
std::size_t PairWriter::pages_for(const PairBuffer& out, std::size_t tasks) noexcept {
  const std::size_t pages = out.pairs_.capacity() / kPageContent + tasks + 16;
  return std::max(pages, out.pages_.capacity() / kPage);
}

bool PairWriter::reserve(PairBuffer& out, std::size_t pairs, std::size_t tasks,
                         const Execution& execution, Pages pages) noexcept {
  if (!out.pairs_.reserve(pairs + 2 * kSinkSlack, pages)) return false;
  if (execution == Execution::serial() || tasks <= 1) return true;
  const std::size_t count = pages_for(out, tasks);
  return out.pages_.reserve(count * kPage, pages) &&
         out.page_table_.reserve(count + tasks + 1, pages);
}

struct PairWriter::SerialOutput {
  const PairWriter& writer;
  Column<Pair>& pairs;
  const std::size_t before;  // pairs that were there
  const std::size_t tasks;
  Pair* few;                     // where the first ones are found, if not in the array
  std::size_t task = 0;          // that is running
  std::size_t checked = before;  // pairs that the predicate has been asked about

  // Pairs to have room for: every growth writes all to fresh pages, which costs more than to find
  // them. Tasks are about alike, so that some of them tell of the rest.
  [[nodiscard]] std::size_t room() const {
    constexpr std::size_t kEnoughTasks = 3;
    const std::size_t least =
        std::max(pairs.capacity() + pairs.capacity() / 2, checked + 2 * kSinkSlack);
    if (task < kEnoughTasks) return least;
    const std::size_t found = checked - before;
    const std::size_t expected = found * tasks / task;
    return std::clamp(before + expected + expected / 16 + 2 * kSinkSlack, least,
                      std::max(least, 4 * pairs.capacity()));
  }

  // Takes in what the sink got since; false if memory is refused.
  [[nodiscard]] bool take(const PairSink& sink) {
    if (few != nullptr) return take_few(sink);
    const auto used = static_cast<std::size_t>(sink.cursor - words(pairs.data())) / 2;
    checked += writer.keep_accepted(pairs.data() + checked, used - checked);
    pairs.set_size(checked);
    return true;
  }
  [[nodiscard]] bool take_few(const PairSink& sink) {
    const auto found = static_cast<std::size_t>(sink.cursor - words(few)) / 2;
    const std::size_t kept = writer.keep_accepted(few, found);
    if (!pairs.grow(checked + kept)) return false;
    std::copy_n(few, kept, pairs.data() + checked);
    few = nullptr;
    checked += kept;
    pairs.set_size(checked);
    return true;
  }
};

std::size_t PairWriter::keep_accepted(Pair* pairs, std::size_t count) const noexcept {
  if (predicate_.accept == nullptr) return count;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair pair = pairs[i];
    if (predicate_.accept(predicate_.context, pair.first, pair.second)) pairs[kept++] = pair;
  }
  return kept;
}

Status PairWriter::append_serial(std::size_t tasks, void* context, Task run) {
  Column<Pair>& pairs = out_.pairs_;
  const std::size_t before = pairs.size();
  // The slack of the kernels is many times what a small world has of pairs: the first are found
  // beside the array, which then has room for what there is.
  constexpr std::size_t kBeside = 2 * kSinkSlack;
  alignas(Pair) std::byte bytes[kBeside * sizeof(Pair)];  // no pairs yet, which would be written
  auto* const room = reinterpret_cast<Pair*>(bytes);
  const bool is_tight = before + kBeside > pairs.capacity();
  SerialOutput output{*this, pairs, before, tasks, is_tight ? room : nullptr};
  PairSink sink;
  if (is_tight) {
    aim(sink, room, room + kBeside);
  } else {
    aim(sink, pairs.data() + before, pairs.data() + pairs.capacity());
  }
  sink.owner = &output;
  sink.grow = [](PairSink& full) {
    auto& o = *static_cast<SerialOutput*>(full.owner);
    if (!o.take(full)) return false;
    Column<Pair>& column = o.pairs;
    const std::size_t used = column.size();
    // The predicate may have left some free.
    const bool enough = used + 2 * kSinkSlack <= column.capacity();
    if (!enough && !column.reserve(o.room()) && !column.reserve(used + 2 * kSinkSlack)) {
      return false;
    }
    aim(full, column.data() + used, column.data() + column.capacity());
    return true;
  };
  for (; output.task < tasks; ++output.task) {
    if (run(context, output.task, sink)) continue;
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  if (!output.take(sink)) {
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  tests_ += sink.tests;
  return Status::ok;
}

Status PairWriter::append_parallel(std::size_t tasks, void* context, Task run) {
  PageClaims claims;
  claims.led = out_.pairs_.size();
  // A guess from what the buffer held last.
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

// Makes room for so many pages; those that have been written move along.
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

// Pages to go on with where there were too few: tasks are about alike, so that those which are done
// tell of the rest. What the others have written counts for nothing.
std::size_t PairWriter::more_pages(PageClaims& claims, std::size_t tasks) {
  claims.next.store(claims.limit);
  std::size_t done = 1;
  for (std::size_t task = 0; task < tasks; ++task) done += claims.done[task];
  for (std::uint64_t& e : std::span(claims.entries, claims.limit)) {
    if (claims.done[task_of(e)] == 0) e = entry(task_of(e), 0);
  }
  return std::clamp(claims.limit * tasks / done, 2 * claims.limit, 4 * claims.limit);
}

/// What a task writes to: the buffer's array while it leads and that has room, then pages.
struct PairWriter::TaskOutput {
  const PairWriter& writer;
  PageClaims& claims;
  const std::size_t task;
  Pair* begin = nullptr;  // what it writes to now, if anything
  Pair* end = nullptr;
  std::size_t checked = 0;  // pairs from there that the predicate has been asked about
  std::size_t page = PageClaims::kNone;
  std::size_t in_array = 0;  // pairs that it has written there

  bool write(void* context, Task run) {
    const bool leads = claims.leading.load(std::memory_order_acquire) == task;
    std::uint32_t none = 0;
    PairSink sink;
    sink.owner = this;
    sink.grow = [](PairSink& full) { return static_cast<TaskOutput*>(full.owner)->go_on(full); };
    if (leads) {
      begin = writer.out_.pairs_.data() + claims.led;
      end = writer.out_.pairs_.data() + writer.out_.pairs_.capacity();
    }
    if (has_room()) {
      aim(sink, begin, end);
    } else {
      // Starts with nothing: a task that finds no pair takes no page.
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
    const auto used = static_cast<std::size_t>(sink.cursor - words(begin)) / 2;
    checked += writer.keep_accepted(begin + checked, used - checked);
    if (page == PageClaims::kNone) {
      in_array = checked;
    } else {
      claims.entries[page] = entry(task, checked);
    }
  }

  bool go_on(PairSink& sink) {
    take(sink);
    // What the predicate leaves free is written on, so that pages follow what it accepts.
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

void PairWriter::run_on_pages(std::size_t tasks, PageClaims& claims, void* context, Task run) {
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

// Puts what stands on pages behind what stands in the array.
Status PairWriter::gather_pages(std::size_t tasks, PageClaims& claims) {
  // Counting sort of pages by task; within a task pages were claimed in ascending order.
  const std::size_t pages = claims.next.load();
  std::uint64_t* const offset = claims.done;
  std::fill_n(offset, tasks + 1, 0U);
  for (std::size_t p = 0; p < pages; ++p) {
    offset[task_of(claims.entries[p]) + 1] += count_of(claims.entries[p]);
  }
  for (std::size_t t = 0; t < tasks; ++t) offset[t + 1] += offset[t];
  Column<Pair>& pairs = out_.pairs_;
  const std::size_t before = pairs.size();
  pairs.set_size(claims.led);
  // Pages may have been taken for nothing, and the array may be none yet.
  if (offset[tasks] == 0) return Status::ok;
  const auto all = static_cast<std::size_t>(claims.led + offset[tasks]);
  if (!pairs.grow(all)) {
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  pairs.set_size(all);
  // From here the entry holds where its page goes instead of whose it is.
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
