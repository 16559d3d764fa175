#include "pipeline/narrow/pair_buckets.h"

#include <algorithm>
#include <numeric>

namespace winnow {
namespace {

constexpr std::uint32_t kTopBit = 1U << 31U;
constexpr std::uint8_t kMirrored = 0x80;

// True if all of a, b < limit <= 2^31: sums and ors alone, so that every compiler makes it wide.
[[nodiscard]] bool all_below(std::span<const BodyPair> pairs, std::uint32_t limit) noexcept {
  std::uint32_t outside = 0;
  for (const BodyPair& pair : pairs) {
    outside |= pair.a | pair.b | (limit - 1 - pair.a) | (limit - 1 - pair.b);
  }
  return (outside & kTopBit) == 0;
}

// The only kind that a pool holds, or kShapeKinds.
[[nodiscard]] std::uint32_t only_kind(const ShapeTables& tables) noexcept {
  std::uint32_t only = kShapeKinds;
  for (std::uint32_t kind = 0; kind < kShapeKinds; ++kind) {
    if (tables.count[kind] == 0) continue;
    if (only != kShapeKinds) return kShapeKinds;
    only = kind;
  }
  return only;
}

[[nodiscard]] bool all_are(std::span<const ShapeId> shapes, std::uint32_t kind,
                           std::uint32_t limit) noexcept {
  const std::uint32_t base = kind << ShapeId::kIndexBits;
  std::uint32_t outside = 0;
  for (const ShapeId id : shapes) {
    const std::uint32_t index = id.bits - base;
    outside |= index | (limit - 1 - index);
  }
  return (outside & kTopBit) == 0;
}

}  // namespace

Status PairBuckets::sort(const ShapeTables& tables, std::span<const ShapeId> shapes,
                         std::span<const BodyPair> pairs, Column<std::uint32_t>& order,
                         Column<NarrowRun>& runs, std::uint32_t& bad_body) {
  runs.clear();
  any_mirrored_ = false;
  pairs_ = pairs.data();
  if (shapes.size() >= kTopBit || !all_below(pairs, static_cast<std::uint32_t>(shapes.size()))) {
    return Status::invalid_argument;
  }
  if (!order.resize(pairs.size())) return Status::out_of_memory;
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::fill(counts_, 0U);
  // A scene of one kind needs no look at every pair.
  const std::uint32_t only = only_kind(tables);
  if (only != kShapeKinds && all_are(shapes, only, tables.count[only])) {
    counts_[ConvexKindPairs::index(only, only)] = static_cast<std::uint32_t>(pairs.size());
    return add_runs(runs);
  }
  const Status status = classify(tables, shapes, pairs, bad_body);
  if (status != Status::ok) return status;
  const bool one_run = std::ranges::count_if(counts_, [](auto n) { return n != 0; }) <= 1;
  if (one_run && !any_mirrored_) return add_runs(runs);
  if (!sorted_.resize(pairs.size())) return Status::out_of_memory;
  std::uint32_t next[ConvexKindPairs::kCount];
  std::exclusive_scan(std::begin(counts_), std::end(counts_), std::begin(next), 0U);
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const std::uint32_t code = codes_[i];
    const std::uint32_t at = next[code & (kMirrored - 1U)]++;
    const BodyPair pair = pairs[i];
    sorted_[at] = (code & kMirrored) != 0 ? BodyPair{pair.b, pair.a} : pair;
    order[at] = i;
  }
  pairs_ = sorted_.data();
  return add_runs(runs);
}

Status PairBuckets::classify(const ShapeTables& tables, std::span<const ShapeId> shapes,
                             std::span<const BodyPair> pairs, std::uint32_t& bad_body) {
  if (!codes_.resize(pairs.size())) return Status::out_of_memory;
  std::uint32_t limit[ShapeId{}.kind_index() + 1] = {};
  std::copy_n(tables.count, kShapeKinds, limit);
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ShapeId a = shapes[pairs[i].a];
    const ShapeId b = shapes[pairs[i].b];
    if (a.index() >= limit[a.kind_index()] || b.index() >= limit[b.kind_index()]) [[unlikely]] {
      bad_body = a.index() >= limit[a.kind_index()] ? pairs[i].a : pairs[i].b;
      return Status::invalid_key;
    }
    const std::uint32_t low = std::min(a.kind_index(), b.kind_index());
    const std::uint32_t high = std::max(a.kind_index(), b.kind_index());
    const std::uint32_t code = ConvexKindPairs::index(low, high);
    const std::uint32_t flag = is_mirrored(a, b) ? kMirrored : 0U;
    any |= flag;
    ++counts_[code];
    codes_[i] = static_cast<std::uint8_t>(code | flag);
  }
  any_mirrored_ = any != 0;
  return Status::ok;
}

Status PairBuckets::add_runs(Column<NarrowRun>& runs) const {
  std::uint32_t first = 0;
  for (std::uint32_t code = 0; code < ConvexKindPairs::kCount; ++code) {
    if (counts_[code] == 0) continue;
    const NarrowRun run{static_cast<ShapeKind>(ConvexKindPairs::first(code)),
                        static_cast<ShapeKind>(ConvexKindPairs::second(code)), first,
                        counts_[code]};
    if (!runs.push_back(run)) return Status::out_of_memory;
    first += counts_[code];
  }
  return Status::ok;
}

Bytes PairBuckets::bytes() const noexcept {
  Bytes bytes = sorted_.bytes();
  bytes += codes_.bytes();
  return bytes;
}

}  // namespace winnow
