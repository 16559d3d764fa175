// Lays out the cells of one level of HierarchicalGrid from a sample of its rows.

#include "partitions/structures/levels/level_layout.h"

#include "core/sort/order_statistics.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/structures/roots.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

// How far objects of a level may drift, as a share of a cell, in addition to kSlackOfEdge.
constexpr double kSlackOfCell = 0.1;
// The width of lines in edges of a cube that contains a block of rows.
constexpr double kLineWidth = 0.95;
constexpr double kMinWidth = 0.25;       // in longest edges
constexpr double kMaxLines = 1U << 15U;  // along an axis
constexpr unsigned kMaxStepBits = 20;
constexpr double kStepsInCell = 8.0;

// Returns the index of the i-th sample of one row in `step`, at a hashed offset: rows are in the
// order of earlier cells, and a regular stride could alias with this order.
std::size_t sampled(std::size_t i, std::size_t step) noexcept {
  const std::uint64_t hash = (i + 1) * 0x9E3779B97F4A7C15ULL;
  return i * step + static_cast<std::size_t>((hash >> 32U) % step);
}

struct CoordinateRange {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double length() const { return high - low; }
};

// The range of lower bounds on an axis, from a sample. Outliers must not stretch cells.
template <typename RowOf>
CoordinateRange range_of(const BoundsPool& pool, std::size_t axis, std::size_t count,
                         RowOf&& row_of) {
  constexpr std::size_t kMinSampled = 64;
  constexpr std::size_t kMaxSampled = 512;
  std::array<float, kMaxSampled> low;
  const std::size_t sample_size = std::clamp(count / 8, kMinSampled, kMaxSampled);
  const std::size_t step = std::max<std::size_t>(1, count / sample_size);
  std::size_t n = 0;
  for (std::size_t i = 0; i < count / step && n < kMaxSampled; ++i) {
    const std::size_t row = row_of(sampled(i, step));
    if (pool.ids()[row] != kNoObject) low[n++] = pool.column(axis)[row];
  }
  if (n == 0) return {};
  const std::span<const float> ends(low.data(), n);
  const auto [least, most] = std::ranges::minmax(ends);
  const double first = static_cast<double>(least);
  const double last = static_cast<double>(most);
  const InterquantileRange range(ends);
  return {std::max(first, range.low), std::min(last, range.high)};
}

// Estimates the mean number of objects in the cube of a raster that contains an object, including
// itself. The mean is over objects, so crowded cubes weigh more.
double mean_objects_per_cube(const BoundsPool& pool, std::span<const std::uint32_t> rows,
                             const std::array<CoordinateRange, 3>& range, double edge) {
  constexpr std::size_t kSlots = 16384;
  std::array<std::uint8_t, kSlots> cube{};
  const std::size_t sample_size = std::clamp<std::size_t>(rows.size() / 32, 256, 4096);
  const std::size_t step = std::max<std::size_t>(1, rows.size() / sample_size);
  std::size_t count = 0;
  std::size_t sampled_pairs = 0;
  for (std::size_t i = 0; i < rows.size() / step; ++i) {
    const std::uint32_t row = rows[sampled(i, step)];
    if (pool.ids()[row] == kNoObject) continue;
    ++count;
    std::uint64_t hash = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = static_cast<double>(pool.column(a)[row]) - range[a].low;
      const auto cell = static_cast<std::int64_t>(std::clamp(x / edge, -1e15, 1e15));
      hash = (hash ^ static_cast<std::uint64_t>(cell)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29U;
    }
    std::uint8_t& in = cube[hash % kSlots];
    sampled_pairs += in;
    if (in < 255) ++in;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, count));
  const double by_chance = 0.5 * n * n / static_cast<double>(kSlots);
  const double pairs = std::max(0.0, static_cast<double>(sampled_pairs) - by_chance);
  return 1.0 + 2.0 * pairs / n * static_cast<double>(rows.size()) / n;
}

