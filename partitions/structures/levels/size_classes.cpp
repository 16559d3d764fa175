// Decides which sizes of objects share a level of HierarchicalGrid: starts with one level per
// octave and joins neighbouring levels while this lowers the estimated cost of all pairs.

#include "partitions/structures/levels/size_classes.h"

#include "core/sort/parallel_ranges.h"
#include "partitions/structures/roots.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

// Cost of a line and of a level, in tests of 16 volumes.
constexpr double kPerLine = 0.7;
constexpr double kPerLevel = 7.0;
// One object in kSampled, within the limits below, is sampled for the positions of a class.
constexpr std::size_t kSampled = 8;
constexpr std::size_t kMinSampled = 256;
constexpr std::size_t kMaxSampled = 4096;
// The maximum number of ranges of rows, which threads process.
constexpr std::size_t kMaxSizeRanges = 16;

std::size_t range_length(std::size_t rows) noexcept {
  constexpr std::size_t kMinRows = 8192;
  return even_range_length(rows, kMinRows, kMaxSizeRanges);
}

// Returns, for each axis, the length of a range such that n objects spread evenly over the range
// have this sum of positions and this sum of squared positions.
std::array<double, 3> spread_of(const std::array<double, 3>& sum,
                                const std::array<double, 3>& square, double n) {
  std::array<double, 3> range{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double mean = sum[a] / n;
    range[a] = std::sqrt(12.0 * std::max(0.0, square[a] / n - mean * mean));
  }
  return range;
}

}  // namespace

double edge_for(double target, double count, const std::array<double, 3>& range) noexcept {
  std::array<double, 3> sorted = range;
  std::sort(sorted.begin(), sorted.end());
  std::array<double, 4> factor{target / count};
  for (std::size_t a = 0; a < 3; ++a) factor[3 - a] = std::max(sorted[a], DBL_MIN);
  for (unsigned a = 0; a < 3; ++a) {
    const unsigned axes = 3 - a;
    const double edge = root_of_product(axes, std::span(factor).first(axes + 1));
    if (edge <= sorted[a] || a == 2) return edge;
  }
  return 0.0;
}

/// Sums over sampled objects of a class.
struct SizeClasses::ClassSample {
  std::size_t count;
  std::array<double, 3> edge;
  std::array<double, 3> place;
  std::array<double, 3> square;

  void add(const BoundsPool& pool, std::size_t row) noexcept {
    ++count;
    for (std::size_t a = 0; a < 3; ++a) {
      const double low = static_cast<double>(pool.column(a)[row]);
      edge[a] += static_cast<double>(pool.column(3 + a)[row]) - low;
      place[a] += low;
      square[a] += low * low;
    }
  }
  void add(const ClassSample& other) noexcept {
    count += other.count;
    for (std::size_t a = 0; a < 3; ++a) {
      edge[a] += other.edge[a];
      place[a] += other.place[a];
      square[a] += other.square[a];
    }
  }
};

/// Adjacent classes that share a level.
struct SizeClasses::ClassGroup {
  std::size_t first = 0;
  std::size_t last = 0;
  double count = 0.0;
  std::array<double, 3> mean{};
  std::array<double, 3> longest{};
  std::array<double, 3> range{};
  std::array<double, 3> block{};  ///< extent of 16 rows
};

SizeClasses::SizeClasses(const BoundsPool& pool, std::span<const std::uint32_t> octave,
                         const Execution& execution) noexcept {
  // A histogram for each row number modulo 4, so that successive increments are independent.
  using Quarters = std::array<std::array<std::uint32_t, kOctaves>, 4>;
  // Only entries of existing ranges of rows are initialized.
  std::array<Quarters, kMaxSizeRanges> part;
  const std::size_t length = range_length(octave.size());
  for_each_range(execution, octave.size(), length, [&](std::size_t begin, std::size_t end) {
    Quarters& quarter = part[begin / length];
    quarter = {};
    for (std::size_t row = begin; row < end; ++row) ++quarter[row % 4][octave[row]];
  });
  OctaveCounts count{};
  for (std::size_t p = 0; p * length < octave.size(); ++p) {
    for (const auto& quarter : part[p]) {
      for (std::size_t o = 0; o < kNoOctave; ++o) count[o] += quarter[o];
    }
  }
  choose_octaves(count);
  for (std::size_t o = 0; o < kOctaves; ++o) {
    if (class_of(o) == kClasses) continue;
    class_[class_of(o)].count += count[o];
    objects_ += count[o];
  }
  measure(pool, octave, execution);
  join();
}

