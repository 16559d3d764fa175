#include "partitions/tree/morton_order.h"

#include "core/sort/radix_sort.h"
#include "partitions/tree/hilbert_curve.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;
// Longer runs of equal codes are worth sorting again.
constexpr std::size_t kLongRun = 48;
// Edges from here on count as unbounded: one class, and no say in what is normal.
constexpr float kUnbounded = 1e30F;
constexpr int kClasses = 16;

struct Columns {
  const float* low[3];
  const float* high[3];

  explicit Columns(const BoundsPool& pool) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = pool.column(axis);
      high[axis] = pool.column(3 + axis);
    }
  }
  // Halved first: the sum of two large ends would overflow.
  [[nodiscard]] float center(int axis, std::size_t row) const {
    return 0.5F * low[axis][row] + 0.5F * high[axis][row];
  }
  [[nodiscard]] float edge(int axis, std::size_t row) const {
    return high[axis][row] - low[axis][row];
  }
  [[nodiscard]] float longest_edge(std::size_t row) const {
    return std::max({edge(0, row), edge(1, row), edge(2, row)});
  }
};

/// What the rows of a run are like.
struct Extent {
  std::array<float, 3> low;
  std::array<float, 3> high;
  std::array<double, 3> edge_sum{};
  float longest = 0.0F;
  float shortest = std::numeric_limits<float>::infinity();

  Extent() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const Columns& boxes, std::size_t row) {
    const float longest_edge = boxes.longest_edge(row);
    const bool bounded = longest_edge < kUnbounded;
    if (bounded) {
      longest = std::max(longest, longest_edge);
      shortest = std::min(shortest, longest_edge);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const float c = boxes.center(axis, row);
      low[a] = std::min(low[a], c);
      high[a] = std::max(high[a], c);
      if (bounded) edge_sum[a] += static_cast<double>(boxes.edge(axis, row));
    }
  }
  void merge(const Extent& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], other.low[a]);
      high[a] = std::max(high[a], other.high[a]);
      edge_sum[a] += other.edge_sum[a];
    }
    longest = std::max(longest, other.longest);
    shortest = std::min(shortest, other.shortest);
  }
  [[nodiscard]] double range(std::size_t a) const {
    return static_cast<double>(high[a]) - static_cast<double>(low[a]);
  }
};

/// Maps rows to codes: size class, then the bits of the quantised centre. Each bit, from the most
/// significant on, halves the axis on which a cell is longest in units of the mean edge, so flat
/// worlds spend no bits on their flat axis and rods get long cells. Where bits halve three (or two)
/// axes in turn they follow Hilbert's curve: blocks of rows along it have a third less surface than
/// along Morton's.
class Coder {
 public:
  Coder(const Extent& extent, std::size_t count, unsigned total_bits) {
    if (extent.longest > 4.0F * extent.shortest || extent.longest == 0.0F) {
      top_exponent_ = exponent(extent.longest);
      const int classes = 1 + class_of(extent.longest) - class_of(extent.shortest);
      class_bits_ = static_cast<unsigned>(std::bit_width(static_cast<unsigned>(classes)));
      lowest_class_ = class_of(extent.shortest);
    }
    choose_axes(extent, count, total_bits - class_bits_);
  }

  [[nodiscard]] unsigned bits() const { return class_bits_ + axis_bits_; }

