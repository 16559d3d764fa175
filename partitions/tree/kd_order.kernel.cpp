// Kernels of k-d cuts: a set is cut by counting its points in bins and comparing only the points of
// the bin that contains the cut.

#include "partitions/tree/kd_order.kernel.h"
#include "partitions/tree/axis_extent.wide.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/float_to_uint.h"
#include "simd/lanes/load_partial.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);
constexpr std::uint32_t kMaxBins = 256;
constexpr std::size_t kFewToRank = 2 * kStep;

Mask16 lanes_of(std::size_t left) {
  return left < kStep ? lanes_below(static_cast<unsigned>(left)) : kAllRows;
}

/// Equal bins over a set of points on one axis.
struct Bins {
  float half_low;
  float scale;
  std::uint32_t count;

  Bins(const AxisExtent& reach, std::size_t points) : half_low(0.5F * reach.low), count(kMaxBins) {
    while (4 * count > points && count > kStep) count /= 2;
    scale = reach.half() > kMinExtent ? static_cast<float>(count) / reach.half() : 0.0F;
  }
  /// Returns a number in [0, count]; its integer part is the bin, and the last bin includes its
  /// upper end.
  [[nodiscard]] Floats place(const Floats& x) const { return (0.5F * x - half_low) * scale; }
};

/// The number of points of a set in each bin.
struct BinSizes {
  std::uint32_t size[2][kMaxBins];  // of even and odd lanes, so that increments are independent

  BinSizes(const Bins& bins, const float* x, std::size_t count) {
    for (std::uint32_t b = 0; b < bins.count; ++b) size[0][b] = size[1][b] = 0;
    const std::uint32_t last = bins.count - 1;
    alignas(64) std::uint32_t bin[kLanes];
    for (std::size_t i = 0; i < count; i += kStep) {
      const std::size_t here = count - i < kStep ? count - i : kStep;
      float_to_uint(bins.place(load_partial(x + i, here))).store(bin);
      for (std::size_t lane = 0; lane < here; ++lane) {
        ++size[lane & 1U][bin[lane] < last ? bin[lane] : last];
      }
    }
  }
  [[nodiscard]] std::size_t of(std::uint32_t bin) const {
    return std::size_t{size[0][bin]} + size[1][bin];
  }
};

/// Columns of a set, or its room, to which points are appended.
struct SplitColumns {
  float* at[3];
  std::uint32_t* row;
  std::size_t next;
  std::size_t end;
};

/// Sixteen points of a set, or fewer at its end.
struct Points16 {
  Floats at[3];
  Uints row;

  Points16(const KdSet& set, std::size_t i, std::size_t left)
      : row(load_partial(set.row + i, left)) {
    for (int a = 0; a < 3; ++a) at[a] = load_partial(set.at[a] + i, left);
  }
  /// Appends the points of a mask. Writes whole registers, but never beyond `to.end`.
  void write(Mask16 mask, SplitColumns& to) const {
    if (to.next + kStep <= to.end) {
      for (int a = 0; a < 3; ++a) compress_store(mask, at[a], to.at[a] + to.next);
      to.next += compress_store(mask, row, to.row + to.next);
      return;
    }
    alignas(64) float place[3][kLanes];
    alignas(64) std::uint32_t own[kLanes];
    for (int a = 0; a < 3; ++a) at[a].store(place[a]);
    row.store(own);
    for (; mask != 0; mask &= mask - 1) {
      const unsigned lane = first(mask);
      for (int a = 0; a < 3; ++a) to.at[a][to.next] = place[a][lane];
      to.row[to.next++] = own[lane];
    }
  }
};

void copy_back(const KdSet& set, std::size_t begin, std::size_t end) {
  const std::size_t points = end - begin;
  for (int a = 0; a < 3; ++a) {
    __builtin_memcpy(set.at[a] + begin, set.at_room[a] + begin, points * sizeof(float));
  }
  __builtin_memcpy(set.row + begin, set.row_room + begin, points * sizeof(std::uint32_t));
}

/// Moves the points of [begin, end) below a bin to the front, points of the bin to `first`, and
/// points above it to `last`, stably.
void part(const KdSet& set, int axis, const Bins& bins, std::uint32_t bin, std::size_t begin,
          std::size_t first, std::size_t last, std::size_t end) {
  const Floats from = Floats(static_cast<float>(bin));
  // The last bin is unbounded.
  const Floats to = Floats(bin + 1 < bins.count ? static_cast<float>(bin + 1) : __builtin_inff());
  // Points are read before their places are overwritten.
  SplitColumns below{{set.at[0], set.at[1], set.at[2]}, set.row, begin, end};
  SplitColumns within{{set.at_room[0], set.at_room[1], set.at_room[2]}, set.row_room, first, last};
  SplitColumns above = within;
  above.next = last;
  above.end = end;
  for (std::size_t i = begin; i < end; i += kStep) {
    const Points16 points(set, i, end - i);
    const Floats place = bins.place(points.at[axis]);
    const Mask16 lanes = lanes_of(end - i);
    const Mask16 not_below = bits(from <= place) & lanes;
    const Mask16 not_within = bits(to <= place) & lanes;
    points.write(lanes & ~not_below, below);
    if (not_below != not_within) points.write(not_below & ~not_within, within);
    points.write(not_within, above);
  }
  copy_back(set, first, end);
}

