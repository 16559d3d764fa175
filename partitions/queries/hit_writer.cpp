#include "partitions/queries/hit_writer.h"

#include "partitions/queries/kernel_arguments.h"

#include <algorithm>
#include <array>

namespace winnow {
namespace {

/// A hit as the cast kernels write it.
struct FoundHit {
  std::uint32_t query;
  ObjectId id;
  std::uint32_t t_bits;

  FoundHit(const Pair* pairs, std::size_t i) noexcept
      : query(pairs[2 * i].first), id(pairs[2 * i].second), t_bits(pairs[2 * i + 1].first) {}
  [[nodiscard]] std::uint64_t order() const noexcept {
    return static_cast<std::uint64_t>(t_bits) << 32U | id;
  }
};

void sort(std::uint64_t* begin, std::uint64_t* end) noexcept {
  const auto size = static_cast<std::size_t>(end - begin);
  if (size < 2) return;
  if (size <= kMaxSorted) {
    cast_kernels().sort_few(begin, static_cast<std::uint32_t>(size));
  } else {
    std::sort(begin, end);
  }
}

/// Returns the index of the first hit of this or a later query, which is the first of a group. Hits
/// are sorted by group.
std::size_t first_of(const Pair* pairs, std::size_t hits, std::size_t query) noexcept {
  std::size_t low = 0;
  std::size_t high = hits;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (FoundHit(pairs, middle).query < query) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace

bool HitWriter::start(HitBuffer& out, std::size_t queries) noexcept {
  out.clear();
  if (!out.start_.resize(queries + 1)) return false;
  out.start_[0] = 0;
  return true;
}

bool HitWriter::finish(HitBuffer& out, std::size_t first, std::size_t last, const KeyTable& keys,
                       const Execution& execution) noexcept {
  const std::size_t found = out.found_.size() / 2;
  const std::size_t before = out.rows_.size();
  if (!out.keys_.resize(found) || !out.rows_.resize(before + found)) return false;
  execution.for_each((last - first + kGroup - 1) / kGroup, [&](std::size_t group) {
    const std::size_t begin = first + group * kGroup;
    finish_group(out, begin, std::min(last, begin + kGroup), before, keys);
  });
  out.found_.clear();
  return true;
}

void HitWriter::finish_group(HitBuffer& out, std::size_t first, std::size_t last,
                             std::size_t hits_before, const KeyTable& keys) noexcept {
  const Pair* const pairs = out.found_.pairs().data();
  const std::size_t found = out.found_.size() / 2;
  const std::size_t begin = first_of(pairs, found, first);
  std::array<std::size_t, kGroup + 1> start;
  std::fill_n(start.begin(), last - first + 1, 0);
  std::size_t end = begin;
  for (; end < found && FoundHit(pairs, end).query < last; ++end) {
    ++start[FoundHit(pairs, end).query - first + 1];
  }
  start[0] = begin;
  for (std::size_t q = 0; q < last - first; ++q) {
    start[q + 1] += start[q];
    out.start_[first + q + 1] = hits_before + start[q + 1];
  }
  for (std::size_t i = begin; i < end; ++i) {
    const FoundHit hit(pairs, i);
    out.keys_[start[hit.query - first]++] = hit.order();
  }
  // Each start has advanced to the start of the next query.
  std::uint64_t* const order = out.keys_.data();
  for (std::size_t q = 0; q < last - first; ++q) {
    sort(order + (q == 0 ? begin : start[q - 1]), order + start[q]);
  }
  write(out, begin, end, hits_before, keys);
}

void HitWriter::write(HitBuffer& out, std::size_t begin, std::size_t end, std::size_t hits_before,
                      const KeyTable& keys) noexcept {
  constexpr std::size_t kAhead = 16;
  for (std::size_t i = begin; i < end; ++i) {
    if (i + kAhead < end) keys.fetch(static_cast<ObjectId>(out.keys_[i + kAhead]));
    out.rows_[hits_before + i] = to_hit(keys, out.keys_[i]);
  }
}

bool HitWriter::write_heap(HitBuffer& out, const KeyTable& keys) noexcept {
  Column<std::uint64_t>& heap = out.keys_;
  if (!out.start_.resize(2) || !out.rows_.resize(heap.size())) return false;
  sort(heap.begin(), heap.end());
  out.start_[0] = 0;
  out.start_[1] = heap.size();
  write(out, 0, heap.size(), 0, keys);
  return true;
}

}  // namespace winnow
