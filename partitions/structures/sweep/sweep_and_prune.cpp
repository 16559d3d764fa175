// SweepAndPrune: plans strips (cells/cell_layout.h), sorts their rows by keys, and dispatches to
// the kernels of sweep_and_prune.kernel.cpp.

#include "core/sort/counting_sort.h"
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/cell_layout.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/sweep/sweep_and_prune.kernel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cfloat>
#include <limits>
#include <span>
#include <utility>

namespace winnow {

WINNOW_DEFINE_KERNELS(SweepKernels, sweep_kernels)

namespace {

constexpr std::size_t kPadding = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// An object is crowded if more than this many objects of its strip start within one window.
constexpr std::uint32_t kCrowded = 384;
constexpr CellRequirements kRequirements{
    .slack_share = 0.5, .cells_per_object = 0.25, .sweep_fast_axis = true, .rows_per_block = 10};

/// A sort key and a row: the position on the sweep axis in the high bits, the row in the low bits.
using SweepItem = std::uint64_t;

SweepItem sweep_item(float key, std::uint32_t row) noexcept {
  return SweepItem{sortable(key)} << 32U | row;
}
std::uint32_t row_of(SweepItem item) noexcept {
  return static_cast<std::uint32_t>(item);
}
std::uint32_t sortable_of(SweepItem item) noexcept {
  return static_cast<std::uint32_t>(item >> 32U);
}
float key_of(SweepItem item) noexcept {
  return from_sortable(sortable_of(item));
}

// Sorts items by key and row, with bins of equal width that mostly contain one item each.
void sort_by_keys(std::span<SweepItem> items, SweepItem* room) noexcept {
  constexpr std::size_t kMaxKeyBins = 1024;
  constexpr std::size_t kFewInBin = 12;
  constexpr float kMinExtent = 1e-30F;  // a smaller extent counts as one position
  const std::size_t bins = std::min(kMaxKeyBins, std::bit_ceil(items.size()));
  float low = kInfinity;
  float high = -kInfinity;
  for (const SweepItem item : items) {
    low = std::min(low, key_of(item));
    high = std::max(high, key_of(item));
  }
  // Halved values, because the extent of arbitrary floats could overflow.
  const float reach = 0.5F * high - 0.5F * low;
  const float scale = reach > kMinExtent ? 0.999F * static_cast<float>(bins) / reach : 0.0F;
  const auto bin_of = [&](SweepItem item) {
    return static_cast<std::size_t>((0.5F * key_of(item) - 0.5F * low) * scale);
  };
  std::array<std::uint32_t, kMaxKeyBins> next;
  std::fill_n(next.begin(), bins, 0U);
  for (const SweepItem item : items) ++next[bin_of(item)];
  const std::uint32_t most = *std::max_element(next.begin(), next.begin() + bins);
  if (most > kFewInBin || items.size() < 2) return std::sort(items.begin(), items.end());
  std::uint32_t sum = 0;
  for (std::uint32_t& n : std::span(next).first(bins)) sum += std::exchange(n, sum);
  for (const SweepItem item : items) room[next[bin_of(item)]++] = item;
  // An insertion sort within bins completes the order.
  for (std::size_t i = 0; i < items.size(); ++i) {
    std::size_t to = i;
    for (; to > 0 && items[to - 1] > room[i]; --to) items[to] = items[to - 1];
    items[to] = room[i];
  }
}

/// Sorted sweep and prune (Baraff, "Dynamic Simulation of Non-Penetrating Rigid Bodies", 1992) in
/// strips: objects are bucketed on two axes and sorted on the third, the sweep axis, which has the
/// most room in units of the objects' edges. Blocks of sixteen successive rows of a strip sweep
/// together through the rest of their strip and through four neighbouring strips: the box around a
/// block selects candidates, 16 at a time. An axis that prunes nothing is not divided. A row may
/// drift from its sort key by a bound that the sweep includes, so slow motion or rest costs no
/// sorting. Objects wider than strips go to a block tree; if they are many, the tree contains the
/// whole scene. Self pairs: O(n log n + n * objects in a sweep + pairs). Exact.
class SweepAndPrune final : public CellStructure {
 public:
  explicit SweepAndPrune(const StructureInput& input) noexcept;

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] PlanStatus plan(const RowPlan& plan, unsigned stage) noexcept override;
  [[nodiscard]] std::size_t plan_passes() const noexcept override { return 4; }
  void finish_build(const RowPlan& plan, bool foreseen) noexcept override;
  [[nodiscard]] bool fits(std::size_t row, const ObjectBox& place) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override { return layout_.cells(); }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t strip) const noexcept override {
    return start_[strip];
  }
  std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out) const noexcept override;
  bool find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept override;
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw(DebugDraw& draw) const override;
  void release_memory() noexcept override;
  void add_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cells() const noexcept override;

  [[nodiscard]] PlanStatus choose_strips(const RowPlan& plan) noexcept;
  [[nodiscard]] PlanStatus fill_strips(const RowPlan& plan) noexcept;
  [[nodiscard]] bool sort_strips(const RowPlan& plan, std::size_t begin, std::size_t end) noexcept;
  void move_crowded_to_rest(const RowPlan& plan) noexcept;
  [[nodiscard]] float crowd_window() const noexcept;
  [[nodiscard]] StripView view() const noexcept;

  CellLayout layout_;
  CellLayout planned_;
  Column<float> key_;     // by row: lower bound on the sweep axis when it was sorted
  bool crowded_ = false;  // while planning: some strip is crowded
};

