#pragma once

#include "core/memory/columns.h"
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/kd_order.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// The order in which rows are to stand next, as a structure and the tree beside it want them. It
/// is found in stages, which may be spread over refreshes: between these, objects move, come and
/// go. What is out of date at the end does no harm: who puts the rows in this order looks for those
/// that no longer fit.
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

  /// Room for an order of so many rows, of which so many may be moved elsewhere meanwhile, so that
  /// no plan asks for more, but for what structures sort with. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t rows, std::size_t moved, Pages pages) noexcept;
  /// What a structure is to make room in.
  [[nodiscard]] BuildRoom room_for(std::size_t objects, Pages pages) noexcept {
    return {objects, pages, items_, list_, points_};
  }

  /// Begins with the rows as they are; `room` more than these may come behind the order. False if
  /// memory is refused.
  [[nodiscard]] bool start(Rows& rows, Structure& structure, std::size_t room,
                           KdParts parts) noexcept;
  /// Runs stages that go over about so many rows, one at least. False, and the plan is dropped, if
  /// memory is refused.
  [[nodiscard]] bool advance(std::size_t work) noexcept;
  void drop() noexcept;

  /// From `start` until `drop`.
  [[nodiscard]] bool underway() const noexcept { return structure_ != nullptr; }
  [[nodiscard]] bool ready() const noexcept { return part_ == Part::ready; }
  /// The structure that it is for.
  [[nodiscard]] Structure* structure() const noexcept { return structure_; }
  /// The rows that it began with are those below this.
  [[nodiscard]] std::size_t rows() const noexcept { return planned_rows_; }

  /// The object in a row is about to be moved behind all others. Where memory is refused, that is
  /// where it stays.
  void note_move(std::uint32_t row, ObjectId id) noexcept {
    if (row < planned_rows_) (void)moves_.push_back({row, id});
  }

  // When it is ready.

  /// Makes the order one of all live rows as they are now. Objects that were moved behind the
  /// others have the places that were planned for them where they stood, rows that came since
  /// follow at the end, and those that have become empty leave their places empty. False if memory
  /// is refused.
  [[nodiscard]] bool complete() noexcept;
  /// The old row of each new one: first the regular ones.
  [[nodiscard]] Column<std::uint32_t>& order() noexcept { return order_; }
  [[nodiscard]] std::size_t regular() const noexcept { return regular_; }
  /// What the structure is told when the rows stand in the order.
  [[nodiscard]] RowPlan row_plan() noexcept {
    return {planned_rows_,
            planned_objects_,
            order_,
            rest_,
            items_,
            list_,
            {moves_.data(), moves_.size()}};
  }

  /// Scratch for sorting other rows by place, while no plan is underway.
  [[nodiscard]] Column<float>& points() noexcept { return points_; }
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept {
    return bytes_of(order_, rest_, moves_, placed_, items_, list_, points_);
  }

 private:
  enum class Part : std::uint8_t { structure, rest, cuts, ready };
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
  Part part_ = Part::structure;
  unsigned stage_ = 0;
  bool resumed_ = false;  // rows may have become empty since it began
  KdParts parts_ = KdParts::tiles;
  KdCuts cuts_;

  Column<std::uint32_t> order_;
  Column<std::uint32_t> rest_;
  Column<RowMove> moves_;
  Column<std::uint32_t> placed_;  // rows behind all that the plan began with which have a place
  Column<std::uint64_t> items_;
  Column<std::uint32_t> list_;
  Column<float> points_;  // places of what is sorted by these
};

}  // namespace winnow
