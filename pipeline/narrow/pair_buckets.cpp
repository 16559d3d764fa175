// Counting sort of pairs by the kinds of their shapes: tasks check and count ranges of the pairs,
// then write them to their places. A call with one pair, or with shapes of one kind only, skips the
// parts that it does not need.

#include "pipeline/narrow/pair_buckets.h"

#include "core/sort/parallel_ranges.h"
#include "pipeline/narrow/validate_options.h"

#include <atomic>
#include <numeric>
#include <utility>

namespace winnow {
namespace {

constexpr std::uint32_t kTopBit = 1U << 31U;
constexpr std::uint8_t kMirrored = 0x80;

/// Pair code by two kinds, with kMirrored set if the arguments are swapped.
struct KindCodes {
  static constexpr std::uint32_t kKinds = ShapeId{}.kind_index() + 1;
  std::uint8_t of[kKinds][kKinds] = {};

  constexpr KindCodes() {
    for (std::uint32_t a = 0; a < kShapeKinds; ++a) {
      for (std::uint32_t b = 0; b < kShapeKinds; ++b) {
        const std::uint32_t code = KindPairs::index(std::min(a, b), std::max(a, b));
        of[a][b] = static_cast<std::uint8_t>(code | (a > b ? kMirrored : 0U));
      }
    }
  }
};
constexpr KindCodes kKindCodes;

// Pairs per parallel task.
[[nodiscard]] constexpr std::size_t range_size(std::size_t pairs) noexcept {
  constexpr std::size_t kMinPairs = 16384;
  constexpr std::size_t kMaxRanges = 64;
  return even_range_length(pairs, kMinPairs, kMaxRanges);
}

// True if all of a, b < limit <= 2^31. Uses only differences and ors, so that every compiler
// vectorizes the loop.
[[nodiscard]] bool all_below(std::span<const BodyPair> pairs, std::uint32_t limit) noexcept {
  std::uint32_t outside = 0;
  for (const BodyPair& pair : pairs) {
    outside |= pair.a | pair.b | (limit - 1 - pair.a) | (limit - 1 - pair.b);
  }
  return (outside & kTopBit) == 0;
}

// Returns the only kind of shape that a pool contains, or kShapeKinds if there are several or none.
[[nodiscard]] std::uint32_t only_kind(const ShapeTables& tables) noexcept {
  std::uint32_t only = kShapeKinds;
  for (std::uint32_t kind = 0; kind < kShapeKinds; ++kind) {
    if (tables.count[kind] == 0) continue;
    if (only != kShapeKinds) return kShapeKinds;
    only = kind;
  }
  return only;
}

[[nodiscard]] bool all_are(std::span<const ShapeId> shapes, std::uint32_t kind, std::uint32_t limit,
                           const Execution& execution) noexcept {
  constexpr std::size_t kShapesPerTask = 65536;
  const std::uint32_t base = kind << ShapeId::kIndexBits;
  std::atomic<std::uint32_t> any_outside{0};
  for_each_even_range(
      execution, shapes.size(), kShapesPerTask, [&](std::size_t first, std::size_t end) {
        std::uint32_t outside = 0;
        for (const ShapeId& id : shapes.subspan(first, end - first)) {  // copies do not vectorize
          const std::uint32_t index = id.bits - base;
          outside |= index | (limit - 1 - index);
        }
        any_outside.fetch_or(outside, std::memory_order_relaxed);
      });
  return (any_outside.load(std::memory_order_relaxed) & kTopBit) == 0;
}

}  // namespace

Status PairBuckets::sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
                         std::span<const BodyPair> pairs, const Execution& execution,
                         Column<std::uint32_t>& order, Column<NarrowRun>& runs,
                         std::uint32_t& bad_body) {
  runs.clear();
  any_mirrored_ = false;
  pairs_ = pairs.data();
  if (shapes.size() >= kTopBit) return Status::invalid_argument;
  if (pairs.size() == 1) return take_one(tables, shapes, pairs, order, runs, bad_body);
  std::ranges::fill(counts_, 0U);
  range_ = {};
  // If the pool contains only one kind, the kinds of the pairs need not be read. Checking the
  // shapes of all bodies instead pays only if there are at most kClassifyCost bodies per pair.
  constexpr std::size_t kClassifyCost = 8;  // estimate of the cost per pair, in checks of a body
  const std::uint32_t only =
      shapes.size() / kClassifyCost <= pairs.size() ? only_kind(tables) : kShapeKinds;
  const bool one_kind = only != kShapeKinds && all_are(shapes, only, tables.count[only], execution);
  const std::size_t tasks =
      (pairs.size() + range_size(pairs.size()) - 1) / range_size(pairs.size());
  if (!order.resize(pairs.size()) || !tasks_.resize(tasks) ||
      (!one_kind && !codes_.resize(pairs.size()))) {
    return Status::out_of_memory;
  }
  for_tasks(pairs, execution,
            [&](std::span<const BodyPair> some, std::size_t first, TaskCounts& task) {
              task.clear();
              std::iota(order.data() + first, order.data() + first + some.size(),
                        static_cast<std::uint32_t>(first));
              if (!all_below(some, static_cast<std::uint32_t>(shapes.size()))) {
                task.status = Status::invalid_argument;
              } else if (one_kind) {
                task.add(KindPairs::index(only, only), static_cast<std::uint32_t>(some.size()));
              } else {
                count_pairs(tables, shapes, some, first, task);
              }
            });
  if (const Status status = sum_up(bad_body); status != Status::ok) return status;
  if (range_.low >= range_.high && !any_mirrored_) return add_runs(runs);
  if (!sorted_.resize(pairs.size())) return Status::out_of_memory;
  find_offsets();
  for_tasks(pairs, execution,
            [&](std::span<const BodyPair> some, std::size_t first, TaskCounts& task) {
              place(some, first, task, order.data());
            });
  pairs_ = sorted_.data();
  return add_runs(runs);
}

