#include <winnow/pipeline/narrow_phase.h>

namespace winnow {

NarrowResult::NarrowResult(std::pmr::memory_resource* memory) noexcept
    : order_(memory),
      runs_(memory),
      overlap_(memory),
      distance_(memory),
      error_bound_(memory),
      normal_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      point_{Column<double>(memory), Column<double>(memory), Column<double>(memory)},
      contact_first_(memory),
      contact_count_(memory),
      position_{Column<float>(memory), Column<float>(memory), Column<float>(memory)},
      depth_(memory),
      feature_(memory) {}

Footprint NarrowResult::footprint() const noexcept {
  Footprint footprint;
  Bytes& bytes = footprint.results;
  bytes += order_.bytes();
  bytes += runs_.bytes();
  bytes += overlap_.bytes();
  bytes += distance_.bytes();
  bytes += error_bound_.bytes();
  for (int axis = 0; axis < 3; ++axis) {
    bytes += normal_[axis].bytes();
    bytes += point_[axis].bytes();
    bytes += position_[axis].bytes();
  }
  bytes += contact_first_.bytes();
  bytes += contact_count_.bytes();
  bytes += depth_.bytes();
  bytes += feature_.bytes();
  return footprint;
}

}  // namespace winnow
