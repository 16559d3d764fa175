#pragma once

#include "pipeline/motion/feature_motion.h"
#include "pipeline/motion/feature_test.kernel.h"

namespace winnow {

[[nodiscard]] bool are_in_range(const FeatureImpactOptions& options) noexcept;

/// Collects up to eight pairs of features, to test them together.
class FeatureStage {
 public:
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool is_full() const noexcept { return size_ == kFeatureLanes; }
  void clear() noexcept { size_ = 0; }

  /// The stage must not be full.
  void add(const std::array<Vec3d, 4>& start, const std::array<Vec3d, 4>& end) noexcept {
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        column_[3 * k + axis][size_] = start[k][axis];
        column_[12 + 3 * k + axis][size_] = end[k][axis];
      }
    }
    ++size_;
  }

  /// As `feature_impacts`; options must be within their ranges.
  void find(FeaturePair kind, double (&times)[kFeatureLanes],
            const FeatureImpactOptions& options) const noexcept;

 private:
  // Entries beyond `size_` are tested, too; their results are ignored.
  double column_[24][kFeatureLanes] = {};
  std::size_t size_ = 0;
};

}  // namespace winnow