// A single pair needs no counting sort.
Status PairBuckets::take_one(const ShapeTables& tables, std::span<const ShapeId> shapes,
                             std::span<const BodyPair> pair, Column<std::uint32_t>& order,
                             Column<NarrowRun>& runs, std::uint32_t& bad_body) {
  BodyPair own = pair.front();
  if (own.a >= shapes.size() || own.b >= shapes.size()) return Status::invalid_argument;
  for (const std::uint32_t body : {own.a, own.b}) {
    if (has_shape(tables, shapes[body])) continue;
    bad_body = body;
    return Status::invalid_key;
  }
  any_mirrored_ = shapes[own.a].kind_index() > shapes[own.b].kind_index();
  if (any_mirrored_) {
    std::swap(own.a, own.b);
    if (!sorted_.resize(1)) return Status::out_of_memory;
    sorted_[0] = own;
    pairs_ = sorted_.data();
  }
  if (!order.resize(1) || !runs.resize(1)) return Status::out_of_memory;
  order[0] = 0;
  // Write the members in place: copying a temporary would stall on its stores.
  NarrowRun& run = runs[0];
  run.a = shapes[own.a].kind();
  run.b = shapes[own.b].kind();
  run.first = 0;
  run.count = 1;
  return Status::ok;
}

// Calls body(pairs, index of the first, task) for each range of the pairs, in parallel.
template <typename Body>
void PairBuckets::for_tasks(std::span<const BodyPair> pairs, const Execution& execution,
                            Body&& body) {
  const std::size_t length = range_size(pairs.size());
  for_each_range(execution, pairs.size(), length, [&](std::size_t first, std::size_t end) {
    body(pairs.subspan(first, end - first), first, tasks_[first / length]);
  });
}

