#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/engines.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Tools for several adapters. Adapters report only pairs whose boxes overlap, with the smaller row
// first, so that every library pays for the same result.
namespace winnow::bench {

/// An adapter that collects its pairs and measures the time of updating boxes.
class PairsAdapter : public Engine {
 public:
  void start(std::span<const Aabb> boxes) final {
    run(boxes, [&] { build(boxes); });
  }
  void frame(std::span<const std::uint32_t> changed_rows, std::span<const Aabb> all_boxes) final {
    run(all_boxes, [&] { update(changed_rows, all_boxes); });
  }
  [[nodiscard]] std::span<const Pair> pairs() const final { return pairs_; }
  [[nodiscard]] double update_ms() const final { return update_ms_; }

 protected:
  /// Takes the boxes of the first frame.
  virtual void build(std::span<const Aabb> boxes) = 0;
  virtual void update(std::span<const std::uint32_t> changed_rows,
                      std::span<const Aabb> all_boxes) = 0;
  /// Sets `pairs_`, unless the update has.
  virtual void find_pairs(std::span<const Aabb> boxes) = 0;

  std::vector<Pair> pairs_;

 private:
  template <typename Update>
  void run(std::span<const Aabb> boxes, Update&& update_boxes) {
    const Stopwatch watch;
    update_boxes();
    update_ms_ = watch.ms();
    find_pairs(boxes);
  }

  double update_ms_ = 0.0;
};

/// Converts a row to the pointer that libraries keep for each object, and back.
[[nodiscard]] inline void* pointer_of(std::size_t row) noexcept {
  return reinterpret_cast<void*>(static_cast<std::uintptr_t>(row));
}
[[nodiscard]] inline std::uint32_t row_of(const void* pointer) noexcept {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

[[nodiscard]] inline Pair ordered(std::uint32_t a, std::uint32_t b) noexcept {
  return a < b ? Pair{a, b} : Pair{b, a};
}

/// Returns the axes in descending order of the range of the box centres over the mean extent of the
/// boxes. This ratio is about the inverse of the share of boxes that a box overlaps along the axis,
/// so the first axis is the best one for a sweep.
[[nodiscard]] inline std::array<int, 3> axes_by_pruning(std::span<const Aabb> boxes) {
  std::array<double, 3> spread{};
  for (int axis = 0; axis < 3; ++axis) {
    double lo = 0.0;
    double hi = 0.0;
    double extents = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const auto min = static_cast<double>(boxes[i].min[axis]);
      const auto max = static_cast<double>(boxes[i].max[axis]);
      const double center = 0.5 * (min + max);
      lo = i == 0 ? center : std::min(lo, center);
      hi = i == 0 ? center : std::max(hi, center);
      extents += max - min;
    }
    spread[static_cast<std::size_t>(axis)] = extents > 0.0 ? (hi - lo) / extents : hi - lo;
  }
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) {
    return spread[static_cast<std::size_t>(a)] > spread[static_cast<std::size_t>(b)];
  });
  return axes;
}

/// Mean edge length over all boxes and axes; 0 without boxes.
[[nodiscard]] inline double mean_edge(std::span<const Aabb> boxes) {
  double sum = 0.0;
  for (const Aabb& box : boxes) {
    const Vec3d edges = (box.max - box.min).cast<double>();
    sum += edges.x() + edges.y() + edges.z();
  }
  return boxes.empty() ? 0.0 : sum / (3.0 * static_cast<double>(boxes.size()));
}

}  // namespace winnow::bench
