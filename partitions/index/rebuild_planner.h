#pragma once

// Decides when the rows of a SpatialIndex are reordered: now, later, or in stages over several
// refreshes. Its only input are numbers (RowNumbers); SpatialIndex carries its decisions out.

#include "partitions/tree/kd_order.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace winnow {

/// The rows of an index and its structure, in numbers.
struct RowNumbers {
  std::size_t objects = 0;
  std::size_t rows = 0;           ///< with holes
  std::size_t regular = 0;        ///< rows in cells or strips
  std::size_t tail = 0;           ///< rows behind the order of the last build
  std::size_t changed = 0;        ///< objects that changed since the last refresh
  bool all_changed = false;       ///< any object may have changed
  bool built = false;             ///< false: the rows have no order
  bool flat = false;              ///< the structure needs no order
  bool environments = false;      ///< more than one environment is in use
  std::size_t ungrouped = 0;      ///< rows that are not in the group of their environment
  std::uint64_t build_price = 0;  ///< of the structure, in tests of 16 volumes per object
  std::size_t plan_passes = 0;    ///< of the structure, over all rows
  std::size_t plan_rows = 0;      ///< rows of the plan that is underway; 0: there is none
  bool plan_ready = false;
};

/// Extrapolates a count that grows from refresh to refresh, at a constant or growing rate.
class GrowthForecast {
 public:
  /// Restarts: the next count is the first.
  void begin() noexcept { last_ = step_ = acceleration_ = 0; }
  void note(std::uint64_t count) noexcept {
    const std::uint64_t step = count > last_ ? count - last_ : 0;
    acceleration_ = last_ != 0 && step > step_ ? step - step_ : 0;
    step_ = last_ != 0 ? step : 0;
    last_ = count;
  }
  /// Returns the expected count after `refreshes` more refreshes.
  [[nodiscard]] std::uint64_t in(std::size_t refreshes) const noexcept {
    return last_ + step_ * refreshes + acceleration_ * refreshes * (refreshes + 1) / 2;
  }

 private:
  std::uint64_t last_ = 0;
  std::uint64_t step_ = 0;
  std::uint64_t acceleration_ = 0;  // increase of the step
};

/// A build is due if the share of new rows, moved rows or holes exceeds a limit, if an update
/// scatters the objects, or if wear exceeds the price of a build. Wear is the number of extra tests
/// since the last build, compared with a fresh structure. The total cost of wear and builds is at
/// most twice the cost of the best schedule known in hindsight (the ski-rental bound; Karlin et
/// al., Algorithmica 3, 1988). Decisions count tests, never time, so every machine builds in the
/// same frame.
///
/// An order is lost in four ways: one update moves most objects (Rows::order_is_lost before the
/// boxes are written, `is_scattered` after the refit), few objects jump (outliers), or wear grows.
///
/// Most of a build is spent on the order. A build can be foreseen if objects approach the borders
/// of their cells, or if the tail or the wear grows. Then the order is planned in stages over the
/// refreshes before the build (see OrderPlan).
class RebuildPlanner {
 public:
  /// Work for a build that is completed at once.
  static constexpr std::size_t kWholeBuild = std::numeric_limits<std::size_t>::max();

  /// `build_budget` as in PartitionOptions.
  explicit RebuildPlanner(std::size_t build_budget) noexcept : build_budget_(build_budget) {}

  // Decisions.

  /// The step that a refresh takes with the order of the rows.
  enum class OrderStep : std::uint8_t { keep, build, apply_plan };
  /// Begins a refresh.
  [[nodiscard]] OrderStep begin_refresh(const RowNumbers& n) noexcept;
  [[nodiscard]] bool needs_build(const RowNumbers& n) const noexcept;
  /// True if an update may have scattered the objects over a tree of `blocks` blocks;
  /// `is_scattered` then compares the edge of a typical block with that after the build.
  [[nodiscard]] bool may_be_scattered(const RowNumbers& n, std::size_t blocks) const noexcept;
  [[nodiscard]] bool is_scattered(const RowNumbers& n, float typical_edge) const noexcept;

  /// The step that a refresh takes about blocks that outliers made wide.
  enum class OutlierStep : std::uint8_t { none, search, build };
  /// True if enough objects changed to count wide blocks.
  [[nodiscard]] bool may_have_outliers(const RowNumbers& n) const noexcept;
  /// `wide` of `blocks` blocks are wide.
  [[nodiscard]] OutlierStep step_for_outliers(const RowNumbers& n, std::size_t wide,
                                              std::size_t blocks) noexcept;