// Samples one object in kSampled of every class, but at least kMinSampled and at most kMaxSampled.
// The result does not depend on the number of threads.
void SizeClasses::measure(const BoundsPool& pool, std::span<const std::uint32_t> octave,
                          const Execution& execution) noexcept {
  std::array<std::uint8_t, kOctaves> class_at{};
  std::array<std::size_t, kClasses + 1> step{};
  for (std::size_t o = 0; o < kOctaves; ++o) class_at[o] = static_cast<std::uint8_t>(class_of(o));
  for (std::size_t c = 0; c < kClasses; ++c) {
    const std::size_t count = class_[c].count;
    step[c] = 1 + count / std::clamp(count / kSampled, kMinSampled, kMaxSampled);
  }
  // The only class, if all objects are of one class.
  const auto has_objects = [](const SizeClass& c) { return c.count != 0; };
  const auto only =
      static_cast<std::size_t>(std::ranges::find_if(class_, has_objects) - class_.begin());
  const bool one_class = std::ranges::count_if(class_, has_objects) == 1;
  std::array<std::array<ClassSample, kClasses>, kMaxSizeRanges> part;
  const std::size_t length = range_length(octave.size());
  for_each_range(execution, octave.size(), length, [&](std::size_t begin, std::size_t end) {
    part[begin / length] = {};
    if (one_class) {
      // As the loop below, without a dependency between successive rows.
      std::size_t wait = 0;
      for (std::size_t row = begin; row < end; ++row) {
        if (class_at[octave[row]] != only || wait-- != 0) continue;
        wait = step[only] - 1;
        part[begin / length][only].add(pool, row);
      }
      return;
    }
    std::array<std::size_t, kClasses + 1> wait{};
    wait[kClasses] = octave.size();
    for (std::size_t row = begin; row < end; ++row) {
      const std::size_t own = class_at[octave[row]];
      if (wait[own]-- != 0) continue;
      wait[own] = step[own] - 1;
      part[begin / length][own].add(pool, row);
    }
  });
  for (std::size_t own = 0; own < kClasses; ++own) {
    SizeClass& c = class_[own];
    ClassSample taken{};
    for (std::size_t p = 0; p * length < octave.size(); ++p) taken.add(part[p][own]);
    const double all = static_cast<double>(c.count);
    const double each = static_cast<double>(std::max<std::size_t>(1, taken.count));
    for (std::size_t a = 0; a < 3; ++a) {
      c.edge[a] = taken.edge[a] / each;
      c.place[a] = taken.place[a] * all / each;
      c.square[a] = taken.square[a] * all / each;
    }
    c.range = spread_of(c.place, c.square, std::max(1.0, all));
  }
}

// If sizes span more octaves than there are classes, chooses the octaves with the most objects.
void SizeClasses::choose_octaves(const OctaveCounts& count) noexcept {
  std::size_t inside = 0;
  std::size_t most = 0;
  for (std::size_t top = 1; top < count.size(); ++top) {
    inside += count[top];
    if (top > kClasses) inside -= count[top - kClasses];
    if (inside < most) continue;
    most = inside;
    if (count[top] != 0 || most == 0) top_octave_ = top;
  }
}

std::size_t SizeClasses::class_of(std::size_t octave) const noexcept {
  if (octave == 0) return kClasses - 1;
  if (octave == kNoOctave || octave > top_octave_) return kClasses;
  return std::min(top_octave_ - octave, kClasses);
}

std::size_t SizeClasses::level_of(std::uint32_t octave) const noexcept {
  const std::size_t size_class = class_of(octave);
  return size_class < kClasses ? level_[size_class] : levels_;
}

