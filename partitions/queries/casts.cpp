#include <winnow/partitions/row_partition.h>
namespace winnow {
Status RowPartition::closest(const Cast&, Hit&, const Filter&) const {
  return Status::unsupported_volume;
}
Status RowPartition::any(const Cast&, Hit&, const Filter&) const {
  return Status::unsupported_volume;
}
Status RowPartition::all(const Cast&, HitBuffer&, const Filter&) const {
  return Status::unsupported_volume;
}
Status RowPartition::closest(const RayBatch&, const HitColumns&, const Filter&) const {
  return Status::unsupported_volume;
}
Status RowPartition::any(const RayBatch&, const HitColumns&, const Filter&) const {
  return Status::unsupported_volume;
}
Status RowPartition::all(const RayBatch&, HitBuffer&, const Filter&) const {
  return Status::unsupported_volume;
}
}  // namespace winnow
