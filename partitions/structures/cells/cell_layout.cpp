// Chooses cells from a sample of the scene: tries several limits for the edges of objects in cells,
// sizes cells for each, and takes the layout with the lowest estimated cost. SweepAndPrune and
// FlatGrid call it when they plan a build.

#include "partitions/structures/cells/cell_layout.h"

#include "core/sort/order_statistics.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/structures/cells/cell_layout.kernel.h"
#include "partitions/structures/roots.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

namespace winnow {

WINNOW_DEFINE_KERNELS(CellLayoutKernels, cell_layout_kernels)

namespace {

constexpr float kUnbounded = 1e30F;
constexpr double kMaxCells = 2048;  // on an axis
constexpr double kMinWidening = 1.02;
constexpr double kTreeQuery = 14.0;  // tests of 16 volumes per object in the tree
constexpr std::size_t kRowsPerRange = 8192;
// The sample has one row in this many, but at least kMinSampled and at most kMaxSampled.
constexpr std::size_t kRowsPerSample = 64;

// Returns the value at index `at` in ascending order. Reorders the values so that lower ones come
// before the index.
float value_at(std::span<float> values, std::size_t at) noexcept {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(at);
  if (at + 1 == values.size()) {
    std::iter_swap(std::max_element(values.begin(), values.end()), place);
  } else {
    std::nth_element(values.begin(), place, values.end());
  }
  return *place;
}

// The range of lower bounds on an axis.
std::ranges::minmax_result<float> ends_of(const BoundsPool& pool, std::size_t axis) noexcept {
  std::ranges::minmax_result<float> ends{kEndless, -kEndless};
  for (std::size_t row = 0; row < pool.rows(); ++row) {
    if (pool.ids()[row] == kNoObject) continue;
    ends.min = std::min(ends.min, pool.column(axis)[row]);
    ends.max = std::max(ends.max, pool.column(axis)[row]);
  }
  return ends;
}

// True if the edges differ by at most 1/32 from the other edges on each axis; their cells would
// then be about the same.
bool is_about(const std::array<float, 3>& edges, const std::array<float, 3>& others) noexcept {
  constexpr float kAbout = 1.0F / 32.0F;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(std::abs(edges[a] - others[a]) <= kAbout * others[a])) return false;
  }
  return true;
}

}  // namespace

SceneSample::SceneSample(const BoundsPool& pool, std::size_t live,
                         const Execution& execution) noexcept
    : objects(live) {
  if (live == 0) return;
  std::array<std::uint32_t, kMaxSampled> rows;
  choose_rows(pool, rows);
  if (count != 0) execution.for_each(3, [&](std::size_t a) { sample_along(a, pool, rows); });
}

void SceneSample::choose_rows(const BoundsPool& pool,
                              std::array<std::uint32_t, kMaxSampled>& rows) noexcept {
  const std::size_t sample_size =
      std::clamp(pool.rows() / kRowsPerSample, kMinSampled, kMaxSampled);
  const std::size_t step = std::max<std::size_t>(1, pool.rows() / sample_size);
  const auto take = [&](std::size_t row) { rows[count++] = static_cast<std::uint32_t>(row); };
  if (pool.rows() <= kMaxSampled) {
    // Select by ids: if a few objects return to former positions they get the same cells again,
    // whatever the order of rows.
    const auto k = static_cast<unsigned>(std::bit_width(step)) - 1;
    for (std::size_t row = 0; row < pool.rows(); ++row) {
      const ObjectId id = pool.ids()[row];
      if (id != kNoObject && (k == 0 || id * 0x9E3779B1U >> (32 - k) == 0)) take(row);
    }
  } else {
    for (std::size_t row = step / 2; row < pool.rows() && count < kMaxSampled; row += step) {
      if (pool.ids()[row] != kNoObject) take(row);
    }
  }
}