SizeClasses::ClassGroup SizeClasses::group_of(std::size_t first, std::size_t last) const noexcept {
  ClassGroup group;
  group.first = first;
  group.last = last;
  std::array<double, 3> place{};
  std::array<double, 3> square{};
  for (std::size_t c = first; c <= last; ++c) {
    const double count = static_cast<double>(class_[c].count);
    group.count += count;
    for (std::size_t a = 0; a < 3; ++a) {
      group.mean[a] += count * class_[c].edge[a];
      place[a] += class_[c].place[a];
      square[a] += class_[c].square[a];
      // The longest edge in an octave is about 1.4 times the mean.
      group.longest[a] = std::max(group.longest[a], 1.4 * class_[c].edge[a]);
    }
  }
  for (double& edge : group.mean) edge /= std::max(1.0, group.count);
  group.range = spread_of(place, square, std::max(1.0, group.count));
  const double edge = edge_for(kRowsOfBlock, std::max(1.0, group.count), group.range);
  for (std::size_t a = 0; a < 3; ++a) group.block[a] = std::min(edge, group.range[a]);
  return group;
}

// Estimates the cost of searching partners for blocks of `fine` in `coarse`, in tests of 16
// volumes.
double SizeClasses::cost(const ClassGroup& fine, const ClassGroup& coarse) const noexcept {
  std::array<double, 3> query_extent{};
  for (std::size_t a = 0; a < 3; ++a) {
    query_extent[a] = fine.block[a] + 0.95 * fine.mean[a] + 0.2 * fine.longest[a];
  }
  const auto share = [&](const SizeClass& c, std::size_t a) {
    const double whole = c.range[a] + c.edge[a];
    return whole > 0.0 ? std::min(1.0, (query_extent[a] + c.edge[a]) / whole) : 1.0;
  };
  double rows = 0.0;
  for (std::size_t c = coarse.first; c <= coarse.last; ++c) {
    if (class_[c].count == 0) continue;
    double part = static_cast<double>(class_[c].count);
    for (std::size_t a = 0; a < 3; ++a) part *= share(class_[c], a);
    rows += part;
  }
  std::array<double, 3> cells{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double width = std::max(coarse.block[a], DBL_MIN);
    const double reach = (1.0 + 2.0 * kSlackOfEdge) * coarse.longest[a];
    cells[a] = std::min(coarse.range[a] / width + 1.0, (query_extent[a] + reach) / width + 1.0);
  }
  std::sort(cells.begin(), cells.end());
  const double lines = cells[0] * cells[1];
  const double in_line = std::min(coarse.count, kRowsOfBlock * cells[2]);
  double blocks = lines * (in_line / kRowsOfBlock + 0.5);
  if (fine.first == coarse.first) {
    rows = 0.5 * rows + 8.0;
    blocks *= 0.5;
  }
  return fine.count / kRowsOfBlock * (rows + blocks + kPerLine * lines + kPerLevel);
}

// Starts with one level per class and joins neighbouring levels while this lowers the cost.
void SizeClasses::join() noexcept {
  std::array<ClassGroup, kClasses> group;
  std::size_t count = 0;
  for (std::size_t c = kClasses; c-- > 0;) {
    if (class_[c].count != 0) group[count++] = group_of(c, c);
  }
  while (count > 1) {
    double best = std::numeric_limits<double>::infinity();
    std::size_t where = 0;
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const ClassGroup joined = group_of(group[k + 1].first, group[k].last);
      double change = cost(joined, joined) - cost(group[k], group[k]) -
                      cost(group[k + 1], group[k + 1]) - cost(group[k], group[k + 1]);
      for (std::size_t j = 0; j < k; ++j) {
        change += cost(group[j], joined) - cost(group[j], group[k]) - cost(group[j], group[k + 1]);
      }
      for (std::size_t j = k + 2; j < count; ++j) {
        change += cost(joined, group[j]) - cost(group[k], group[j]) - cost(group[k + 1], group[j]);
      }
      if (change < best) {
        best = change;
        where = k;
      }
    }
    if (!(best < 0.0) && count <= kMaxLevels) break;
    group[where] = group_of(group[where + 1].first, group[where].last);
    std::copy(group.begin() + static_cast<std::ptrdiff_t>(where) + 2,
              group.begin() + static_cast<std::ptrdiff_t>(count),
              group.begin() + static_cast<std::ptrdiff_t>(where) + 1);
    --count;
  }
  levels_ = count;
  for (std::size_t l = 0; l < count; ++l) {
    for (std::size_t c = group[l].first; c <= group[l].last; ++c) {
      level_[c] = static_cast<std::uint8_t>(l);
    }
  }
}

}  // namespace winnow