  [[nodiscard]] std::uint32_t code(const Columns& boxes, std::size_t row) const {
    std::uint32_t result = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double at = (static_cast<double>(boxes.center(axis, row)) - origin_[a]) * scale_[a];
      const auto cell = std::min(static_cast<std::uint32_t>(at), last_cell_[a]);
      result |= spread_[a][0][cell & 0xFFU] | spread_[a][1][cell >> 8U];
    }
    result = along_curve(result);
    if (class_bits_ == 0) return result;
    const auto size_class =
        static_cast<std::uint32_t>(class_of(boxes.longest_edge(row)) - lowest_class_);
    return result | size_class << axis_bits_;
  }

 private:
  /// Bits of the code that halve different axes, one after another: a level of a curve.
  struct Level {
    const std::uint8_t* step;          ///< of a HilbertCurve
    std::array<std::uint8_t, 8> cell;  ///< of the bits' value
    std::uint8_t axes;
    std::uint8_t shift;
    bool first;  ///< a curve begins here
  };

  /// Leaves out where the order would jump: what Morton's curve does at every other cell.
  [[nodiscard]] std::uint32_t along_curve(std::uint32_t code) const {
    unsigned state = 0;
    for (std::size_t i = 0; i < levels_; ++i) {
      const Level& level = level_[i];
      const unsigned mask = (1U << level.axes) - 1U;
      const std::uint8_t cell = level.cell[code >> level.shift & mask];
      if (level.first) state = 0;
      const std::uint8_t step = level.step[state << level.axes | cell];
      code = (code & ~(mask << level.shift)) | (step & mask) << level.shift;
      state = step >> level.axes;
    }
    return code;
  }

  /// Groups the bits of the code, from the most significant on, into levels of three or two axes.
  void find_levels(const std::array<std::uint8_t, 32>& axis_of) {
    static constexpr HilbertCurve<2> kSquare;
    static constexpr HilbertCurve<3> kCube;
    unsigned k = 0;
    while (k + 1 < axis_bits_) {
      const auto* a = axis_of.data() + k;
      const bool square = a[0] != a[1];
      const bool cube = square && k + 2 < axis_bits_ && a[2] != a[0] && a[2] != a[1];
      if (!square) {
        ++k;
        continue;
      }
      Level level;
      level.axes = cube ? 3 : 2;
      level.step = cube ? kCube.step.data() : kSquare.step.data();
      level.shift = static_cast<std::uint8_t>(axis_bits_ - k - level.axes);
      for (unsigned value = 0; value < 1U << level.axes; ++value) {
        unsigned cell = 0;
        for (unsigned i = 0; i < level.axes; ++i) {
          // In a square the two axes are told apart by their order alone.
          const unsigned axis = cube ? a[i] : static_cast<unsigned>(a[i] > a[1 - i]);
          cell |= (value >> (level.axes - 1U - i) & 1U) << axis;
        }
        level.cell[value] = static_cast<std::uint8_t>(cell);
      }
      level.first = levels_ == 0 || level_[levels_ - 1].axes != level.axes ||
                    level_[levels_ - 1].shift != level.shift + level.axes;
      level_[levels_++] = level;
      k += level.axes;
    }
  }

  static int exponent(float edge) { return edge > 0.0F ? std::ilogb(edge) : -150; }

  [[nodiscard]] int class_of(float edge) const {
    if (!(edge < kUnbounded)) return kClasses;
    return std::max(0, kClasses - 1 - (top_exponent_ - exponent(edge)) / 2);
  }

  void choose_axes(const Extent& extent, std::size_t count, unsigned bits) {
    std::array<double, 3> cell{};
    std::array<unsigned, 3> used{};
    const double mean_edge = (extent.edge_sum[0] + extent.edge_sum[1] + extent.edge_sum[2]) / 3.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double unit = extent.edge_sum[a] + 0.05 * mean_edge;
      const double n = static_cast<double>(count);
      cell[a] = mean_edge > 0.0 ? extent.range(a) / (unit / n) : extent.range(a);
    }
    std::array<std::uint8_t, 32> axis_of{};
    for (unsigned k = 0; k < bits; ++k) {
      std::size_t best = 3;
      for (std::size_t a = 0; a < 3; ++a) {
        if (cell[a] > 0.0 && used[a] < 16 && (best == 3 || cell[a] > cell[best])) best = a;
      }
      if (best == 3) break;
      axis_of[axis_bits_++] = static_cast<std::uint8_t>(best);
      ++used[best];
      cell[best] *= 0.5;
    }
    for (std::size_t a = 0; a < 3; ++a) {
      origin_[a] = static_cast<double>(extent.low[a]);
      const double cells = static_cast<double>(1U << used[a]);
      scale_[a] = extent.range(a) > 0.0 ? cells / extent.range(a) : 0.0;
      if (!std::isfinite(scale_[a])) scale_[a] = std::numeric_limits<double>::max();
      last_cell_[a] = (1U << used[a]) - 1U;
      fill_spread(a, axis_of);
    }
    find_levels(axis_of);
  }

  // The code's bits for each value of the low and high byte of a cell number.
  void fill_spread(std::size_t a, const std::array<std::uint8_t, 32>& axis_of) {
    std::array<std::uint32_t, 16> place{};
    unsigned bit = 0;
    for (unsigned k = axis_bits_; k-- > 0;) {
      if (axis_of[k] == a) place[bit++] = 1U << (axis_bits_ - 1 - k);
    }
    for (unsigned half = 0; half < 2; ++half) {
      spread_[a][half][0] = 0;
      for (unsigned value = 1; value < 256; ++value) {
        const auto top = static_cast<unsigned>(std::bit_width(value)) - 1;
        spread_[a][half][value] = spread_[a][half][value & ~(1U << top)] | place[8 * half + top];
      }
    }
  }

  std::array<double, 3> origin_{};
  std::array<double, 3> scale_{};
  std::array<std::uint32_t, 3> last_cell_{};
  std::uint32_t spread_[3][2][256];
  std::array<Level, 16> level_;
  std::size_t levels_ = 0;
  unsigned axis_bits_ = 0;
  unsigned class_bits_ = 0;
  int top_exponent_ = 0;
  int lowest_class_ = 0;
};