void SceneSample::sample_along(std::size_t a, const BoundsPool& pool,
                               const std::array<std::uint32_t, kMaxSampled>& rows) noexcept {
  std::array<float, kMaxSampled> ends{};
  double sum = 0.0;
  std::size_t bounded = 0;
  for (std::size_t i = 0; i < count; ++i) {
    ends[i] = pool.column(a)[rows[i]];
    edge[a][i] = pool.column(3 + a)[rows[i]] - ends[i];
    if (!(edge[a][i] < kUnbounded)) continue;
    sum += static_cast<double>(edge[a][i]);
    ++bounded;
  }
  mean_edge[a] = sum / static_cast<double>(std::max<std::size_t>(1, bounded));
  const std::span<const float> values(ends.data(), count);
  const auto [least, most] =
      pool.rows() <= kMaxSampled ? ends_of(pool, a) : std::ranges::minmax(values);
  // Outliers must not stretch the cells.
  const InterquantileRange range(values);
  low[a] = std::max(least, static_cast<float>(std::max(range.low, -3e38)));
  high[a] = std::min(most, static_cast<float>(std::min(range.high, 3e38)));
}

/// A possible layout and its estimated cost.
struct CellLayout::LayoutTrial {
  std::array<double, 3> reach{};  // by axis
  std::array<double, 3> width{};
  std::array<double, 3> cells{};
  std::array<bool, 3> divided{};
  double small_share = 0.0;
  double cost = std::numeric_limits<double>::infinity();

  // Divides the axes along which the positions range over more than three times the size of an
  // object.
  void divide(const SceneSample& s, const std::array<float, 3>& quantile_edge_of) {
    for (std::size_t a = 0; a < 3; ++a) {
      // A margin for objects outside the sample and for rounding.
      reach[a] = 1.001 * static_cast<double>(quantile_edge_of[a]);
      divided[a] = s.range(a) > 3.0 * reach[a] && s.range(a) > 0.0 && std::isfinite(s.range(a));
    }
  }

  [[nodiscard]] bool is_small(const SceneSample& s, std::size_t i) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const float e = s.edge[a][i];
      if (divided[a] && static_cast<double>(e) > reach[a]) return false;
    }
    return true;
  }

  void size_cells(const SceneSample& s, const CellRequirements& d, std::size_t fast) {
    std::size_t small = 0;
    for (std::size_t i = 0; i < s.count; ++i) small += is_small(s, i);
    small_share = static_cast<double>(small) / static_cast<double>(s.count);
    const double n = std::max(1.0, small_share * static_cast<double>(s.objects));
    double total = 1.0;
    unsigned free_axes = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      cells[a] = 1.0;
      width[a] = 0.0;
      if (!divided[a] || (d.sweep_fast_axis && a == fast)) continue;
      width[a] = std::max(reach[a] * (1.0 + 2.0 * d.slack_share), s.range(a) / kMaxCells);
      if (a != fast) width[a] = std::max(width[a], std::min(s.range(a), block_edge(s, d, n)));
      total *= s.range(a) / width[a];
      ++free_axes;
    }
    if (free_axes == 0) return;
    const double most = d.max_cells(n);
    // If an axis is reduced to one cell, the cells along the other axes must become wider.
    for (double least = 1.0; total > most || least == 1.0; least = kMinWidening) {
      const double widen = total > most ? root(free_axes, total / most) : 1.0;
      total = 1.0;
      for (std::size_t a = 0; a < 3; ++a) {
        if (width[a] == 0.0) continue;
        width[a] *= std::max(widen, least);
        cells[a] = std::max(1.0, std::ceil(s.range(a) / width[a]));
        total *= cells[a];
      }
    }
  }

  // Returns the edge of a cube that contains a block of rows if n objects are evenly spread.
  [[nodiscard]] double block_edge(const SceneSample& s, const CellRequirements& d, double n) const {
    if (d.rows_per_block == 0.0) return 0.0;
    std::array<double, 4> factor{d.rows_per_block / n};
    unsigned axes = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (divided[a]) factor[++axes] = s.range(a);
    }
    return root_of_product(axes, std::span(factor).first(axes + 1));
  }

  // Estimates the cost of one query for all pairs. The unit is one test of a box against 16 boxes.
  void estimate(const SceneSample& s, const CellRequirements& d, std::size_t fast) {
    const double n = small_share * static_cast<double>(s.objects);
    const double total = cells[0] * cells[1] * cells[2];
    const double in_cell = n / total;
    double run = 3.0 * in_cell;
    if (d.sweep_fast_axis) {
      run = in_cell * std::min(1.0, (3.0 * reach[fast]) / std::max(s.range(fast), 1e-30));
    }
    double lines = 0.5;
    double neighbours = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (a != fast && cells[a] > 1.0) neighbours *= 3.0;
    }
    lines += (neighbours - 1.0) / 2.0;
    cost = n * (2.0 + lines * std::max(1.0, run / 16.0));
    for (std::size_t i = 0; i < s.count; ++i) {
      if (is_small(s, i)) continue;
      double visited = 1.0;
      for (std::size_t a = 0; a < 3; ++a) {
        if (a == fast || cells[a] <= 1.0) continue;
        const double edge = static_cast<double>(s.edge[a][i]);
        visited *= std::min(cells[a], (edge + reach[a]) / width[a] + 2.0);
      }
      const double edge = static_cast<double>(s.edge[fast][i]) + reach[fast];
      const double share = std::min(1.0, edge / std::max(s.range(fast), 1e-30));
      const double on_line = n / std::max(1.0, total / cells[fast]) * share;
      cost += static_cast<double>(s.objects) / static_cast<double>(s.count) *
              (kTreeQuery + visited * std::max(1.0, on_line / 16.0));
    }
  }
};

