#include "pipeline/cluster/bisection.h"

#include "pipeline/cluster/regions.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace winnow {
namespace {

struct WorkItem {
  Vec3f centre;
  Aabb box;
  std::uint64_t work;
};

/// A possible cut, with its quality.
struct CutCandidate {
  SplitPlane cut;
  std::size_t cut_in_two = 0;
  float length = 0.0F;  // extent of the centres along the axis

  [[nodiscard]] bool is_better_than(const CutCandidate& other) const noexcept {
    if (cut_in_two != other.cut_in_two) return cut_in_two < other.cut_in_two;
    return length > other.length;
  }
};

class Bisection {
 public:
  Bisection(std::vector<WorkItem> items, std::span<SplitPlane> cuts)
      : items_(std::move(items)), cuts_(cuts) {}

  /// Cuts the region of ranks [first, first + count). Returns the index of the root of the new
  /// cuts; ~first if `count` is 1.
  std::int32_t cut(std::span<WorkItem> items, std::uint32_t first, std::uint32_t count) {
    if (count == 1) return ~static_cast<std::int32_t>(first);
    const std::uint32_t below = count / 2;
    SplitPlane cut = best_cut(items, below, count);
    const auto number = static_cast<std::int32_t>(made_++);
    const int axis = static_cast<int>(cut.axis);
    const auto middle = std::partition(items.begin(), items.end(), [&](const WorkItem& item) {
      return item.centre[axis] < cut.at;
    });
    const auto left = static_cast<std::size_t>(middle - items.begin());
    cut.sides = {this->cut(items.first(left), first, below),
                 this->cut(items.subspan(left), first + below, count - below)};
    cuts_[static_cast<std::size_t>(number)] = cut;
    return number;
  }

  std::span<WorkItem> items() noexcept { return items_; }

 private:
  static SplitPlane best_cut(std::span<WorkItem> items, std::uint32_t below, std::uint32_t count) {
    CutCandidate best;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const CutCandidate candidate = candidate_on(items, axis, below, count);
      if (axis == 0 || candidate.is_better_than(best)) best = candidate;
    }
    return best.cut;
  }

  static CutCandidate candidate_on(std::span<WorkItem> items, std::uint32_t axis,
                                   std::uint32_t below, std::uint32_t count) {
    CutCandidate candidate;
    candidate.cut.axis = axis;
    if (items.empty()) return candidate;
    candidate.cut.at = quantile(items, static_cast<int>(axis), below, count);
    float low = std::numeric_limits<float>::max();
    float high = -low;
    for (const WorkItem& item : items) {
      const int a = static_cast<int>(axis);
      low = std::min(low, item.centre[a]);
      high = std::max(high, item.centre[a]);
      candidate.cut_in_two +=
          item.box.min[a] < candidate.cut.at && item.box.max[a] >= candidate.cut.at;
    }
    // If all centres are equal on this axis, it cannot divide the work: rank it last.
    if (!(low < high)) candidate.cut_in_two = items.size() + 1;
    candidate.length = high * 0.5F - low * 0.5F;
    return candidate;
  }

  /// Returns a coordinate such that about below / count of the work is of centres below it. By
  /// quickselect.
  static float quantile(std::span<WorkItem> items, int axis, std::uint32_t below,
                        std::uint32_t count) {
    std::uint64_t sum = 0;
    for (const WorkItem& item : items) sum += item.work;
    std::uint64_t target = sum / count * below + sum % count * below / count;
    while (items.size() > 1) {
      const std::size_t half = items.size() / 2;
      std::nth_element(
          items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
          [axis](const WorkItem& a, const WorkItem& b) { return a.centre[axis] < b.centre[axis]; });
      std::uint64_t first = 0;
      for (const WorkItem& item : items.first(half)) first += item.work;
      if (target < first) {
        items = items.first(half);
      } else {
        target -= first;
        items = items.subspan(half);
      }
    }
    return items.front().centre[axis];
  }

  std::vector<WorkItem> items_;
  std::span<SplitPlane> cuts_;
  std::size_t made_ = 0;
};

}  // namespace

void bisect(std::span<const CutWork> work, std::span<SplitPlane> cuts) {
  std::vector<WorkItem> items;
  for (const CutWork& part : work) {
    for (std::size_t i = 0; i < part.boxes.size(); ++i) {
      items.push_back({centre_of(part.boxes[i]), part.boxes[i], part.works[i]});
    }
  }
  if (cuts.empty()) return;
  Bisection bisection(std::move(items), cuts);
  (void)bisection.cut(bisection.items(), 0, static_cast<std::uint32_t>(cuts.size()) + 1);
}

}  // namespace winnow
