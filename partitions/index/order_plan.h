#pragma once

#include "core/memory/columns.h"
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/kd_order.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// Plans the next order of the rows: the order that the structure and the tree beside it need, in
/// stages: the structure's regular rows; the start of the rest, which reads the centres, so that
/// later motion does not change the cuts; the cuts; ready. The stages may be spread over refreshes,
/// and objects may move, be inserted or removed between stages. A plan that is out of date is
/// harmless: the caller that reorders the rows then searches for rows that no longer fit.
class OrderPlan {
 public:
  explicit OrderPlan(std::pmr::memory_resource* memory) noexcept
      : order_(memory),
        rest_(memory),
        moves_(memory),
        placed_(memory),
        items_(memory),
        list_(memory),
        points_(memory) {}

  /// Makes room for an order of `rows` rows, of which `moved` may be moved meanwhile, so that plans
  /// allocate no memory except for the sort scratch of structures. Returns false if an allocation
  /// fails.
  [[nodiscard]] bool reserve(std::size_t rows, std::size_t moved, Pages pages) noexcept;
  /// Returns the scratch columns that a structure reserves.
  [[nodiscard]] BuildRoom room_for(std::size_t objects, Pages pages) noexcept {
    return {objects, pages, items_, list_, points_};
  }

  /// Starts a plan for the current rows; at most `room` further rows may be added behind the order.
  /// Returns false if an allocation fails.
  [[nodiscard]] bool start(Rows& rows, Structure& structure, std::size_t room,
                           KdPrecision precision) noexcept;
  /// Runs stages that visit about `work` rows in total: at least one if `work` is not 0, and at
  /// most one of cuts. Returns false if an allocation fails; the caller then drops the plan.
  [[nodiscard]] bool advance(std::size_t work) noexcept;
  void drop() noexcept;

  /// True from `start` until `drop`.
  [[nodiscard]] bool underway() const noexcept { return structure_ != nullptr; }
  [[nodiscard]] bool ready() const noexcept { return phase_ == PlanPhase::ready; }
  /// The structure that the plan is for.
  [[nodiscard]] Structure* structure() const noexcept { return structure_; }
  /// The plan covers the rows below this, which existed at `start`.
  [[nodiscard]] std::size_t rows() const noexcept { return planned_rows_; }

  /// To be called before the object in `row` is moved behind all others. If the allocation fails,
  /// the object stays at the end.
  void note_move(std::uint32_t row, ObjectId id) noexcept {
    if (row < planned_rows_) (void)moves_.push_back({row, id});
  }

  // The following are valid once the plan is ready.

  /// Turns the plan into an order of all current rows. Objects that were moved to the end get the
  /// new rows planned for their former rows; rows added since `start` follow at the end; rows that
  /// became empty leave holes. Returns false if an allocation fails.
  [[nodiscard]] bool complete() noexcept;
  /// The old row of each new row, regular rows first.
  [[nodiscard]] Column<std::uint32_t>& order() noexcept { return order_; }
  [[nodiscard]] std::size_t regular() const noexcept { return regular_; }
  /// The argument for Structure::finish_build once the rows are in the order.
  [[nodiscard]] RowPlan row_plan() noexcept {
    return {planned_rows_,
            planned_objects_,
            order_,
            rest_,
            items_,
            list_,
            {moves_.data(), moves_.size()}};
  }

  /// Scratch for sorting other rows by position while no plan is underway.
  [[nodiscard]] Column<float>& points() noexcept { return points_; }
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept {
    return bytes_of(order_, rest_, moves_, placed_, items_, list_, points_);
  }

 private:
  enum class PlanPhase : std::uint8_t { structure, rest, cuts, ready };
  [[nodiscard]] bool run_stage(std::size_t& work) noexcept;
  [[nodiscard]] bool begin_rest(std::size_t& work) noexcept;
  void append_rest() noexcept;
  void sort_moves() noexcept;
  void place_moved() noexcept;

  Rows* rows_ = nullptr;
  Structure* structure_ = nullptr;
  std::size_t planned_rows_ = 0;
  std::size_t planned_objects_ = 0;
  std::size_t regular_ = 0;
  PlanPhase phase_ = PlanPhase::structure;
  unsigned structure_stage_ = 0;  // the next argument of Structure::plan
  bool resumed_ = false;          // rows may have become empty since the start
  KdPrecision precision_ = KdPrecision::tiles;
  KdCuts cuts_;

  Column<std::uint32_t> order_;
  Column<std::uint32_t> rest_;
  Column<RowMove> moves_;
  Column<std::uint32_t> placed_;  // ascending rows beyond planned_rows_ that have a planned new row
  Column<std::uint64_t> items_;
  Column<std::uint32_t> list_;
  Column<float> points_;  // positions of rows, used as sort keys
};

}  // namespace winnow
