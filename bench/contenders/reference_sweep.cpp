#include "bench/contenders/reference_sweep.h"

#include "bench/common/sample.h"
#include "bench/scenes/scene.h"

#include <winnow/core/eigen.h>
#include <algorithm>

namespace winnow::bench {
namespace {

/// Returns the axis on which the summed extents of the boxes are smallest relative to the whole
/// range.
int widest_axis(std::span<const Aabb> boxes) {
  Aabb all;
  Eigen::Vector3d extent = Eigen::Vector3d::Zero();
  for (const Aabb& box : boxes) {
    all.merge(box);
    extent += as_eigen(box.max - box.min).cast<double>();
  }
  int best = 0;
  (extent.array() / as_eigen(all.max - all.min).cast<double>().array()).minCoeff(&best);
  return best;
}

}  // namespace

void ReferenceSweep::start(std::span<const Aabb> boxes) {
  if (axis_ < 0 || axis_ > 2) axis_ = widest_axis(boxes);
  frame({}, boxes);
}

void ReferenceSweep::frame(std::span<const std::uint32_t> /*changed_rows*/,
                           std::span<const Aabb> all_boxes) {
  entries_.resize(all_boxes.size());
  for (std::size_t i = 0; i < all_boxes.size(); ++i) {
    entries_[i] = {all_boxes[i], static_cast<std::uint32_t>(i)};
  }
  if (axis_ == 0) {
    sweep<0>();
  } else if (axis_ == 1) {
    sweep<1>();
  } else {
    sweep<2>();
  }
}

template <int Axis>
void ReferenceSweep::sweep() {
  constexpr int second = (Axis + 1) % 3;
  constexpr int third = (Axis + 2) % 3;
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.box.min[Axis] < b.box.min[Axis]; });
  pairs_.clear();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& a = entries_[i];
    for (std::size_t j = i + 1; j < entries_.size(); ++j) {
      const Entry& b = entries_[j];
      if (b.box.min[Axis] > a.box.max[Axis]) break;
      if (a.box.min[second] <= b.box.max[second] && b.box.min[second] <= a.box.max[second] &&
          a.box.min[third] <= b.box.max[third] && b.box.min[third] <= a.box.max[third]) {
        pairs_.push_back({a.row, b.row});
      }
    }
  }
}

std::size_t ReferenceSweep::bytes() const {
  return entries_.capacity() * sizeof(Entry);
}

double reference_sweep_ms() {
  constexpr int kSweeps = 5;
  const auto scene = make_scene("uniform", 10'000, 1);
  ReferenceSweep sweep;
  sweep.start(scene->boxes());
  std::vector<double> times;
  for (int i = 0; i < kSweeps; ++i) {
    const Stopwatch clock;
    sweep.frame({}, scene->boxes());
    times.push_back(clock.ms());
  }
  return median_of(times);
}

}  // namespace winnow::bench