// Calls note(i, code) for all pairs and stores the codes in codes_; stops with `invalid_key` at a
// shape that does not exist. All bodies must exist.
template <typename Note>
void PairBuckets::for_codes(const ShapeTables& tables, std::span<const ShapeId> shapes,
                            std::span<const BodyPair> pairs, std::size_t first, TaskCounts& task,
                            Note&& note) noexcept {
  std::uint32_t limit[KindCodes::kKinds] = {};
  std::copy_n(tables.count, kShapeKinds, limit);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ShapeId a = shapes[pairs[i].a];
    const ShapeId b = shapes[pairs[i].b];
    if (a.index() >= limit[a.kind_index()] || b.index() >= limit[b.kind_index()]) [[unlikely]] {
      task.bad_body = a.index() >= limit[a.kind_index()] ? pairs[i].a : pairs[i].b;
      task.status = Status::invalid_key;
      return;
    }
    const std::uint8_t code = kKindCodes.of[a.kind_index()][b.kind_index()];
    note(i, code);
    codes_[first + i] = code;
  }
}

void PairBuckets::count_pairs(const ShapeTables& tables, std::span<const ShapeId> shapes,
                              std::span<const BodyPair> pairs, std::size_t first,
                              TaskCounts& task) noexcept {
  constexpr std::size_t kFew = 192;
  if (pairs.size() < kFew) {
    return for_codes(tables, shapes, pairs, first, task, [&](std::size_t, std::uint32_t code) {
      task.add(code & (kMirrored - 1U), 1);
      task.mirrored += code / kMirrored;
    });
  }
  // Counts in two tables in turn: with one table, runs of equal codes would make each increment
  // depend on the previous increment.
  constexpr std::size_t kTurns = 2;
  std::uint32_t counts[kTurns][kMirrored + KindPairs::kCount];
  for (auto& some : counts) std::ranges::fill(some, 0U);
  for_codes(tables, shapes, pairs, first, task,
            [&](std::size_t i, std::uint32_t code) { ++counts[i % kTurns][code]; });
  for (std::uint32_t code = 0; code < KindPairs::kCount; ++code) {
    const std::uint32_t mirrored = counts[0][code | kMirrored] + counts[1][code | kMirrored];
    const std::uint32_t all = counts[0][code] + counts[1][code] + mirrored;
    if (all != 0) task.add(code, all);
    task.mirrored += mirrored;
  }
}

// A body that does not exist takes precedence over a shape that does not exist, and leaves bad_body
// unset.
Status PairBuckets::sum_up(std::uint32_t& bad_body) noexcept {
  const TaskCounts* refused = nullptr;
  for (const TaskCounts& task : tasks_) {
    if (task.status == Status::invalid_argument) return Status::invalid_argument;
    if (refused == nullptr && task.status != Status::ok) refused = &task;
    any_mirrored_ = any_mirrored_ || task.mirrored != 0;
    for (std::uint32_t code = task.codes.low; code <= task.codes.high; ++code) {
      counts_[code] += task.counts[code];
    }
    range_.low = std::min(range_.low, task.codes.low);
    range_.high = std::max(range_.high, task.codes.high);
  }
  if (refused == nullptr) return Status::ok;
  bad_body = refused->bad_body;
  return refused->status;
}

// Turns the counts into the index of the first pair of each task, by code.
void PairBuckets::find_offsets() noexcept {
  std::uint32_t next = 0;
  for (std::uint32_t code = range_.low; code <= range_.high; ++code) {
    for (TaskCounts& task : tasks_) next += std::exchange(task.counts[code], next);
  }
}

void PairBuckets::place(std::span<const BodyPair> pairs, std::size_t first, TaskCounts& task,
                        std::uint32_t* order) noexcept {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t code = codes_[first + i];
    const std::uint32_t at = task.counts[code & (kMirrored - 1U)]++;
    const BodyPair pair = pairs[i];
    sorted_[at] = (code & kMirrored) != 0 ? BodyPair{pair.b, pair.a} : pair;
    order[at] = static_cast<std::uint32_t>(first + i);
  }
}

Status PairBuckets::add_runs(Column<NarrowRun>& runs) const {
  std::uint32_t first = 0;
  for (std::uint32_t code = range_.low; code <= range_.high; ++code) {
    if (counts_[code] == 0) continue;
    const NarrowRun run{static_cast<ShapeKind>(KindPairs::first(code)),
                        static_cast<ShapeKind>(KindPairs::second(code)), first, counts_[code]};
    if (!runs.push_back(run)) return Status::out_of_memory;
    first += counts_[code];
  }
  return Status::ok;
}

}  // namespace winnow