bool CellLayout::choose(const SceneSample& s, const CellRequirements& d) noexcept {
  usable_ = false;
  if (s.objects < kMinInCells || s.count < 8) return true;
  // The axis with the most room in units of the objects' edges prunes best; its cells are
  // consecutive in memory.
  std::size_t fast = 0;
  const auto room = [&](std::size_t a) { return s.range(a) / (s.mean_edge[a] + 1e-30); };
  for (std::size_t a = 1; a < 3; ++a) {
    if (room(a) > room(fast)) fast = a;
  }
  std::array<std::array<float, SceneSample::kMaxSampled>, 3> edges_of = s.edge;
  std::array<float, 3> least{};
  for (std::size_t a = 0; a < 3; ++a) {
    least[a] = *std::min_element(s.edge[a].begin(), s.edge[a].begin() + s.count);
  }
  std::array<float, 3> edges{};
  std::array<float, 3> tried{-1.0F, -1.0F, -1.0F};
  std::size_t behind = s.count;
  LayoutTrial best;
  for (const double quantile : {1.0, 0.99, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.35}) {
    const auto at = static_cast<std::size_t>(quantile * static_cast<double>(s.count - 1));
    for (std::size_t a = 0; a < 3; ++a) edges[a] = value_at({edges_of[a].data(), behind}, at);
    behind = at + 1;
    if (is_about(edges, tried)) continue;
    tried = edges;
    LayoutTrial trial;
    trial.divide(s, edges);
    trial.size_cells(s, d, fast);
    trial.estimate(s, d, fast);
    const bool divides = trial.divided[0] || trial.divided[1] || trial.divided[2];
    if (divides && trial.cost < best.cost) best = trial;
    if (is_about(least, edges)) break;
  }
  if (!(best.cost < kTreeQuery * 8.0 * static_cast<double>(s.objects))) return true;

  axes_[0].axis = static_cast<std::uint32_t>(fast);
  std::uint32_t next = 1;
  for (std::uint32_t a = 0; a < 3; ++a) {
    if (a != fast) axes_[next++].axis = a;
  }
  drift_ = static_cast<float>(std::max(d.slack_share * best.reach[fast],
                                       s.range(fast) / (4.0 * static_cast<double>(s.objects))));
  return lay_edges(best, s);
}

namespace {

/// True if guess_cell(x) always returns a cell that contains x. `guess_cell` is monotonic, so tests
/// beside the bounds of cells suffice.
bool agrees(const CellAxis& axis) noexcept {
  for (std::uint32_t c = 0; c < axis.count; ++c) {
    const float before = std::nextafter(axis.from[c], -kEndless);
    const float behind = std::nextafter(axis.to[c], kEndless);
    if (c > 0 && guess_cell(axis, before) >= c) return false;
    if (c + 1 < axis.count && guess_cell(axis, behind) <= c) return false;
  }
  return true;
}

}  // namespace