struct Sorter {
  const Columns boxes;
  std::uint64_t* items;
  std::uint64_t* spare;
  const Execution& execution;

  [[nodiscard]] static std::uint32_t row_of(std::uint64_t item) {
    return static_cast<std::uint32_t>(item);
  }

  Extent extent_of(std::size_t begin, std::size_t end) const {
    Extent total;
    for (std::size_t i = begin; i < end; ++i) total.add(boxes, row_of(items[i]));
    return total;
  }

  // Bits of the code: two passes of the radix sort tell 4 million cells apart, which is fine enough
  // for leaves of 16 up to about 2^18 objects.
  static unsigned bits_for(std::size_t count) { return count <= (std::size_t{1} << 18U) ? 22 : 32; }

  /// Sorts a run by codes within its own bounds. False if its centres and sizes do not differ.
  bool sort_run(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    const Extent extent = extent_of(begin, end);
    const Coder coder(extent, count, bits_for(count));
    if (coder.bits() == 0) return false;
    const Execution run_execution = count < 2 * kRowsPerTask ? Execution::serial() : execution;
    run_execution.for_each((count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
      const std::size_t last = std::min(end, begin + (task + 1) * kRowsPerTask);
      for (std::size_t i = begin + task * kRowsPerTask; i < last; ++i) {
        const std::uint32_t row = row_of(items[i]);
        items[i] = static_cast<std::uint64_t>(coder.code(boxes, row)) << 32U | row;
      }
    });
    if (count < 1024) {
      std::sort(items + begin, items + end);
      return true;
    }
    const std::uint64_t* sorted =
        radix_sort(items + begin, spare + begin, count, coder.bits(), run_execution);
    if (sorted != items + begin) std::copy_n(sorted, count, items + begin);
    return true;
  }

  /// Every level of the recursion divides the extent of a run, so depth is bounded by the exponent
  /// range of float.
  void sort_all(std::size_t begin, std::size_t end) {
    if (!sort_run(begin, end)) return;
    std::size_t run = begin;
    while (run < end) {
      std::size_t next = run + 1;
      while (next < end && (items[next] >> 32U) == (items[run] >> 32U)) ++next;
      if (next - run > kLongRun && next - run < end - begin) sort_all(run, next);
      run = next;
    }
  }
};

}  // namespace

bool sort_by_morton(const BoundsPool& pool, std::span<std::uint32_t> rows,
                    Column<std::uint64_t>& scratch, const Execution& execution) {
  if (rows.size() < 2) return true;
  if (!scratch.grow(2 * rows.size())) return false;
  Sorter sorter{Columns(pool), scratch.data(), scratch.data() + rows.size(), execution};
  for (std::size_t i = 0; i < rows.size(); ++i) sorter.items[i] = rows[i];
  sorter.sort_all(0, rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = Sorter::row_of(sorter.items[i]);
  return true;
}

}  // namespace winnow
