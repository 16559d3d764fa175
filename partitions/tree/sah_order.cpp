// The order of rows for StaticBvh: cuts sets of boxes in two by the surface-area heuristic, with
// bins. StaticBvh (structures/bvh/bvh.cpp) calls append_in_sah_order.

#include "partitions/tree/sah_order.h"

#include "core/sort/parallel_divide.h"
#include "core/sort/parallel_ranges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace winnow {
namespace {

constexpr std::size_t kAxes = 4;  // the fourth is size
constexpr std::uint32_t kBins = 64;
constexpr std::uint32_t kSahWorthSharing = 4096;
constexpr std::size_t kBoxesPerRange = 8192;
constexpr std::size_t kFewToSample = 4096;  // of more boxes a sample determines the range of keys
constexpr std::size_t kSampleStep = 8;
constexpr float kMinRange = 1e-30F;  // keys within this range count as equal

/// Four floats in a register.
using Quad [[gnu::vector_size(16)]] = float;
using QuadInts [[gnu::vector_size(16)]] = std::int32_t;

Quad load_quad(const float* p) noexcept {
  Quad quad;
  std::memcpy(&quad, p, sizeof quad);
  return quad;
}
Quad least(Quad a, Quad b) noexcept {
  return a < b ? a : b;
}
Quad most(Quad a, Quad b) noexcept {
  return a > b ? a : b;
}

/// The keys by which a split compares boxes: the centre on each axis, and, if `Axes` is 4, a number
/// that decreases with the logarithm of the longest edge.
template <std::size_t Axes>
Quad keys_of(const SahBox& box) noexcept {
  const Quad low = load_quad(box.low);
  Quad high = load_quad(box.high);
  high[3] = low[3];  // not a coordinate
  Quad keys = 0.5F * low + 0.5F * high;
  if constexpr (Axes == 3) return keys;
  const Quad edge = high - low;
  const float longest = std::max(edge[0], std::max(edge[1], edge[2]));
  keys[3] = -static_cast<float>(std::bit_cast<std::int32_t>(std::min(longest, FLT_MAX)));
  return keys;
}

float key_on(const SahBox& box, std::size_t axis) noexcept {
  return axis < 3 ? 0.5F * box.low[axis] + 0.5F * box.high[axis] : keys_of<4>(box)[3];
}

/// A copy of a box in non-overlapping loads, each of which matches one earlier store, so that store
/// forwarding works.
class BoxInRegisters {
 public:
  explicit BoxInRegisters(const SahBox& box) noexcept {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(&box);
    std::memcpy(&head_, bytes, 16);
    std::memcpy(&middle_, bytes + 16, 8);
    std::memcpy(&end_, bytes + 24, 4);
  }
  void put(SahBox& box) const noexcept {
    auto* const bytes = reinterpret_cast<unsigned char*>(&box);
    std::memcpy(bytes, &head_, 16);
    std::memcpy(bytes + 16, &middle_, 8);
    std::memcpy(bytes + 24, &end_, 4);
  }

 private:
  static_assert(sizeof(SahBox) == 28);
  Quad head_;
  std::uint64_t middle_;
  std::uint32_t end_;
};

/// The box around boxes; the fourth floats are unused.
struct SahExtent {
  Quad low;
  Quad high;

  static SahExtent none() noexcept {
    constexpr float inf = std::numeric_limits<float>::infinity();
    return SahExtent{Quad{inf, inf, inf, inf}, Quad{-inf, -inf, -inf, -inf}};
  }
  void add(const SahExtent& other) noexcept {
    low = least(low, other.low);
    high = most(high, other.high);
  }
  [[nodiscard]] double edge(std::size_t a) const {
    constexpr double kMaxExtent = 1e38;
    return std::min(kMaxExtent, static_cast<double>(high[a]) - static_cast<double>(low[a]));
  }
  /// Returns half of the surface plus `margin` times the sum of the edges. The second term is for
  /// queries that have a size themselves: for flat and thin boxes the surface does not suffice.
  [[nodiscard]] double cost(double margin) const {
    if (!(low[0] <= high[0])) return 0.0;
    const double x = edge(0);
    const double y = edge(1);
    const double z = edge(2);
    return x * y + y * z + z * x + margin * (x + y + z);
  }
};

SahExtent extent_of(const SahBox& box) noexcept {
  return {load_quad(box.low), load_quad(box.high)};
}

/// Bins of equal width on each axis over the range of a set's keys. If there are more than
/// kFewToSample boxes, the range is the range of a sample, and keys outside of it are in the first
/// or the last bin.
struct SahBins {
  std::uint32_t count = 0;
  std::size_t axes = 3;  ///< the fourth is used if sizes differ
  Quad half_low{};
  Quad scale{};

