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

/// Boxes that objects were given and that their rows do not hold yet: while `active`, an update
/// leaves alone the row of a box whose ends all lie within a margin of those in the row. It costs
/// one look at both arrays in the order in which objects are given, and changes nothing that rows,
/// structures or trees are about. Who wants the rows as they were given has them written.
///
/// Both boxes of an object are kept by its id: 48 bytes per object, once it has been active.
class DeferredBoxes {
 public:
  struct Box {
    float min[3];
    float max[3];
  };

  explicit DeferredBoxes(std::pmr::memory_resource* memory) noexcept
      : given_(memory), stored_(memory), left_(memory) {}

  [[nodiscard]] bool active() const noexcept { return active_.load(std::memory_order_acquire); }
  [[nodiscard]] float margin() const noexcept { return margin_; }
  /// By id: what live objects were given last.
  [[nodiscard]] const Box* given() const noexcept { return given_.data(); }
  /// By id: what their rows hold, infinite ends as they were given.
  [[nodiscard]] const Box* stored() const noexcept { return stored_.data(); }

  /// From now on boxes within the margin are deferred. False if memory is refused.
  [[nodiscard]] bool begin(const Rows& rows, float margin) noexcept;
  /// An update while active. Boxes that left the margin go to their rows; where these are more than
  /// some in a hundred, all do and it ends: it is not active afterwards.
  Status update(Rows& rows, const EntryList& entries, const BoxView& boxes);
  /// The same for one object. It never ends.
  Status update(Rows& rows, Key key, const Aabb& box);
  /// Takes note of objects that were inserted while active. False if memory is refused: it must end
  /// then.
  [[nodiscard]] bool insert(std::span<const Key> keys, const BoxView& boxes) noexcept;
  /// Writes to the rows what they do not hold. False if nothing was given since `begin`.
  bool write(Rows& rows) noexcept;
  /// Ends it: the rows hold what was given, or the objects are gone.
  void drop() noexcept;
  /// Gives memory back while it is not active.
  void release() noexcept;

  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool copy(const EntryList& entries, const BoxView& boxes) noexcept;

  Column<Box> given_;
  Column<Box> stored_;
  Column<std::uint32_t> left_;
  float margin_ = 0.0F;
  std::uint32_t most_ = 0;  // objects that may leave the margin in one update
  bool pending_ = false;
  std::atomic<bool> active_{false};
};

}  // namespace winnow
