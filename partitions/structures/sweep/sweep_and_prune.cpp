#include "partitions/structures/sweep/sweep_and_prune.h"

#include "core/sort/counting_sort.h"
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/task_lists.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace winnow {

WINNOW_DEFINE_KERNELS(SweepKernels, sweep_kernels)

namespace {

constexpr std::size_t kPadding = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Objects of a strip that begin within reach of one another.
constexpr std::uint32_t kCrowded = 384;
// Rows that do not fit strips ask every strip that they cross. Where more than this share of a
// scene does so, the tree serves all of it better.
constexpr double kMostApart = 0.1;

// Order-preserving map of floats to unsigned.
std::uint32_t sortable(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

}  // namespace

SweepAndPrune::SweepAndPrune(const PartitionOptions& options)
    : RowPartition(options, options.volume),
      layout_(options.memory),
      start_(options.memory),
      key_(options.memory),
      strip_(options.memory) {}

bool SweepAndPrune::plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  const SceneSample sample(pool());
  const CellDemand demand{
      .slack_share = 0.5, .cells_per_object = 0.25, .sweep_fast_axis = true, .rows_per_block = 10};
  if (!layout_.choose(sample, demand)) return false;
  if (!layout_.usable()) return RowPartition::plan(regular, rest);
  const std::size_t rows = pool().rows();
  if (!strip_.resize(rows) || !start_.resize(layout_.cells() + 1) ||
      !key_.resize(rows + kPadding) || !sort_scratch().resize(2 * rows)) {
    return false;
  }
  const auto most = static_cast<std::size_t>(kMostApart * static_cast<double>(sample.objects));
  const std::size_t count = list_rows(rest);
  if (rest.size() <= most) {
    sort_rows(count, regular);
    drop_crowded(regular, rest);
  }
  if (rest.size() <= most) return true;
  regular.clear();
  rest.clear();
  return RowPartition::plan(regular, rest);
}

// Lists the rows that fit strips, with their keys, and returns how many there are.
std::size_t SweepAndPrune::list_rows(Column<std::uint32_t>& rest) noexcept {
  std::fill(start_.begin(), start_.end(), 0);
  const std::size_t rows = pool().rows();
  const float* const low = pool().column(layout_.axis(0).axis);
  std::uint64_t* const items = sort_scratch().data();
  std::size_t count = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    if (pool().ids()[row] == kNoObject) continue;
    strip_[row] = layout_.cell_of(pool(), row);
    if (strip_[row] == CellLayout::kNoCell) {
      (void)rest.push_back(static_cast<std::uint32_t>(row));
      continue;
    }
    ++start_[strip_[row]];
    items[count++] = static_cast<std::uint64_t>(sortable(low[row])) << 32U | row;
  }
  return count;
}

void SweepAndPrune::sort_rows(std::size_t count, Column<std::uint32_t>& regular) noexcept {
  std::uint64_t* const items = sort_scratch().data();
  std::uint64_t* const spare = items + pool().rows();
  const std::uint64_t* const by_key = radix_sort(items, spare, count, 32, execution());
  (void)positions_from_counts(start_);
  regular.set_size(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::uint32_t>(by_key[i]);
    regular[start_[strip_[row]]++] = row;
  }
  starts_from_positions(start_);
}