  explicit SahBins(std::span<const SahBox> boxes) noexcept
      : count(std::min(kBins, std::bit_ceil(static_cast<std::uint32_t>(boxes.size()) / 2))) {
    Quad low = keys_of<kAxes>(boxes[0]);
    Quad high = low;
    const std::size_t step = boxes.size() <= kFewToSample ? 1 : kSampleStep;
    for (std::size_t i = 0; i < boxes.size(); i += step) {
      const Quad keys = keys_of<kAxes>(boxes[i]);
      low = least(low, keys);
      high = most(high, keys);
    }
    // Halved values, because the range of arbitrary floats could overflow.
    half_low = 0.5F * low;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const float range = 0.5F * high[axis] - half_low[axis];
      scale[axis] = range > kMinRange ? static_cast<float>(count) / range : 0.0F;
    }
    if (scale[3] != 0.0F) axes = kAxes;
  }
  /// Returns the bin on every axis.
  template <std::size_t Axes>
  [[nodiscard]] QuadInts of(const SahBox& box) const noexcept {
    const Quad place = (0.5F * keys_of<Axes>(box) - half_low) * scale;
    const auto last = static_cast<float>(count - 1);
    const Quad within = least(most(place, Quad{}), Quad{last, last, last, last});
    return __builtin_convertvector(within, QuadInts);
  }
  /// True if a box is in the first `bins` bins on an axis.
  [[nodiscard]] bool is_within(const SahBox& box, std::size_t axis, std::uint32_t bins) const {
    const float place = (0.5F * key_on(box, axis) - half_low[axis]) * scale[axis];
    return (bins == count) | ((bins != 0) & (place < static_cast<float>(bins)));
  }
};

/// Boxes [begin, end) to be divided into subtrees of 16^level blocks, all full but the last.
struct SahJob {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t level = 0;

  [[nodiscard]] std::uint32_t size() const { return end - begin; }
  /// Boxes per subtree.
  [[nodiscard]] std::uint32_t places() const {
    return static_cast<std::uint32_t>(kBlockRows) << (4 * level);
  }
  [[nodiscard]] std::uint32_t subtrees() const { return (size() + places() - 1) / places(); }
  /// Returns the number of boxes in half of the subtrees.
  [[nodiscard]] std::uint32_t middle() const { return (subtrees() + 1) / 2 * places(); }
};

/// The first `count` boxes by their keys on `axis` go to the first side; the cut is within `bin` or
/// before it.
struct SahCut {
  std::size_t axis = 0;
  std::uint32_t count = 0;
  std::uint32_t bin = 0;
  double cost = std::numeric_limits<double>::infinity();
};