bool CellLayout::lay_edges(const LayoutTrial& trial, const SceneSample& s) noexcept {
  std::size_t total = 0;
  for (CellAxis& axis : axes_) {
    axis.count = static_cast<std::uint32_t>(trial.cells[axis.axis]);
    total += 2 * std::size_t{axis.count};
  }
  edges_.clear();
  if (!edges_.resize(total)) return false;
  usable_ = true;
  set_axis_pointers();
  float* at = edges_.data();
  for (CellAxis& axis : axes_) {
    float* const from = at;
    float* const to = at + axis.count;
    at += 2 * axis.count;
    const double low = static_cast<double>(s.low[axis.axis]);
    const double width = trial.width[axis.axis];
    // An axis that is not divided does not limit edges.
    axis.reach = trial.divided[axis.axis] ? static_cast<float>(trial.reach[axis.axis]) : kEndless;
    // A margin for the rounding of the difference that is compared with the limit.
    axis.limit = axis.reach * 0.9999995F;
    const double slack = 0.499 * (width - trial.reach[axis.axis]);
    for (std::uint32_t c = 0; c < axis.count; ++c) {
      from[c] = static_cast<float>(low + c * width - slack);
      to[c] = static_cast<float>(low + (c + 1) * width + slack);
    }
    from[0] = -kEndless;
    to[axis.count - 1] = kEndless;
    axis.origin = s.low[axis.axis];
    axis.inverse = axis.count > 1 ? static_cast<float>(1.0 / width) : 0.0F;
    // Far from the origin floats may be too coarse to separate cells that are two apart.
    for (std::uint32_t c = 0; c + 2 < axis.count; ++c) {
      const double end = static_cast<double>(to[c]) + static_cast<double>(axis.reach);
      usable_ =
          usable_ && static_cast<double>(from[c + 2]) > end * (end > 0 ? 1.0000001 : 0.9999999);
    }
    usable_ = usable_ && std::isfinite(axis.inverse) && agrees(axis);
  }
  return true;
}

// Sets the pointers of the axes to the bounds of their cells.
void CellLayout::set_axis_pointers() noexcept {
  const float* at = edges_.data();
  for (CellAxis& axis : axes_) {
    axis.from = at;
    axis.to = at + axis.count;
    at += 2 * axis.count;
  }
}

bool CellLayout::reserve(std::size_t cells, Pages pages) noexcept {
  // At most all cells on one axis, or the maximum on each.
  const std::size_t ends = std::min(cells + 2, 3 * (static_cast<std::size_t>(kMaxCells) + 1));
  if (!edges_.reserve(2 * ends, pages)) return false;
  if (!edges_.empty()) set_axis_pointers();
  return true;
}

void CellLayout::find_cells(const BoundsPool& pool, std::uint32_t* cell,
                            const Execution& execution) const noexcept {
  const std::array<const float*, 6> columns = box_columns(pool);
  for_each_even_range(execution, pool.rows(), kRowsPerRange,
                      [&](std::size_t begin, std::size_t end) {
                        cell_layout_kernels().cells(columns.data(), axes_.data(), begin, end, cell);
                      });
}

std::uint32_t CellLayout::cell_of(const Structure::ObjectBox& box) const noexcept {
  std::uint32_t cell = 0;
  for (std::size_t k = 3; k-- > 0;) {
    const CellAxis& axis = axes_[k];
    const float low = box.low[axis.axis];
    if (!(box.high[axis.axis] - low <= axis.limit)) return kNoCell;
    cell = cell * axis.count + guess_cell(axis, low);
  }
  return cell;
}

bool CellLayout::fits(const Structure::ObjectBox& box, std::uint32_t cell) const noexcept {
  for (const CellAxis& axis : axes_) {
    const float low = box.low[axis.axis];
    const std::uint32_t c = cell % axis.count;
    cell /= axis.count;
    if (!(low >= axis.from[c] && low <= axis.to[c])) return false;
    if (!(box.high[axis.axis] - low <= axis.limit)) return false;
  }
  return true;
}

bool CellLayout::fits(const Structure::ObjectBox& box, std::size_t row,
                      const Column<std::uint32_t>& start) const noexcept {
  // Usually the box's lower corner is still in the cell of the row.
  const std::uint32_t own = cell_of(box);
  if (own != kNoCell && row >= start[own] && row < start[own + 1]) return true;
  const auto after = std::upper_bound(start.begin(), start.end(), row);
  return fits(box, static_cast<std::uint32_t>(after - start.begin() - 1));
}

void CellLayout::swap(CellLayout& other) noexcept {
  std::swap(axes_, other.axes_);
  edges_.swap(other.edges_);
  std::swap(drift_, other.drift_);
  std::swap(usable_, other.usable_);
}

void CellLayout::release() noexcept {
  edges_.release();
  usable_ = false;
}

}  // namespace winnow
