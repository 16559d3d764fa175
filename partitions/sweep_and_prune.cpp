#include <winnow/partitions/sweep_and_prune.h>

#include <winnow/partitions/radix_sort.h>

#include <algorithm>
#include <bit>

namespace winnow {

WINNOW_DEFINE_KERNELS(SweepKernels, sweep_kernels)

namespace {

constexpr std::size_t kTasks = 64;

// Order-preserving map of floats to unsigned.
std::uint32_t sortable(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

}  // namespace

SweepAndPrune::SweepAndPrune(const PartitionOptions& options)
    : RowPartition(options, Volume::aabb),
      layout_(options.memory),
      start_(options.memory),
      key_(options.memory),
      strip_(options.memory),
      sorted_(options.memory) {}

bool SweepAndPrune::plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  const SceneSample sample(pool());
  const CellDemand demand{.slack_share = 0.3, .cells_per_object = 0.03, .sweep_fast_axis = true};
  if (!layout_.choose(sample, demand)) return false;
  if (!layout_.usable()) return RowPartition::plan(regular, rest);
  const std::size_t rows = pool().rows();
  if (!strip_.resize(rows) || !start_.resize(layout_.cells() + 1) || !key_.resize(rows) ||
      !sorted_.resize(2 * rows)) {
    return false;
  }
  std::fill(start_.begin(), start_.end(), 0);
  const float* const low = pool().column(layout_.axis(0).axis);
  std::size_t count = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    if (pool().ids()[row] == kNoObject) continue;
    strip_[row] = layout_.cell_of(pool(), row);
    if (strip_[row] == CellLayout::kNoCell) {
      (void)rest.push_back(static_cast<std::uint32_t>(row));
      continue;
    }
    ++start_[strip_[row]];
    sorted_[count++] = static_cast<std::uint64_t>(sortable(low[row])) << 32U | row;
  }
  const std::uint64_t* const by_key =
      radix_sort(sorted_.data(), sorted_.data() + rows, count, 32, execution());
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start_) {
    const std::uint32_t n = s;
    s = sum;
    sum += n;
  }
  regular.set_size(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::uint32_t>(by_key[i]);
    regular[start_[strip_[row]]++] = row;
  }
  // Every position has moved on to its strip's end, which is the next strip's start.
  for (std::size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];
  start_[0] = 0;
  return true;
}

void SweepAndPrune::finish_build() {
  const float* const low = pool().column(layout_.axis(0).axis);
  key_.set_size(regular_rows());
  std::copy_n(low, regular_rows(), key_.data());
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

void SweepAndPrune::find_misfits(Column<std::uint32_t>& rows, std::size_t limit) const noexcept {
  for (std::uint32_t strip = 0; strip + 1 < start_.size(); ++strip) {
    for (std::uint32_t row = start_[strip]; row < start_[strip + 1]; ++row) {
      if (fits_strip(row, strip) || pool().ids()[row] == kNoObject) continue;
      if (rows.size() == limit) return;
      (void)rows.push_back(row);
    }
  }
}

std::size_t SweepAndPrune::regular_tasks() const noexcept {
  return regular_rows() == 0 ? 0 : std::min(kTasks, layout_.cells());
}

bool SweepAndPrune::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const std::size_t tasks = regular_tasks();
  return sweep_kernels().self_pairs(
      view(), static_cast<std::uint32_t>(layout_.cells() * task / tasks),
      static_cast<std::uint32_t>(layout_.cells() * (task + 1) / tasks), sink);
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

void SweepAndPrune::release_structure() noexcept {
  layout_.release();
  start_.release();
  key_.release();
  strip_.release();
  sorted_.release();
}

void SweepAndPrune::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.structure += layout_.bytes();
  footprint.structure += start_.bytes();
  footprint.structure += key_.bytes();
  footprint.scratch += strip_.bytes();
  footprint.scratch += sorted_.bytes();
}

std::size_t SweepAndPrune::cell_count() const noexcept {
  return regular_rows() == 0 ? RowPartition::cell_count() : layout_.cells();
}

}  // namespace winnow
