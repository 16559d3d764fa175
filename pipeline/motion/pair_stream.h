#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include <winnow/core/results.h>
#include "partitions/rows/row_view.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Streams pairs from a tree to `take` through a buffer that is passed on whenever it is full, so
/// that pairs never use more memory than the buffer.
template <typename Take>
class PairStream {
 public:
  PairStream(std::pmr::memory_resource* memory, std::size_t chunk, Take& take) noexcept
      : buffer_(memory), chunk_(chunk), take_(take) {}

  [[nodiscard]] bool reserve() noexcept {
    if (chunk_ > Column<Pair>::kMaxSize - kSinkSlack || !buffer_.reserve(chunk_ + kSinkSlack)) {
      return false;
    }
    sink_.owner = this;
    sink_.grow = [](PairSink& sink) {
      static_cast<PairStream*>(sink.owner)->flush();
      return true;
    };
    aim();
    return true;
  }

  [[nodiscard]] PairSink& sink() noexcept { return sink_; }

  void flush() noexcept {
    const auto* const begin = reinterpret_cast<const std::uint32_t*>(buffer_.data());
    const auto count = static_cast<std::size_t>(sink_.cursor - begin) / 2;
    for (std::size_t i = 0; i < count; i += chunk_) {
      take_(std::span<Pair>(buffer_.data() + i, std::min(chunk_, count - i)));
    }
    aim();
  }

 private:
  void aim() noexcept {
    sink_.cursor = reinterpret_cast<std::uint32_t*>(buffer_.data());
    sink_.limit = sink_.cursor + 2 * chunk_;
  }

  Column<Pair> buffer_;
  std::size_t chunk_;
  Take& take_;
  PairSink sink_;
};

/// A buffer for the pairs of a range of units of a traversal; the traversal stops if the buffer is
/// full.
class BoundedPairBuffer {
 public:
  explicit BoundedPairBuffer(std::pmr::memory_resource* memory) noexcept : buffer_(memory) {}
  [[nodiscard]] bool reserve(std::size_t pairs) noexcept {
    room_ = pairs;
    return buffer_.reserve(pairs + kSinkSlack);
  }
  template <typename Walk>
  void run(Walk& walk, std::uint32_t begin, std::uint32_t end) noexcept {
    PairSink sink;
    auto* const first = reinterpret_cast<std::uint32_t*>(buffer_.data());
    sink.cursor = first;
    sink.limit = first + 2 * room_;
    sink.grow = [](PairSink&) { return false; };
    fits_ = walk(begin, end, sink);
    count_ = static_cast<std::size_t>(sink.cursor - first) / 2;
  }
  [[nodiscard]] bool fits() const noexcept { return fits_; }
  [[nodiscard]] std::span<Pair> pairs() noexcept { return {buffer_.data(), count_}; }

 private:
  Column<Pair> buffer_;
  std::size_t room_ = 0;
  std::size_t count_ = 0;
  bool fits_ = false;
};

/// Passes all pairs that `walk(begin, end, sink)` finds in `units` units to `take`, in the order of
/// the units, at most a chunk at a time. With several threads, ranges of units are traversed in
/// parallel, each with a buffer of an eighth of a chunk. A range with more pairs is traversed
/// again, into a buffer of a whole chunk that is passed on whenever it is full. Returns false if
/// memory is refused.
template <typename Walk, typename Take>
[[nodiscard]] bool stream_pairs(const Execution& execution, std::pmr::memory_resource* memory,
                                std::size_t chunk, std::uint32_t units, Walk&& walk,
                                Take&& take) noexcept {
  constexpr std::uint32_t kSides = 8;
  constexpr std::size_t kMinRoom = 256;
  PairStream stream(memory, chunk, take);
  if (!stream.reserve()) return false;
  const std::size_t room = chunk / kSides;
  if (units < 2 || room < kMinRoom || execution.concurrency() < 2) {
    if (units != 0) walk(0U, units, stream.sink());
    stream.flush();
    return true;
  }
  std::array<BoundedPairBuffer, kSides> sides{BoundedPairBuffer(memory), BoundedPairBuffer(memory),
                                              BoundedPairBuffer(memory), BoundedPairBuffer(memory),
                                              BoundedPairBuffer(memory), BoundedPairBuffer(memory),
                                              BoundedPairBuffer(memory), BoundedPairBuffer(memory)};
  for (BoundedPairBuffer& side : sides) {
    if (!side.reserve(room)) return false;
  }
  std::uint32_t width = 1;
  for (std::uint32_t next = 0; next < units;) {
    const auto begin = [&](std::size_t k) {
      return static_cast<std::uint32_t>(std::min<std::size_t>(units, next + k * width));
    };
    const std::size_t count = std::min<std::size_t>(kSides, (units - next + width - 1) / width);
    execution.for_each(count, [&](std::size_t k) { sides[k].run(walk, begin(k), begin(k + 1)); });
    std::size_t most = 0;
    for (std::size_t k = 0; k < count; ++k) {
      most = std::max(most, sides[k].fits() ? sides[k].pairs().size() : 2 * room);
      if (!sides[k].fits()) {
        walk(begin(k), begin(k + 1), stream.sink());
        stream.flush();
      } else if (!sides[k].pairs().empty()) {
        take(sides[k].pairs());
      }
    }
    next = begin(count);
    if (most > room) width = std::max(1U, width / 2);
    if (most < room / 4) width = std::min(2 * width, units);
  }
  return true;
}

}  // namespace winnow
