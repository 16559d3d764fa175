#include <winnow/partitions/row_partition.h>
namespace winnow {
Status RowPartition::set_filter(std::span<const Key>, std::span<const ObjectFilter>) {
  return Status::unsupported_volume;
}
Status RowPartition::set_filter(Key, const ObjectFilter&) {
  return Status::unsupported_volume;
}
Status RowPartition::filter(Key, ObjectFilter&) const noexcept {
  return Status::unsupported_volume;
}
Status RowPartition::self_pairs(PairBuffer&, PairEvents&, const PairOptions&) const {
  return Status::unsupported_volume;
}
}  // namespace winnow