  /// False if builds are always done at once.
  [[nodiscard]] bool plans_ahead(const RowNumbers& n) const noexcept;
  /// True if a build is expected within as many refreshes as a plan takes, so that a plan should
  /// start. `may_leave` is true if that depends on the share of objects that leave their cells
  /// within `refreshes`; see `is_near_if_leaving`.
  struct BuildForecast {
    bool near = false;
    bool may_leave = false;
    std::size_t refreshes = 0;
  };
  [[nodiscard]] BuildForecast forecast_build(const RowNumbers& n) const noexcept;
  [[nodiscard]] static bool is_near_if_leaving(const RowNumbers& n, float leaving) noexcept;
  /// Returns the number of rows that this refresh plans.
  [[nodiscard]] std::size_t planning_work(const RowNumbers& n) const noexcept;
  /// True if planning pauses in this refresh.
  [[nodiscard]] bool is_paused() const noexcept;
  /// Returns the precision of the order of the next build; `first` is that of the first one.
  [[nodiscard]] KdPrecision precision(KdPrecision first) const noexcept;
  /// Returns true if this refresh counts as a frame for the forecasts, and forgets the queries
  /// before it.
  [[nodiscard]] bool begin_frame(const RowNumbers& n) noexcept;

  /// A build is due if the tail has more rows than this.
  [[nodiscard]] static std::size_t tail_limit(std::size_t objects) noexcept {
    return objects / 16 + 64;
  }
  /// The maximum size of a tail, which contains no object twice.
  [[nodiscard]] static std::size_t max_in_tail(std::size_t objects) noexcept {
    return std::min(tail_limit(objects), objects);
  }
  /// The rows that a build reserves for the tail. `prunes_rows`: see Structure::prunes_rows.
  [[nodiscard]] static std::size_t tail_room(bool prunes_rows, std::size_t objects) noexcept {
    return (prunes_rows ? 2 : 1) * max_in_tail(objects);
  }

  // Events.

  /// To be called before queries other than pairs that follow a change.
  void note_query() const noexcept;
  /// Adds the cost of `queries` pair queries, in tests of 16 volumes, to the wear. `all`: every
  /// object was queried; `moved`: only objects that moved.
  enum class PairQueryKind : std::uint8_t { all, moved };
  void note_work(std::uint64_t tests, std::uint64_t queries, PairQueryKind kind) const noexcept;
  void note_refit() noexcept { ++refits_; }
  /// A plan for the current rows starts.
  void note_plan(const RowNumbers& n) noexcept;
  /// A frame kept the order and has that many rows in the tail.
  void note_frame(std::size_t tail) noexcept;
  /// A plan was out of date when it was applied.
  void note_mistake() noexcept;
  /// A build ended. `edge`: of a typical block; `holes`: between the regions.
  void note_build(bool foreseen, std::size_t holes, float edge) noexcept;
  void note_flat_build() noexcept { ++builds_; }
  /// That many blocks are wide after a build or a search, so a search would find no outliers in
  /// them.
  void note_wide(std::size_t wide) noexcept { known_wide_ = wide; }
  void note_new_structure() noexcept;

  // State.

  [[nodiscard]] std::size_t build_budget() const noexcept { return build_budget_; }
  [[nodiscard]] std::uint64_t builds() const noexcept { return builds_; }
  [[nodiscard]] std::uint64_t planned_builds() const noexcept { return planned_builds_; }
  [[nodiscard]] std::uint64_t refits() const noexcept { return refits_; }
  /// Frames since the last build.
  [[nodiscard]] std::size_t frames() const noexcept { return frames_; }
  /// Wear: extra tests of pair queries since the last build, compared with a fresh structure.
  [[nodiscard]] std::uint64_t excess_tests() const noexcept {
    return excess_.load(std::memory_order_relaxed);
  }
  /// Edge of a typical block of the tree after the build.
  [[nodiscard]] float built_edge() const noexcept { return built_edge_; }

 private:
  [[nodiscard]] static std::uint64_t max_wear(const RowNumbers& n) noexcept {
    return n.build_price * (n.objects + 64);
  }

  const std::size_t build_budget_;

  // Wear, in tests of 16 volumes: the cost of one query on a fresh structure (for all objects, for
  // moved objects), and the excess of the queries since then.
  mutable std::atomic<std::uint64_t> full_base_{0};
  mutable std::atomic<std::uint64_t> moved_base_{0};
  mutable std::atomic<std::uint64_t> excess_{0};
  // Refreshes for queries other than pairs since the last build.
  mutable std::atomic<std::size_t> queried_refreshes_{0};
  mutable std::atomic<bool> queried_{false};  // any query since the last refresh

  std::size_t frames_ = 0;
  GrowthForecast tail_growth_;
  GrowthForecast wear_growth_;
  float built_edge_ = 0.0F;
  std::size_t built_holes_ = 0;  // padding that the build put between the regions
  std::size_t known_wide_ = 0;
  std::size_t frames_before_plan_ = 0;       // frames from the last build to the start of the plan
  std::size_t changed_at_plan_ = 0;          // objects changed in the refresh that started the plan
  std::size_t quiet_refreshes_ = 0;          // consecutive refreshes with far fewer changes
  std::size_t builds_without_planning_ = 0;  // builds until plans are made ahead again

  std::uint64_t builds_ = 0;
  std::uint64_t planned_builds_ = 0;
  std::uint64_t refits_ = 0;
};

}  // namespace winnow