std::array<float, 3> longest_edges(const BoundsPool& pool, std::span<const std::uint32_t> rows,
                                   const Execution& execution) {
  constexpr std::size_t kMaxRanges = 64;
  const std::size_t length = std::max<std::size_t>(8192, rows.size() / kMaxRanges + 1);
  std::array<std::array<float, 3>, kMaxRanges> part{};
  for_each_range(execution, rows.size(), length, [&](std::size_t begin, std::size_t end) {
    float* const own = part[begin / length].data();
    level_rows_kernels().longest(box_columns(pool).data(), rows.data(), begin, end, own);
  });
  std::array<float, 3> longest{};
  for (const auto& own : part) {
    for (std::size_t a = 0; a < 3; ++a) longest[a] = std::max(longest[a], own[a]);
  }
  return longest;
}

void lay_axis(LevelAxis& axis, const CoordinateRange& range, double cells, double longest,
              double width) {
  const double inverse = cells / range.length();
  // An axis with little extent is not divided.
  if (!(cells > 1.0) || !(inverse < FLT_MAX)) {
    axis.origin = axis.inverse = axis.last = 0.0F;
    axis.limit = std::numeric_limits<float>::infinity();
    axis.slack = axis.pad = kUnboundedEdge;
    return;
  }
  axis.origin = static_cast<float>(range.low);
  axis.inverse = static_cast<float>(inverse);
  axis.last = static_cast<float>(cells - 1.0);
  // A margin for edges that differ by rounding.
  axis.limit = static_cast<float>(1.001 * longest);
  axis.slack = static_cast<float>(kSlackOfEdge * longest + kSlackOfCell * width);
  const double pad = static_cast<double>(axis.limit) + static_cast<double>(axis.slack);
  axis.pad = static_cast<float>(1.000001 * pad);
}

}  // namespace

void lay_level(const BoundsPool& pool, std::span<const std::uint32_t> rows,
               const std::array<float, 3>& least_longest, const Execution& execution,
               GridLevel& level) noexcept {
  std::array<CoordinateRange, 3> range;
  std::array<double, 3> length{};
  std::array<float, 3> longest = longest_edges(pool, rows, execution);
  for (std::size_t a = 0; a < 3; ++a) {
    longest[a] = std::max(longest[a], least_longest[a]);
    range[a] = range_of(pool, a, rows.size(), [&](std::size_t i) { return rows[i]; });
    length[a] = range[a].length();
  }
  double width = edge_for(kRowsOfBlock, static_cast<double>(rows.size()), length);
  // In crowded scenes, makes the cells narrower until the cube of a raster of this width that
  // contains an object has about one block of objects, on average over the objects.
  for (int i = 0; i < 6 && width > 0.0; ++i) {
    const double found = mean_objects_per_cube(pool, rows, range, width);
    if (found < 1.6 * kRowsOfBlock) break;
    width *= root(3, kRowsOfBlock / found);
  }
  width *= kLineWidth;
  std::array<std::uint32_t, 3> by_length{0, 1, 2};
  std::sort(by_length.begin(), by_length.end(), [&](std::uint32_t a, std::uint32_t b) {
    return length[a] > length[b] || (length[a] == length[b] && a < b);
  });
  level.fast.axis = by_length[0];
  level.mid.axis = by_length[1];
  level.slow.axis = by_length[2];
  for (LevelAxis* const axis : {&level.mid, &level.slow}) {
    const std::size_t a = axis->axis;
    // Cells much smaller than the objects would not prune more.
    const double edge = static_cast<double>(longest[a]);
    const double wide = std::max(width, kMinWidth * edge);
    lay_axis(*axis, range[a], std::min(kMaxLines, std::floor(length[a] / wide)), edge, wide);
  }
  level.mids = static_cast<std::uint32_t>(level.mid.last) + 1;
  const double steps = kStepsInCell * length[level.fast.axis] / width;
  unsigned bits = 0;
  while (bits < kMaxStepBits && static_cast<double>(1U << bits) < steps) ++bits;
  lay_axis(level.fast, range[level.fast.axis], bits > 2 ? static_cast<double>(1U << bits) : 1.0,
           static_cast<double>(longest[level.fast.axis]), width);
  level.steps = static_cast<std::uint32_t>(level.fast.last);
}

}  // namespace winnow
