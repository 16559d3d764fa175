#include <winnow/partitions/bounds_n_squared.h>

#include <winnow/partitions/flat_rows.h>
#include <winnow/partitions/row_mutation.h>
#include <winnow/partitions/volume_source.h>

namespace winnow {
namespace {

const FlatKernel& kernel_for(Volume volume) noexcept {
  const FlatKernels& kernels = flat_kernels();
  switch (volume) {
    case Volume::aabb:
      return kernels.aabb;
    case Volume::sphere:
      return kernels.sphere;
    case Volume::kdop14:
      return kernels.kdop14;
    case Volume::kdop18:
      return kernels.kdop18;
    case Volume::kdop26:
      return kernels.kdop26;
  }
  return kernels.aabb;
}

}  // namespace

BoundsNSquared::BoundsNSquared(const PartitionOptions& options)
    : RowPartition(options, options.volume) {}

Status BoundsNSquared::insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                              std::span<Key> keys) {
  if (volume() != Volume::sphere) return Status::unsupported_volume;
  return insert_from(SphereSource{spheres}, spheres.size(), data, keys);
}

Status BoundsNSquared::update(std::span<const Key> keys, std::span<const Sphere> spheres) {
  if (volume() != Volume::sphere) return Status::unsupported_volume;
  return update_from(SphereSource{spheres}, spheres.size(), keys);
}

template <int K>
Status BoundsNSquared::insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                              std::span<Key> keys) {
  if (volume() != kdop_volume<K>()) return Status::unsupported_volume;
  return insert_from(KdopSource<K>{kdops}, kdops.size(), data, keys);
}

template <int K>
Status BoundsNSquared::update(std::span<const Key> keys, std::span<const Kdop<K>> kdops) {
  if (volume() != kdop_volume<K>()) return Status::unsupported_volume;
  return update_from(KdopSource<K>{kdops}, kdops.size(), keys);
}

template Status BoundsNSquared::insert(std::span<const Kdop<14>>, std::span<const ClientData>,
                                       std::span<Key>);
template Status BoundsNSquared::insert(std::span<const Kdop<18>>, std::span<const ClientData>,
                                       std::span<Key>);
template Status BoundsNSquared::insert(std::span<const Kdop<26>>, std::span<const ClientData>,
                                       std::span<Key>);
template Status BoundsNSquared::update(std::span<const Key>, std::span<const Kdop<14>>);
template Status BoundsNSquared::update(std::span<const Key>, std::span<const Kdop<18>>);
template Status BoundsNSquared::update(std::span<const Key>, std::span<const Kdop<26>>);

std::size_t BoundsNSquared::regular_tasks() const noexcept {
  return flat_tasks(pool());
}

bool BoundsNSquared::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const FlatTask range(pool(), task);
  return kernel_for(volume()).self_pairs(flat_view(block_filters(), pool()), range.begin, range.end,
                                         sink);
}

bool BoundsNSquared::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return kernel_for(volume()).query(flat_view(block_filters(), pool()), batch, sink);
}

}  // namespace winnow
