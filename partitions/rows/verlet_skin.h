#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/box_view.h>
#include <winnow/core/column.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/status.h>
#include "partitions/rows/rows.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// A Verlet list with a skin: boxes that objects were given but that their rows do not contain.
/// While `active`, an update does not write a row if every end of the new box is within the skin of
/// the stored end. Such an update costs one pass over both arrays in the order of ids, and
/// invalidates neither rows nor structures nor trees. `write` brings the rows up to date.
/// RestDetector (state/resting.h) decides when to start; PartitionState calls both.
///
/// Given and stored boxes are arrays by id: 48 bytes per object once it has been active.
class VerletSkin {
 public:
  struct DeferredBox {
    float min[3];
    float max[3];
  };

  explicit VerletSkin(std::pmr::memory_resource* memory) noexcept
      : given_(memory), stored_(memory), departed_(memory) {}

  [[nodiscard]] bool active() const noexcept { return active_.load(std::memory_order_acquire); }
  [[nodiscard]] float skin() const noexcept { return skin_; }
  /// By id: the last box that each live object was given.
  [[nodiscard]] const DeferredBox* given() const noexcept { return given_.data(); }
  /// By id: the box in its row, infinite ends as infinite.
  [[nodiscard]] const DeferredBox* stored() const noexcept { return stored_.data(); }

  /// Starts deferring boxes within the skin. False if memory is refused.
  [[nodiscard]] bool begin(const Rows& rows, float skin) noexcept;
  /// Updates boxes while active. Boxes outside the skin are written to their rows. If these are
  /// more than 1/32 of the objects, plus 16, all rows are written and deferring ends (`active` is
  /// false then).
  Status update(Rows& rows, const UpdateSubset& entries, const BoxView& boxes);
  /// As above for one object; deferring never ends here.
  Status update(Rows& rows, Key key, const Aabb& box);
  /// Adds objects that were inserted while active. False if memory is refused; the caller must then
  /// end deferring.
  [[nodiscard]] bool insert(std::span<const Key> keys, const BoxView& boxes) noexcept;
  /// Writes all given boxes to the rows. False if no box was given since `begin` or the last
  /// `write`.
  bool write(Rows& rows) noexcept;
  /// Ends deferring without writing.
  void drop() noexcept;
  /// Frees memory; not active.
  void release() noexcept;

  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool copy(const UpdateSubset& entries, const BoxView& boxes) noexcept;

  Column<DeferredBox> given_;
  Column<DeferredBox> stored_;
  Column<std::uint32_t> departed_;
  float skin_ = 0.0F;
  std::uint32_t max_departed_ = 0;  // limit of objects that leave the skin in one update
  bool pending_ = false;
  std::atomic<bool> active_{false};
};

}  // namespace winnow