// Where many objects begin within one reach of each other on the sweep axis, as when half of a
// scene is tiny, a sweep would look at all of them: the tree prunes these better.
void SweepAndPrune::drop_crowded(Column<std::uint32_t>& regular,
                                 Column<std::uint32_t>& rest) noexcept {
  const CellAxis& axis = layout_.axis(0);
  const float* const low = pool().column(axis.axis);
  const float window = axis.reach + 2.0F * layout_.drift();
  std::uint32_t kept = 0;
  for (std::size_t strip = 0; strip + 1 < start_.size(); ++strip) {
    const std::uint32_t begin = start_[strip];
    const std::uint32_t end = start_[strip + 1];
    start_[strip] = kept;
    std::uint32_t behind = begin;
    std::uint32_t ahead = begin;
    // Kept rows move to the front; the window is measured on the rows not yet passed and those
    // noted in strip_, which is free from here on.
    for (std::uint32_t i = begin; i < end; ++i) strip_[i] = regular[i];
    for (std::uint32_t i = begin; i < end; ++i) {
      const float x = low[strip_[i]];
      while (low[strip_[behind]] < x - window) ++behind;
      while (ahead < end && low[strip_[ahead]] <= x + window) ++ahead;
      if (ahead - behind > kCrowded) {
        (void)rest.push_back(strip_[i]);
      } else {
        regular[kept++] = strip_[i];
      }
    }
  }
  start_[start_.size() - 1] = kept;
  regular.set_size(kept);
}

void SweepAndPrune::finish_build() {
  if (regular_rows() == 0) return;
  const float* const low = pool().column(layout_.axis(0).axis);
  std::copy_n(low, regular_rows(), key_.data());
  // Kernels load sixteen keys at once from any row.
  std::fill_n(key_.data() + regular_rows(), kPadding, kInfinity);
}

bool SweepAndPrune::near_key(std::size_t row) const noexcept {
  const float low = pool().column(layout_.axis(0).axis)[row];
  return low >= key_[row] - layout_.drift() && low <= key_[row] + layout_.drift();
}

bool SweepAndPrune::fits_strip(std::size_t row, std::uint32_t strip) const noexcept {
  return near_key(row) && layout_.fits(pool(), row, strip);
}

bool SweepAndPrune::fits(std::size_t row) const noexcept {
  // Mostly the box's own corner still lies in the cell that holds the row.
  const std::uint32_t own = layout_.cell_of(pool(), row);
  if (own != CellLayout::kNoCell && row >= start_[own] && row < start_[own + 1])
    return near_key(row);
  const auto after = std::upper_bound(start_.begin(), start_.end(), row);
  return fits_strip(row, static_cast<std::uint32_t>(after - start_.begin() - 1));
}

void SweepAndPrune::find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept {
  const StripView strips = view();
  append_in_order(
      execution(), regular_tasks(), strip_.data(),
      [&](std::size_t task) { return start_[first_strip(task)]; },
      [&](std::size_t task, std::uint32_t* out) {
        return sweep_kernels().find_misfits(strips, first_strip(task), first_strip(task + 1), out);
      },
      rows, limit);
}

std::size_t SweepAndPrune::regular_tasks() const noexcept {
  return regular_rows() == 0 ? 0 : std::min(kMostTasks, layout_.cells());
}

std::uint32_t SweepAndPrune::first_strip(std::size_t task) const noexcept {
  return static_cast<std::uint32_t>(layout_.cells() * task / regular_tasks());
}

bool SweepAndPrune::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  return sweep_kernels().self_pairs(view(), first_strip(task), first_strip(task + 1), sink);
}

bool SweepAndPrune::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return sweep_kernels().query(view(), batch, sink);
}

StripView SweepAndPrune::view() const noexcept {
  return {row_view(),
          key_.data(),
          start_.data(),
          {layout_.axis(0), layout_.axis(1), layout_.axis(2)},
          layout_.drift()};
}

void SweepAndPrune::draw_regular(DebugDraw& draw, const DebugDrawOptions&) const {
  draw_cells(draw, layout_, row_view(), start_, "is swept");
}

void SweepAndPrune::release_structure() noexcept {
  layout_.release();
  start_.release();
  key_.release();
  strip_.release();
}

void SweepAndPrune::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.structure += layout_.bytes();
  footprint.structure += start_.bytes();
  footprint.structure += key_.bytes();
  footprint.scratch += strip_.bytes();
}

std::size_t SweepAndPrune::cell_count() const noexcept {
  return regular_rows() == 0 ? RowPartition::cell_count() : layout_.cells();
}

}  // namespace winnow
