#include <winnow/partitions/row_partition.h>
namespace winnow {
Status RowPartition::nearest(const Aabb&, std::size_t, float, HitBuffer&, const Filter&) const {
  return Status::unsupported_volume;
}
}  // namespace winnow