SweepAndPrune::SweepAndPrune(const StructureInput& input) noexcept
    : CellStructure(input), layout_(input.memory), planned_(input.memory), key_(input.memory) {}

bool SweepAndPrune::reserve(const BuildRoom& room) noexcept {
  const auto strips =
      static_cast<std::size_t>(kRequirements.max_cells(static_cast<double>(room.objects)));
  return reserve_cells(room, strips, room.objects) && planned_.reserve(strips, room.pages) &&
         key_.reserve(room.objects + kPadding, room.pages) &&
         room.items.reserve(2 * room.objects, room.pages);
}

PlanStatus SweepAndPrune::plan(const RowPlan& plan, unsigned stage) noexcept {
  const std::size_t half = planned_.cells() / 2;
  switch (stage) {
    case 0:
      return choose_strips(plan);
    case 1:
      return fill_strips(plan);
    case 2:
      crowded_ = sort_strips(plan, 0, half);
      return PlanStatus::unfinished;
    default:
      crowded_ |= sort_strips(plan, half, planned_.cells());
      if (crowded_) move_crowded_to_rest(plan);
      if (are_too_many_outside_cells(plan.rest.size(), plan)) move_all_to_rest(plan);
      return PlanStatus::done;
  }
}

// Writes the strip of each row to `plan.list`.
PlanStatus SweepAndPrune::choose_strips(const RowPlan& plan) noexcept {
  const SceneSample sample(pool(), plan.objects, execution());
  if (!planned_.choose(sample, kRequirements)) return PlanStatus::out_of_memory;
  if (!planned_.usable()) {
    append_all_to_rest(plan);
    return PlanStatus::done;
  }
  const std::size_t rows = plan.rows;
  if (!plan.list.resize(rows) || !planned_start_.resize(planned_.cells() + 1) ||
      !key_.grow(rows + kPadding) || !plan.items.resize(2 * rows)) {
    return PlanStatus::out_of_memory;
  }
  planned_.find_cells(pool(), plan.list.data(), execution());
  return PlanStatus::unfinished;
}

PlanStatus SweepAndPrune::fill_strips(const RowPlan& plan) noexcept {
  CountingSort strips({plan.list.data(), plan.rows}, {planned_start_.data(), planned_start_.size()},
                      execution());
  strips.count();
  plan.regular.set_size(strips.find_starts());
  if (are_too_many_outside_cells(plan.objects - plan.regular.size(), plan)) {
    move_all_to_rest(plan);
    return PlanStatus::done;
  }
  strips.place(plan.regular.data());
  list_rest(plan.regular.size(), plan);
  return PlanStatus::unfinished;
}

// Sorts the rows of strips [first, last) by their keys. Afterwards `plan.items` contains the keys,
// and `plan.list` their sortable form. Returns true if some strip is crowded.
bool SweepAndPrune::sort_strips(const RowPlan& plan, std::size_t first, std::size_t last) noexcept {
  const float* const low = pool().column(planned_.axis(0).axis);
  const float window = crowd_window();
  std::atomic<bool> crowded{false};
  const TaskCut cut{last - first};
  execution().for_each(cut.tasks(), [&](std::size_t task) {
    bool found = false;
    const std::size_t end = first + cut.first(task + 1);
    for (std::size_t strip = first + cut.first(task); strip < end; ++strip) {
      const std::uint32_t begin = planned_start_[strip];
      const std::size_t count = planned_start_[strip + 1] - begin;
      SweepItem* const items = plan.items.data() + begin;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t row = plan.regular[begin + i];
        // An object that was moved to the end is sorted by its current position. A removed object
        // has no key.
        items[i] = sweep_item(std::min(low[current_row(plan, row)], FLT_MAX), row);
      }
      sort_by_keys({items, count}, items + plan.rows);
      for (std::size_t i = 0; i < count; ++i) {
        plan.regular[begin + i] = row_of(items[i]);
        plan.list[begin + i] = sortable_of(items[i]);
      }
      for (std::size_t i = 0; i + kCrowded < count && !found; ++i) {
        found = key_of(items[i + kCrowded]) <= key_of(items[i]) + 2.0F * window;
      }
    }
    if (found) crowded.store(true, std::memory_order_relaxed);
  });
  return crowded.load();
}

