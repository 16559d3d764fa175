#pragma once

#include <winnow/core/memory.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"

#include <array>
#include <cstddef>
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
  /// Returns the expected share of the sampled objects still in regular rows that will have left
  /// after `ahead` more frames, if the positions were stored `frames` frames ago. O(1).
  [[nodiscard]] float share(const Rows& rows, const Structure& structure, std::size_t frames,
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
};

}  // namespace winnow
