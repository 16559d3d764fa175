#include "partitions/tree/sah_order.h"

#include "core/sort/radix_sort.h"
#include "core/sort/split_jobs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cstddef>
#include <limits>

namespace winnow {
namespace {

constexpr std::size_t kAxes = 4;           // the fourth is size
constexpr std::uint32_t kFewToSort = 256;  // to be sorted rather than binned
constexpr std::uint32_t kBins = 64;
constexpr std::uint32_t kSahWorthSharing = 4096;

/// What a split compares boxes by: monotone in the centre on an axis, or in the logarithm of the
/// longest edge.
float key_of(const SahBox& box, std::size_t axis) {
  if (axis < 3) return 0.5F * box.low[axis] + 0.5F * box.high[axis];
  float edge = 0.0F;
  for (std::size_t a = 0; a < 3; ++a) edge = std::max(edge, box.high[a] - box.low[a]);
  return -static_cast<float>(std::bit_cast<std::int32_t>(std::min(edge, FLT_MAX)));
}

struct SahExtent {
  std::array<float, 3> low;
  std::array<float, 3> high;

  SahExtent() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const SahBox& box) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], box.low[a]);
      high[a] = std::max(high[a], box.high[a]);
    }
  }
  void merge(const SahExtent& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], other.low[a]);
      high[a] = std::max(high[a], other.high[a]);
    }
  }
  [[nodiscard]] double edge(std::size_t a) const {
    constexpr double kMost = 1e38;
    return std::min(kMost, static_cast<double>(high[a]) - static_cast<double>(low[a]));
  }
  /// Half of the surface, and as much of the edges as a question of size `margin` sees of them: in
  /// flat and thin sets the surface alone does not tell.
  [[nodiscard]] double cost(double margin) const {
    if (!(low[0] <= high[0])) return 0.0;
    const double x = edge(0);
    const double y = edge(1);
    const double z = edge(2);
    return x * y + y * z + z * x + margin * (x + y + z);
  }
};

/// Boxes [begin, end), to be put into subtrees of 16^level blocks; all but the last one full.
struct SahJob {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t level = 0;

  [[nodiscard]] std::uint32_t size() const { return end - begin; }
  /// Boxes in a subtree.
  [[nodiscard]] std::uint32_t places() const {
    return static_cast<std::uint32_t>(kBlockRows) << (4 * level);
  }
  [[nodiscard]] std::uint32_t subtrees() const { return (size() + places() - 1) / places(); }
};

/// The first `count` boxes by their keys on `axis` go to the first side.
struct Cut {
  std::size_t axis = 0;
  std::uint32_t count = 0;
  double cost = std::numeric_limits<double>::infinity();
};

class Builder {
 public:
  Builder(std::span<SahBox> boxes, const Execution& execution)
      : boxes_(boxes), execution_(execution) {
    double sum = 0.0;
    double bounded = 0.0;
    for (const SahBox& box : boxes) {
      SahExtent extent;
      extent.add(box);
      const double edges = extent.edge(0) + extent.edge(1) + extent.edge(2);
      if (!(edges < 1e30)) continue;
      sum += edges;
      ++bounded;
    }
    margin_ = sum / std::max(1.0, 3.0 * bounded);
  }

  void run() {
    SahJob all{0, static_cast<std::uint32_t>(boxes_.size()), 0};
    while (all.subtrees() > 16) ++all.level;
    run_split_jobs(
        all, kSahWorthSharing, execution_, [this](SahJob& job) { return split(job); },
        [this](const SahJob& job) { finish(job); });
  }

 private:
  void finish(SahJob job) const {
    while (job.size() > kBlockRows) finish(split(job));
    std::sort(boxes_.begin() + job.begin, boxes_.begin() + job.end,
              [](const SahBox& a, const SahBox& b) { return a.row < b.row; });
  }

  /// Leaves the first side to `job` and returns the other.
  SahJob split(SahJob& job) const {
    while (job.subtrees() == 1) --job.level;
    const Cut cut = job.size() <= kFewToSort ? best_sorted_cut(job) : best_binned_cut(job);
    const auto begin = boxes_.begin() + job.begin;
    std::nth_element(begin, begin + cut.count, boxes_.begin() + job.end,
                     [&](const SahBox& a, const SahBox& b) {
                       const float x = key_of(a, cut.axis);
                       const float y = key_of(b, cut.axis);
                       return x != y ? x < y : a.row < b.row;
                     });
    SahJob second = job;
    second.begin = job.end = job.begin + cut.count;
    return second;
  }

