#include <winnow/partitions/row_partition.h>
namespace winnow {
Status RowPartition::overlap(const Region&, OverlapBuffer&, const Filter&, Order) const {
  return Status::unsupported_volume;
}
Status RowPartition::overlap(const BoxView&, PairBuffer&, const Filter&, Order) const {
  return Status::unsupported_volume;
}
}  // namespace winnow