/// Sorts up to 32 points on an axis, stably: counts for each point how many precede it, in
/// branchless loops.
void rank(const KdSet& set, int axis, std::size_t begin, std::size_t end) {
  const std::size_t points = end - begin;
  alignas(64) float key[kFewToRank];
  for (std::size_t i = 0; i < kFewToRank; ++i) {
    key[i] = i < points ? set.at[axis][begin + i] : __builtin_inff();
  }
  const Floats low = Floats::load(key);
  const Floats high = Floats::load(key + kStep);
  for (std::size_t i = 0; i < points; ++i) {
    const Floats own = Floats(key[i]);
    const Mask16 before = bits(low < own) | bits(high < own) << kLanes;
    const Mask16 beside = bits(low == own) | bits(high == own) << kLanes;
    const std::size_t to = begin + count(before | (beside & ((1U << i) - 1U)));
    for (int a = 0; a < 3; ++a) set.at_room[a][to] = set.at[a][begin + i];
    set.row_room[to] = set.row[begin + i];
  }
  copy_back(set, begin, end);
}

/// Moves the first `cut` points on an axis to the front. Counts points in bins, and repeats with
/// finer bins only for the bin that contains the cut.
void select(const KdSet& set, int axis, AxisExtent reach, std::size_t cut) {
  std::size_t begin = 0;
  std::size_t end = set.count;
  while (end - begin > kFewToRank) {
    const float* const x = set.at[axis];
    const Bins bins(reach, end - begin);
    if (bins.scale == 0.0F) return;
    const BinSizes sizes(bins, x + begin, end - begin);
    std::uint32_t bin = 0;
    std::size_t first = begin;
    while (first + sizes.of(bin) < cut) first += sizes.of(bin++);
    const std::size_t last = first + sizes.of(bin);
    part(set, axis, bins, bin, begin, first, last, end);
    if (last == cut) return;
    begin = first;
    end = last;
    reach = AxisExtent::of(x + begin, end - begin);
  }
  rank(set, axis, begin, end);
}

/// The number of points on the first side: half of the subtrees, all full.
std::size_t cut_of(std::size_t count) {
  std::size_t places = kStep;
  while (16 * places < count) places *= 16;
  return ((count + places - 1) / places + 1) / 2 * places;
}

KdSet split(KdSet& set) {
  int axis = 0;
  AxisExtent widest = AxisExtent::of(set.at[0], set.count);
  for (int a = 1; a < 3; ++a) {
    const AxisExtent reach = AxisExtent::of(set.at[a], set.count);
    if (!(reach.half() > widest.half())) continue;
    widest = reach;
    axis = a;
  }
  const std::size_t cut = cut_of(set.count);
  select(set, axis, widest, cut);
  KdSet second = set;
  for (int a = 0; a < 3; ++a) {
    second.at[a] += cut;
    second.at_room[a] += cut;
  }
  second.row += cut;
  second.row_room += cut;
  second.count -= cut;
  set.count = cut;
  return second;
}

void finish(KdSet set) {
  while (set.count > kStep) finish(split(set));
}

void centres(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
             std::size_t end, float* const* at) {
  std::size_t i = begin;
  for (; i + kStep <= end; i += kStep) {
    const std::uint32_t row = rows[i];
    std::uint32_t apart = 0;
    for (std::uint32_t k = 0; k < kLanes; ++k) apart |= rows[i + k] ^ (row + k);
    // The rows are usually consecutive.
    if (apart == 0) {
      for (int a = 0; a < 3; ++a) {
        const Floats low = Floats::load_unaligned(boxes[a] + row);
        const Floats high = Floats::load_unaligned(boxes[3 + a] + row);
        (0.5F * low + 0.5F * high).store_unaligned(at[a] + i);
      }
      continue;
    }
    for (std::size_t k = i; k < i + kStep; ++k) {
      for (int a = 0; a < 3; ++a) {
        at[a][k] = 0.5F * boxes[a][rows[k]] + 0.5F * boxes[3 + a][rows[k]];
      }
    }
  }
  for (; i < end; ++i) {
    for (int a = 0; a < 3; ++a) at[a][i] = 0.5F * boxes[a][rows[i]] + 0.5F * boxes[3 + a][rows[i]];
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const KdOrderKernels WINNOW_KERNEL_TABLE(kd_order_kernels) = {
    WINNOW_ISA_NAME::centres, WINNOW_ISA_NAME::split, WINNOW_ISA_NAME::finish};

}  // namespace winnow