  /// Keeps in `best` the cut behind `count` boxes if it is better; `first` and `second` are the
  /// costs of the boxes around its sides.
  static void consider(const SahJob& job, std::size_t axis, std::uint32_t count, double first,
                       double second, Cut& best) {
    // A side is looked at itself, and then some of what it holds.
    const auto weight = [&](std::uint32_t boxes) {
      return 1.0 + static_cast<double>(boxes) / job.places();
    };
    const double cost = first * weight(count) + second * weight(job.size() - count);
    if (cost < best.cost) best = {axis, count, cost};
  }

  [[nodiscard]] Cut best_sorted_cut(const SahJob& job) const {
    const std::uint32_t size = job.size();
    const SahBox* const boxes = boxes_.data() + job.begin;
    std::array<std::uint64_t, kFewToSort> sorted;
    std::array<double, kFewToSort> behind;
    Cut best;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      for (std::uint32_t i = 0; i < size; ++i) {
        // The sum, because there is one zero.
        sorted[i] = std::uint64_t{sortable(key_of(boxes[i], axis) + 0.0F)} << 32U | i;
      }
      std::sort(sorted.begin(), sorted.begin() + size);
      const auto box = [&](std::uint32_t i) -> const SahBox& {
        return boxes[static_cast<std::uint32_t>(sorted[i])];
      };
      SahExtent last;
      for (std::uint32_t i = size; i-- > job.places();) {
        last.add(box(i));
        if (i % job.places() == 0) behind[i] = last.cost(margin_);
      }
      SahExtent first;
      for (std::uint32_t i = 0; i < size; ++i) {
        if (i != 0 && i % job.places() == 0) {
          consider(job, axis, i, first.cost(margin_), behind[i], best);
        }
        first.add(box(i));
      }
    }
    return best;
  }

  [[nodiscard]] Cut best_binned_cut(const SahJob& job) const {
    Cut best;
    for (std::size_t axis = 0; axis < kAxes; ++axis) consider_bins(job, axis, best);
    return best;
  }

  void consider_bins(const SahJob& job, std::size_t axis, Cut& best) const {
    const auto boxes = boxes_.subspan(job.begin, job.size());
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const SahBox& box : boxes) {
      const float key = key_of(box, axis);
      low = std::min(low, key);
      high = std::max(high, key);
    }
    const double range = static_cast<double>(high) - static_cast<double>(low);
    const double scale = range > 0.0 ? kBins / range : 0.0;
    std::array<SahExtent, kBins> extent;
    std::array<std::uint32_t, kBins> count{};
    for (const SahBox& box : boxes) {
      const double at = static_cast<double>(key_of(box, axis)) - static_cast<double>(low);
      const auto bin = std::min(kBins - 1, static_cast<std::uint32_t>(at * scale));
      extent[bin].add(box);
      ++count[bin];
    }
    std::array<double, kBins + 1> from{};  // of the bins from each one on
    SahExtent last;
    for (std::size_t b = kBins; b-- > 0;) {
      last.merge(extent[b]);
      from[b] = last.cost(margin_);
    }
    // Most cuts go through a bin: then both sides are taken to reach through all of it.
    SahExtent first;
    std::uint32_t before = 0;
    std::uint32_t cut = job.places();
    for (std::size_t b = 0; b < kBins; ++b) {
      first.merge(extent[b]);
      before += count[b];
      for (; cut <= before && cut < job.size(); cut += job.places()) {
        consider(job, axis, cut, first.cost(margin_), from[cut == before ? b + 1 : b], best);
      }
    }
  }

  std::span<SahBox> boxes_;
  const Execution& execution_;
  double margin_ = 0.0;  // the mean edge
};

}  // namespace

bool append_in_sah_order(const BoundsPool& pool, std::span<const std::uint32_t> rows,
                         Column<SahBox>& scratch, Column<std::uint32_t>& order,
                         const Execution& execution) {
  const std::size_t count = rows.size();
  const std::size_t begin = order.size();
  if (!scratch.resize(count) || !order.resize(begin + count)) return false;
  if (count == 0) return true;
  for (std::size_t i = 0; i < count; ++i) {
    SahBox& box = scratch[i];
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = pool.column(a)[rows[i]];
      box.high[a] = pool.column(3 + a)[rows[i]];
    }
    box.row = rows[i];
  }
  Builder({scratch.data(), count}, execution).run();
  for (std::size_t i = 0; i < count; ++i) order[begin + i] = scratch[i].row;
  return true;
}

}  // namespace winnow