class SahBuilder {
 public:
  SahBuilder(std::span<SahBox> boxes, const Execution& execution)
      : boxes_(boxes), execution_(execution) {
    double sum = 0.0;
    double bounded = 0.0;
    for (const SahBox& box : boxes) {
      const SahExtent extent = extent_of(box);
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
    divide_in_parallel(
        all, kSahWorthSharing, execution_, [this](SahJob& job) { return split(job); },
        [this](const SahJob& job) { finish(job); });
  }

 private:
  void finish(SahJob job) const {
    while (job.size() > kBlockRows) finish(split(job));
  }

  /// The first side remains in `job`; returns the second.
  SahJob split(SahJob& job) const {
    while (job.subtrees() == 1) --job.level;
    const std::span<SahBox> boxes = boxes_.subspan(job.begin, job.size());
    const SahBins bins(boxes);
    const SahCut cut = best_cut(job, boxes, bins);
    move_to_front(boxes, bins, cut);
    SahJob second = job;
    second.begin = job.end = job.begin + cut.count;
    return second;
  }

  /// Moves the boxes before the cut to the front. Compares only the boxes of the bin that contains
  /// the cut.
  static void move_to_front(std::span<SahBox> boxes, const SahBins& bins, const SahCut& cut) {
    const auto first_of = [&](std::span<SahBox> some, std::uint32_t first_bins) {
      return part(some,
                  [&](const SahBox& box) { return bins.is_within(box, cut.axis, first_bins); });
    };
    const std::size_t before = first_of(boxes, cut.bin);
    if (before == cut.count) return;
    const std::span<SahBox> rest = boxes.subspan(before);
    const std::span<SahBox> within = rest.first(first_of(rest, cut.bin + 1));
    const auto at = within.begin() + static_cast<std::ptrdiff_t>(cut.count - before);
    std::nth_element(within.begin(), at, within.end(), [&](const SahBox& a, const SahBox& b) {
      const float x = key_on(a, cut.axis);
      const float y = key_on(b, cut.axis);
      return x != y ? x < y : a.row < b.row;
    });
  }

  /// Moves the boxes for which first(box) is true to the front and returns their number.
  /// Branchless, because the result is unpredictable: each box is swapped with the first box behind
  /// the front, or with itself.
  template <typename First>
  static std::size_t part(std::span<SahBox> boxes, First&& first) {
    std::size_t found = 0;
    for (SahBox& box : boxes) {
      const bool is_first = first(box);
      const BoxInRegisters own(box);
      BoxInRegisters(boxes[found]).put(box);
      own.put(boxes[found]);
      found += is_first ? 1 : 0;
    }
    return found;
  }

  /// Contents of the bins.
  struct BinContents {
    std::array<std::array<SahExtent, kBins>, kAxes> extent;
    std::array<std::array<std::uint32_t, kBins>, kAxes> count;
  };

  template <std::size_t Axes>
  static void fill(std::span<const SahBox> boxes, const SahBins& bins, BinContents& in) {
    for (const SahBox& box : boxes) {
      const QuadInts bin = bins.of<Axes>(box);
      const SahExtent extent = extent_of(box);
      for (std::size_t axis = 0; axis < Axes; ++axis) {
        const auto b = static_cast<std::size_t>(bin[axis]);
        in.extent[axis][b].add(extent);
        ++in.count[axis][b];
      }
    }
  }

  [[nodiscard]] SahCut best_cut(const SahJob& job, std::span<const SahBox> boxes,
                                const SahBins& bins) const {
    BinContents in;
    for (std::size_t axis = 0; axis < bins.axes; ++axis) {
      std::fill_n(in.extent[axis].begin(), bins.count, SahExtent::none());
      std::fill_n(in.count[axis].begin(), bins.count, 0U);
    }
    if (bins.axes == kAxes) {
      fill<kAxes>(boxes, bins, in);
    } else {
      fill<3>(boxes, bins, in);
    }
    SahCut best;
    for (std::size_t axis = 0; axis < bins.axes; ++axis) {
      if (in.count[axis][0] != job.size()) consider_axis(job, in, bins.count, axis, best);
    }
    if (best.count == 0) best = {.axis = 0, .count = job.middle(), .bin = 0, .cost = 0.0};
    return best;
  }

  /// Replaces `best` by the best cut on an axis if that is better. If a cut is within a bin, both
  /// sides are assumed to extend through the whole bin.
  void consider_axis(const SahJob& job, const BinContents& in, std::uint32_t bins, std::size_t axis,
                     SahCut& best) const {
    std::array<SahExtent, kBins + 1> from;  // around the bins from each one on
    from[bins] = SahExtent::none();
    for (std::size_t b = bins; b-- > 0;) {
      from[b] = from[b + 1];
      from[b].add(in.extent[axis][b]);
    }
    SahExtent first = SahExtent::none();
    std::uint32_t before = 0;
    std::uint32_t cut = job.places();
    for (std::uint32_t b = 0; b < bins; ++b) {
      first.add(in.extent[axis][b]);
      before += in.count[axis][b];
      for (; cut <= before && cut < job.size(); cut += job.places()) {
        const std::uint32_t behind = cut == before ? b + 1 : b;
        // The cost of a side counts the test of the side itself and of its subtrees.
        const auto weight = [&](std::uint32_t boxes) {
          return 1.0 + static_cast<double>(boxes) / job.places();
        };
        const double cost = first.cost(margin_) * weight(cut) +
                            from[behind].cost(margin_) * weight(job.size() - cut);
        if (cost < best.cost) best = {axis, cut, behind, cost};
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
  const std::size_t at = order.size();
  if (!scratch.resize(count) || !order.resize(at + count)) return false;
  if (count == 0) return true;
  for_each_range(execution, count, kBoxesPerRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      SahBox& box = scratch[i];
      for (std::size_t a = 0; a < 3; ++a) {
        box.low[a] = pool.column(a)[rows[i]];
        box.high[a] = pool.column(3 + a)[rows[i]];
      }
      box.row = rows[i];
    }
  });
  SahBuilder({scratch.data(), count}, execution).run();
  for_each_range(execution, count, kBoxesPerRange, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) order[at + i] = scratch[i].row;
    // Sorts the rows of a block, so that their order does not depend on the partitioning.
    for (std::size_t i = begin; i < end; i += kBlockRows) {
      std::sort(order.data() + at + i, order.data() + at + std::min(end, i + kBlockRows));
    }
  });
  return true;
}

}  // namespace winnow
