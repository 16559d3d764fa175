#include "bench/contenders/engines.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/registry.h"

// CGAL compiles its parallel version only with this macro.
#define CGAL_LINKED_WITH_TBB
#include <tbb/enumerable_thread_specific.h>

#include <CGAL/box_intersection_d.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

struct Box {
  std::array<float, 3> min;
  std::array<float, 3> max;
  std::uint32_t row;
};

struct BoxTraits {
  using NT = float;
  using ID = std::uint32_t;
  using Box_parameter = const Box&;

  static int dimension() { return 3; }
  static NT min_coord(Box_parameter box, int axis) {
    return box.min[static_cast<std::size_t>(axis)];
  }
  static NT max_coord(Box_parameter box, int axis) {
    return box.max[static_cast<std::size_t>(axis)];
  }
  static ID id(Box_parameter box) { return box.row; }
};

/// CGAL: box_self_intersection_d, closed, on float boxes by value. It keeps no data between frames.
/// With more than one thread its parallel version, which does more work in total, is tried too: the
/// first three frames run sequentially, in parallel and sequentially, and the faster version is
/// used from then on, until the number of boxes has doubled.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): boxes by value,
/// not by pointer; a cutoff of 4 sqrt(n) instead of 10; and an order of axes in which the first
/// axis, which CGAL sweeps, prunes most, and the last one, which CGAL divides, prunes second most.
class CgalEngine final : public PairsAdapter {
 public:
  explicit CgalEngine(int threads) : serial_(threads < 2), decided_(serial_) {}

  [[nodiscard]] std::string name() const override { return "CGAL boxes"; }

  /// At the peak of a search: the boxes and CGAL's copies of them.
  [[nodiscard]] std::size_t bytes() const override {
    return boxes_.capacity() * sizeof(Box) * (parallel_ ? 10 : 2);
  }

 private:
  void build(std::span<const Aabb> boxes) override {
    axes_ = axes_by_pruning(boxes);
    std::swap(axes_[1], axes_[2]);  // the second best axis is the last
    copy(boxes);
  }

  void update(std::span<const std::uint32_t>, std::span<const Aabb> all_boxes) override {
    if (!serial_ && decided_ && all_boxes.size() > 2 * decided_for_) {
      decided_ = parallel_ = false;
      parallel_ms_ = 0.0;
    }
    copy(all_boxes);
  }

  void copy(std::span<const Aabb> boxes) {
    boxes_.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      Box& box = boxes_[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.min[axis] = boxes[i].min[axes_[axis]];
        box.max[axis] = boxes[i].max[axes_[axis]];
      }
      box.row = static_cast<std::uint32_t>(i);
    }
  }

  void find_pairs(std::span<const Aabb>) override {
    const Stopwatch watch;
    pairs_.clear();
    if (parallel_) {
      search_parallel();
    } else {
      search();
    }
    if (!decided_) decide(watch.ms());
  }

  [[nodiscard]] std::ptrdiff_t cutoff() const {
    return static_cast<std::ptrdiff_t>(4.0 * std::sqrt(static_cast<double>(boxes_.size())));
  }

  void search() {
    CGAL::box_self_intersection_d(
        boxes_.begin(), boxes_.end(),
        [this](const Box& a, const Box& b) { pairs_.push_back(ordered(a.row, b.row)); },
        BoxTraits(), cutoff(), CGAL::Box_intersection_d::CLOSED);
  }

  void search_parallel() {
    for (std::vector<Pair>& pairs : found_) pairs.clear();
    CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
        boxes_.begin(), boxes_.end(),
        [this](const Box& a, const Box& b) { found_.local().push_back(ordered(a.row, b.row)); },
        BoxTraits(), cutoff(), CGAL::Box_intersection_d::CLOSED);
    for (const std::vector<Pair>& pairs : found_) {
      pairs_.insert(pairs_.end(), pairs.begin(), pairs.end());
    }
  }

  void decide(double milliseconds) {
    if (parallel_) {
      parallel_ms_ = milliseconds;
      parallel_ = false;
    } else if (parallel_ms_ == 0.0) {
      parallel_ = true;
    } else {
      parallel_ = parallel_ms_ < milliseconds;
      decided_ = true;
      decided_for_ = boxes_.size();
    }
  }

  std::vector<Box> boxes_;
  tbb::enumerable_thread_specific<std::vector<Pair>> found_;
  std::array<int, 3> axes_{0, 1, 2};
  bool serial_;
  bool decided_;
  std::size_t decided_for_ = 0;  // number of boxes
  bool parallel_ = false;
  double parallel_ms_ = 0.0;
};

const RegisteredPeer<Engine, CgalEngine> kCgalEngine;

}  // namespace
}  // namespace winnow::bench
