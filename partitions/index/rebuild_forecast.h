#pragma once

#include <winnow/core/column.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// Predicts, from a sample of the objects in regular rows, how many objects will leave their places
/// within the next refreshes if they keep their mean velocity since the build.
class DepartureForecast {
 public:
  explicit DepartureForecast(std::pmr::memory_resource* memory) noexcept : samples_(memory) {}

  /// Makes room for a sample of `regular` regular rows. Returns false if an allocation fails.
  [[nodiscard]] bool reserve(std::size_t regular) noexcept {
    return regular < kSample || samples_.reserve(kSample);
  }
  /// Stores the positions of a sample of the regular rows. Room must have been reserved. O(1).
  void begin(const Rows& rows) noexcept;
  /// Counts a refresh after which objects have moved.
  void note_refresh() noexcept { ++refreshes_; }
  [[nodiscard]] std::size_t refreshes() const noexcept { return refreshes_; }
  /// Returns the expected share of the sampled objects still in regular rows that will have left
  /// after `ahead` refreshes. O(1).
  [[nodiscard]] float share(const Rows& rows, const Structure& structure,
                            std::size_t ahead) const noexcept;
  void release() noexcept { samples_.release(); }
  [[nodiscard]] Bytes bytes() const noexcept { return samples_.bytes(); }

 private:
  static constexpr std::size_t kSample = 64;

  struct SampledRow {
    ObjectId id;
    std::array<float, 3> low;
  };
  Column<SampledRow> samples_;
  std::size_t refreshes_ = 0;
};

/// Extrapolates a count that grows from refresh to refresh, at a constant or growing rate.
class GrowthForecast {
 public:
  /// Restarts: the next count is the first.
  void begin() noexcept { last_ = step_ = acceleration_ = 0; }
  void note(std::uint64_t count) noexcept {
    const std::uint64_t step = count > last_ ? count - last_ : 0;
    acceleration_ = last_ != 0 && step > step_ ? step - step_ : 0;
    step_ = last_ != 0 ? step : 0;
    last_ = count;
  }
  /// Returns the expected count after `refreshes` more refreshes.
  [[nodiscard]] std::uint64_t in(std::size_t refreshes) const noexcept {
    return last_ + step_ * refreshes + acceleration_ * refreshes * (refreshes + 1) / 2;
  }

 private:
  std::uint64_t last_ = 0;
  std::uint64_t step_ = 0;
  std::uint64_t acceleration_ = 0;  // increase of the step
};

}  // namespace winnow
