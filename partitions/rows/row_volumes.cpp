// RowPartition: spheres and k-DOPs from the caller.

#include "partitions/rows/row_mutation.h"
#include "partitions/rows/volume_source.h"

namespace winnow {

Status RowPartition::insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                            std::span<Key> keys) {
  if (volume() != Volume::sphere) return Status::unsupported_volume;
  return insert_from(SphereSource{spheres}, spheres.size(), data, keys);
}

Status RowPartition::update(std::span<const Key> keys, std::span<const Sphere> spheres) {
  if (volume() != Volume::sphere) return Status::unsupported_volume;
  return update_from(SphereSource{spheres}, spheres.size(), keys);
}

template <int K>
Status RowPartition::insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                            std::span<Key> keys) {
  if (volume() != kdop_volume<K>()) return Status::unsupported_volume;
  return insert_from(KdopSource<K>{kdops}, kdops.size(), data, keys);
}

template <int K>
Status RowPartition::update(std::span<const Key> keys, std::span<const Kdop<K>> kdops) {
  if (volume() != kdop_volume<K>()) return Status::unsupported_volume;
  return update_from(KdopSource<K>{kdops}, kdops.size(), keys);
}

template Status RowPartition::insert(std::span<const Kdop<14>>, std::span<const ClientData>,
                                     std::span<Key>);
template Status RowPartition::insert(std::span<const Kdop<18>>, std::span<const ClientData>,
                                     std::span<Key>);
template Status RowPartition::insert(std::span<const Kdop<26>>, std::span<const ClientData>,
                                     std::span<Key>);
template Status RowPartition::update(std::span<const Key>, std::span<const Kdop<14>>);
template Status RowPartition::update(std::span<const Key>, std::span<const Kdop<18>>);
template Status RowPartition::update(std::span<const Key>, std::span<const Kdop<26>>);

}  // namespace winnow