// Moves crowded objects to the rest. If many objects start within one window on the sweep axis, for
// example because half of the objects are tiny, a sweep would test all of them; the tree prunes
// them better.
void SweepAndPrune::move_crowded_to_rest(const RowPlan& plan) noexcept {
  const float window = crowd_window();
  const SweepItem* const items = plan.items.data();
  std::uint32_t kept = 0;
  for (std::size_t strip = 0; strip + 1 < planned_start_.size(); ++strip) {
    const std::uint32_t begin = planned_start_[strip];
    const std::uint32_t end = planned_start_[strip + 1];
    planned_start_[strip] = kept;
    std::uint32_t behind = begin;
    std::uint32_t ahead = begin;
    // Kept rows move to the front.
    for (std::uint32_t i = begin; i < end; ++i) {
      const float x = key_of(items[i]);
      while (key_of(items[behind]) < x - window) ++behind;
      while (ahead < end && key_of(items[ahead]) <= x + window) ++ahead;
      if (ahead - behind > kCrowded) {
        (void)plan.rest.push_back(row_of(items[i]));
      } else {
        plan.list[kept] = sortable_of(items[i]);
        plan.regular[kept++] = row_of(items[i]);
      }
    }
  }
  planned_start_[planned_start_.size() - 1] = kept;
  plan.regular.set_size(kept);
}

// Distance on the sweep axis within which neighbours count for crowding.
float SweepAndPrune::crowd_window() const noexcept {
  return planned_.axis(0).reach + 2.0F * planned_.drift();
}

void SweepAndPrune::finish_build(const RowPlan& plan, bool) noexcept {
  layout_.swap(planned_);
  start_.swap(planned_start_);
  if (regular_rows() == 0) return;
  key_.set_size(regular_rows() + kPadding);
  for (std::size_t row = 0; row < regular_rows(); ++row) key_[row] = from_sortable(plan.list[row]);
  // Kernels load sixteen keys from any row.
  std::fill_n(key_.data() + regular_rows(), kPadding, kInfinity);
}

bool SweepAndPrune::fits(std::size_t row, const ObjectBox& place) const noexcept {
  const float low = place.low[layout_.axis(0).axis];
  return low >= key_[row] - layout_.drift() && low <= key_[row] + layout_.drift() &&
         layout_.fits(place, row, start_);
}

std::size_t SweepAndPrune::write_misfits(std::uint32_t begin, std::uint32_t end,
                                         std::uint32_t* out) const noexcept {
  return sweep_kernels().find_misfits(view(), begin, end, out);
}

bool SweepAndPrune::find_pairs(std::uint32_t begin, std::uint32_t end,
                               PairSink& sink) const noexcept {
  return sweep_kernels().self_pairs(view(), begin, end, sink);
}

bool SweepAndPrune::query(const QueryBatch& batch, PairSink& sink) const noexcept {
  return sweep_kernels().query(view(), batch, sink);
}

StripView SweepAndPrune::view() const noexcept {
  return {row_view(),
          key_.data(),
          start_.data(),
          {layout_.axis(0), layout_.axis(1), layout_.axis(2)},
          layout_.drift()};
}

void SweepAndPrune::draw(DebugDraw& draw) const {
  draw_cells(draw, layout_, row_view(), start_, "is swept");
}

void SweepAndPrune::release_memory() noexcept {
  CellStructure::release_memory();
  key_.release();
  layout_.release();
  planned_.release();
}

void SweepAndPrune::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += layout_.bytes();
  footprint.structure += planned_.bytes();
  footprint.structure += key_.bytes();
}

std::size_t SweepAndPrune::cells() const noexcept {
  return layout_.cells();
}

constexpr StructureCosts kCosts{.has_cells = true,
                                .keep = 20.5,
                                .level = 0.012,
                                .crowd = 1.4,
                                .pair = 7.5,
                                .moved = 450,
                                .rest = 0.24,
                                .build = 53,
                                .anew = 37,
                                .query_level = 32,
                                .rows = 1.5};
constexpr StructureInfo kInfo = structure_info<SweepAndPrune>("SweepAndPrune", &kCosts);

}  // namespace

StructureKind sweep_and_prune() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
