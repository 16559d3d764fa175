#include <winnow/partitions/row_partition.h>
namespace winnow {
Status RowPartition::debug_draw(DebugDraw&, const DebugDrawOptions&) const {
  return Status::unsupported_volume;
}
}  // namespace winnow
