#pragma once

#include <winnow/core/column.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// Tells, from a sample of the objects in regular rows, how many will leave the places where a
/// build put them within the next refreshes, if all go on as they did since then.
class Departures {
 public:
  explicit Departures(std::pmr::memory_resource* memory) noexcept : seen_(memory) {}

  /// Room for a sample of so many regular rows. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t regular) noexcept {
    return regular < kSample || seen_.reserve(kSample);
  }
  /// Notes where a sample of the regular rows' objects is. Room was made. O(1).
  void begin(const Rows& rows) noexcept;
  /// Objects have moved once more.
  void note_refresh() noexcept { ++refreshes_; }
  [[nodiscard]] std::size_t refreshes() const noexcept { return refreshes_; }
  /// The expected share of those still there that will have left in so many refreshes. O(1).
  [[nodiscard]] float share(const Rows& rows, const Structure& structure,
                            std::size_t ahead) const noexcept;
  void release() noexcept { seen_.release(); }
  [[nodiscard]] Bytes bytes() const noexcept { return seen_.bytes(); }

 private:
  static constexpr std::size_t kSample = 64;

  struct Seen {
    ObjectId id;
    std::array<float, 3> low;
  };
  Column<Seen> seen_;
  std::size_t refreshes_ = 0;
};

/// A count that grows from refresh to refresh, ever faster it may be.
class Growth {
 public:
  /// The next count is the first of its kind.
  void begin() noexcept { last_ = step_ = faster_ = 0; }
  void note(std::uint64_t count) noexcept {
    const std::uint64_t step = count > last_ ? count - last_ : 0;
    faster_ = last_ != 0 && step > step_ ? step - step_ : 0;
    step_ = last_ != 0 ? step : 0;
    last_ = count;
  }
  /// What it is expected to be in so many refreshes.
  [[nodiscard]] std::uint64_t in(std::size_t refreshes) const noexcept {
    return last_ + step_ * refreshes + faster_ * refreshes * (refreshes + 1) / 2;
  }

 private:
  std::uint64_t last_ = 0;
  std::uint64_t step_ = 0;
  std::uint64_t faster_ = 0;  // than the step before
};

}  // namespace winnow
