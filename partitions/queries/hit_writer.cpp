#include <winnow/partitions/queries/hit_writer.h>

#include <winnow/partitions/queries/cast.kernel.h>

#include <algorithm>
#include <array>

namespace winnow {
namespace {

/// A hit as casts write it.
struct Found {
  std::uint32_t question;
  ObjectId id;
  std::uint32_t t_bits;

  Found(const Pair* pairs, std::size_t i) noexcept
      : question(pairs[2 * i].first), id(pairs[2 * i].second), t_bits(pairs[2 * i + 1].first) {}
  [[nodiscard]] std::uint64_t order() const noexcept {
    return static_cast<std::uint64_t>(t_bits) << 32U | id;
  }
};

void sort(std::uint64_t* begin, std::uint64_t* end) noexcept {
  const auto size = static_cast<std::size_t>(end - begin);
  if (size < 2) return;
  if (size <= kMostSorted) {
    cast_kernels().sort_few(begin, static_cast<std::uint32_t>(size));
  } else {
    std::sort(begin, end);
  }
}

/// The first hit of a question or a later one; hits of different groups of questions are in order.
std::size_t first_of(const Pair* pairs, std::size_t hits, std::size_t question) noexcept {
  std::size_t low = 0;
  std::size_t high = hits;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (Found(pairs, middle).question < question) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

}  // namespace

bool HitWriter::finish(HitBuffer& out, std::size_t questions, const KeyTable& keys,
                       const Execution& execution) noexcept {
  const std::size_t hits = out.found_.size() / 2;
  if (!out.start_.resize(questions + 1) || !out.keys_.resize(hits) || !out.hits_.resize(hits)) {
    return false;
  }
  out.start_[questions] = hits;
  execution.for_each(
      (questions + kQuestionsTogether - 1) / kQuestionsTogether, [&](std::size_t group) {
        const std::size_t first = group * kQuestionsTogether;
        finish_some(out, first, std::min(questions, first + kQuestionsTogether), keys);
      });
  return true;
}

void HitWriter::finish_some(HitBuffer& out, std::size_t first, std::size_t last,
                            const KeyTable& keys) noexcept {
  const Pair* const pairs = out.found_.pairs().data();
  const std::size_t hits = out.found_.size() / 2;
  const std::size_t begin = first_of(pairs, hits, first);
  std::array<std::size_t, kQuestionsTogether + 1> start{};
  std::size_t end = begin;
  for (; end < hits && Found(pairs, end).question < last; ++end) {
    ++start[Found(pairs, end).question - first + 1];
  }
  start[0] = begin;
  for (std::size_t q = 0; q < last - first; ++q) {
    out.start_[first + q] = start[q];
    start[q + 1] += start[q];
  }
  for (std::size_t i = begin; i < end; ++i) {
    const Found found(pairs, i);
    out.keys_[start[found.question - first]++] = found.order();
  }
  // Starts have moved on to the ends.
  for (std::size_t q = 0; q < last - first; ++q) {
    sort(out.keys_.data() + out.start_[first + q], out.keys_.data() + start[q]);
  }
  for (std::size_t i = begin; i < end; ++i) out.hits_[i] = to_hit(keys, out.keys_[i]);
}

bool HitWriter::write_heap(HitBuffer& out, const KeyTable& keys) noexcept {
  Column<std::uint64_t>& heap = out.keys_;
  if (!out.start_.resize(2) || !out.hits_.resize(heap.size())) return false;
  sort(heap.begin(), heap.end());
  out.start_[0] = 0;
  out.start_[1] = heap.size();
  for (std::size_t i = 0; i < heap.size(); ++i) out.hits_[i] = to_hit(keys, heap[i]);
  return true;
}

}  // namespace winnow
