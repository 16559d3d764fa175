#include "partitions/pairs/pair_writer.h"

#include <algorithm>
#include <cstring>

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

struct PairWriter::PageClaims {
  Pair* pages;
  std::uint64_t* table;
  std::size_t limit;
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> tests{0};
  std::atomic<bool> full{false};
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
  std::size_t checked;  // pairs that the predicate has been asked about

  // Takes in what the sink got since.
  void take(const PairSink& sink) {
    const auto used = static_cast<std::size_t>(sink.cursor - words(pairs.data())) / 2;
    checked += writer.keep_accepted(pairs.data() + checked, used - checked);
    pairs.set_size(checked);
  }
};

std::size_t PairWriter::keep_accepted(Pair* pairs, std::size_t count) const {
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
  if (!pairs.grow(before + 2 * kSinkSlack)) return Status::out_of_memory;
  SerialOutput output{*this, pairs, before};
  PairSink sink;
  aim(sink, pairs.data() + before, pairs.data() + pairs.capacity());
  sink.owner = &output;
  sink.grow = [](PairSink& full) {
    auto& o = *static_cast<SerialOutput*>(full.owner);
    o.take(full);
    Column<Pair>& column = o.pairs;
    const std::size_t used = column.size();
    // A quarter that the predicate left free is room enough.
    const bool enough = used + 2 * kSinkSlack + column.capacity() / 4 < column.capacity();
    if (!enough && !column.grow(std::max(used + 2 * kSinkSlack, column.capacity() + 1))) {
      return false;
    }
    aim(full, column.data() + used, column.data() + column.capacity());
    return true;
  };
  for (std::size_t task = 0; task < tasks; ++task) {
    if (run(context, task, sink)) continue;
    pairs.set_size(before);
    return Status::out_of_memory;
  }
  output.take(sink);
  tests_ += sink.tests;
  return Status::ok;
}

Status PairWriter::append_parallel(std::size_t tasks, void* context, Task run) {
  // A guess from what the buffer held last; too small a guess is found out and doubled.
  std::size_t pages = pages_for(out_, tasks);
  for (;;) {
    if (!out_.pages_.reserve(pages * kPage) || !out_.page_table_.reserve(pages + tasks + 1)) {
      return Status::out_of_memory;
    }
    if (run_on_pages(tasks, pages, context, run)) return gather_pages(tasks, claimed_);
    pages *= 2;
  }
}

bool PairWriter::run_on_pages(std::size_t tasks, std::size_t pages, void* context, Task run) {
  PageClaims claims{out_.pages_.data(), out_.page_table_.data(), pages};
  execution_.for_each(tasks, [&](std::size_t task) {
    struct Writer {
      const PairWriter& writer;
      PageClaims& claims;
      std::size_t task;
      std::size_t page = 0;
      bool open = false;

      void close(const PairSink& sink) const {
        if (!open) return;
        Pair* const start = claims.pages + page * kPage;
        const auto used = static_cast<std::size_t>(sink.cursor - words(start)) / 2;
        claims.table[page] = entry(task, writer.keep_accepted(start, used));
      }
    } writer{*this, claims, task};
    if (claims.full.load(std::memory_order_relaxed)) return;
    PairSink sink;
    // Starts without a page: a task that finds nothing takes none.
    std::uint32_t none = 0;
    sink.cursor = &none + 1;
    sink.limit = &none;
    sink.owner = &writer;
    sink.grow = [](PairSink& full) {
      auto& w = *static_cast<Writer*>(full.owner);
      w.close(full);
      w.open = false;
      const std::size_t page = w.claims.next.fetch_add(1, std::memory_order_relaxed);
      if (page >= w.claims.limit) return false;
      w.page = page;
      w.open = true;
      Pair* start = w.claims.pages + page * kPage;
      aim(full, start, start + kPage);
      return true;
    };
    if (!run(context, task, sink)) claims.full.store(true, std::memory_order_relaxed);
    writer.close(sink);
    claims.tests.fetch_add(sink.tests, std::memory_order_relaxed);
  });
  if (claims.full.load()) return false;
  claimed_ = claims.next.load();
  tests_ += claims.tests.load();
  return true;
}

Status PairWriter::gather_pages(std::size_t tasks, std::size_t pages) {
  // Counting sort of pages by task; within a task pages were claimed in ascending order.
  std::uint64_t* offset = out_.page_table_.data() + pages;
  std::fill(offset, offset + tasks + 1, 0);
  for (std::size_t p = 0; p < pages; ++p) {
    offset[task_of(out_.page_table_[p]) + 1] += count_of(out_.page_table_[p]);
  }
  for (std::size_t t = 0; t < tasks; ++t) offset[t + 1] += offset[t];
  Column<Pair>& pairs = out_.pairs_;
  const std::size_t before = pairs.size();
  if (!pairs.grow(before + offset[tasks])) return Status::out_of_memory;
  pairs.set_size(before + offset[tasks]);
  // From here the entry holds where its page goes instead of whose it is.
  for (std::size_t p = 0; p < pages; ++p) {
    const std::uint64_t e = out_.page_table_[p];
    const std::uint64_t to = offset[task_of(e)];
    offset[task_of(e)] += count_of(e);
    out_.page_table_[p] = to << 12U | count_of(e);
  }
  static_assert(kPage < (1U << 12U));
  constexpr std::size_t kPagesPerTask = 16;
  execution_.for_each((pages + kPagesPerTask - 1) / kPagesPerTask, [&](std::size_t task) {
    for (std::size_t p = task * kPagesPerTask; p < std::min(pages, (task + 1) * kPagesPerTask);
         ++p) {
      const std::uint64_t e = out_.page_table_[p];
      std::memcpy(static_cast<void*>(pairs.data() + before + (e >> 12U)),
                  out_.pages_.data() + p * kPage, (e & 0xFFFU) * sizeof(Pair));
    }
  });
  return Status::ok;
}

}  // namespace winnow
