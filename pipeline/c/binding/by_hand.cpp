// C functions that convert their arguments in ways of their own: structures, updates of some
// entries, pairs with or without events, and contacts, whose handle has columns to fill.

#include "core/memory/columns.h"
#include "pipeline/c/binding/results.h"

#include <winnow/core/regions.h>

#include <algorithm>

namespace winnow::c {

StructureKind to_cpp(winnow_structure_kind given) noexcept {
  const float parameter = given.parameter;
  switch (given.structure) {
    case WINNOW_LINEAR_BVH:
      return linear_bvh();
    case WINNOW_AUTOMATIC:
      return automatic();
    case WINNOW_SWEEP_AND_PRUNE:
      return sweep_and_prune();
    case WINNOW_HIERARCHICAL_GRID:
      return hierarchical_grid();
    case WINNOW_FLAT_GRID:
      return flat_grid();
    case WINNOW_STATIC_BVH:
      return static_bvh();
    case WINNOW_LOOSE_OCTREE:
      return parameter == 0.0F ? loose_octree() : loose_octree(parameter);
    case WINNOW_LOOSE_QUADTREE:
      return parameter == 0.0F ? loose_quadtree() : loose_quadtree(parameter);
    case WINNOW_BOUNDS_N_SQUARED:
      return bounds_n_squared();
    case WINNOW_N_SQUARED:
      return n_squared();
    default:
      return {};
  }
}

winnow_structure_kind structure_of(StructureKind kind) noexcept {
  winnow_structure_kind found{-1, kind.parameter()};
  for (std::int32_t i = WINNOW_LINEAR_BVH; i <= WINNOW_N_SQUARED; ++i) {
    if (to_cpp(winnow_structure_kind{i, 0.0F}).info() == kind.info()) found.structure = i;
  }
  return found;
}

namespace {

template <int K>
void write_kdop(const OrientedBox& box, float* slabs) noexcept {
  const Kdop<K> around = kdop_around<K>(box);
  std::copy(around.max.begin(), around.max.end(),
            std::copy(around.min.begin(), around.min.end(), slabs));
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_aabb_outward(const double min[3], const double max[3], const double origin[3],
                                  winnow_aabb* box) {
  if (!are_given(min, max, box)) return WINNOW_INVALID_ARGUMENT;
  const winnow::Vec3d low(min);
  const winnow::Vec3d high(max);
  *as_cpp(box) = origin == nullptr ? winnow::Aabb::outward(low, high)
                                   : winnow::Aabb::outward(low, high, winnow::Vec3d(origin));
  return WINNOW_OK;
}

winnow_status winnow_kdop_around(uint32_t k, const winnow_oriented_box* box, float* slabs) {
  winnow::OrientedBox turned;
  if (!are_given(box, slabs) || !read(box, turned)) return WINNOW_INVALID_ARGUMENT;
  if (!turned.is_valid()) return WINNOW_INVALID_BOUNDS;
  if (k == 14) {
    write_kdop<14>(turned, slabs);
  } else if (k == 18) {
    write_kdop<18>(turned, slabs);
  } else if (k == 26) {
    write_kdop<26>(turned, slabs);
  } else {
    return WINNOW_INVALID_ARGUMENT;
  }
  return WINNOW_OK;
}

const char* winnow_structure_name(winnow_structure_kind structure) {
  const std::string_view name = to_cpp(structure).name();
  return name.empty() ? "" : name.data();
}

winnow_status winnow_structure_named(const char* name, winnow_structure_kind* structure) {
  if (!are_given(name, structure)) return WINNOW_INVALID_ARGUMENT;
  const winnow_structure_kind found = structure_of(winnow::structure_named(name));
  if (found.structure < 0) return WINNOW_INVALID_ARGUMENT;
  *structure = found;
  return WINNOW_OK;
}

winnow_status winnow_pair_buffer_release(winnow_pair_buffer* buffer) {
  if (buffer == nullptr) return WINNOW_INVALID_ARGUMENT;
  buffer->value.release();
  buffer->room.release();
  return WINNOW_OK;
}

winnow_status winnow_pair_events_create_with_client_data(const winnow_memory* memory,
                                                         winnow_pair_events** events) {
  return events == nullptr ? WINNOW_INVALID_ARGUMENT : create(memory, events, true);
}

winnow_status winnow_partition_release_memory(winnow_partition* partition) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  partition->value.release_memory();
  partition->room.release();
  return answer(partition->value.status());
}

winnow_status winnow_partition_update(winnow_partition* partition, const winnow_key* keys,
                                      size_t count, const winnow_box_view* boxes,
                                      const winnow_entries* entries) {
  if (!are_given(partition, boxes) || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  if (count != boxes->count) return WINNOW_SIZE_MISMATCH;
  winnow::BoxView view;
  if (entries == nullptr) {
    const winnow::Status status = read_view(*boxes, partition->room, view);
    if (status != winnow::Status::ok) return answer(status);
    return answer(partition->value.update(as_cpp_span(keys, count), view));
  }
  const bool is_mask = entries->words != nullptr;
  if (!is_mask && !is_array(entries->numbers, entries->count)) return WINNOW_INVALID_ARGUMENT;
  const winnow::IndexSubset some =
      is_mask ? winnow::IndexSubset::masked({entries->words, entries->count})
              : winnow::IndexSubset::listed({entries->numbers, entries->count});
  const winnow::Status status = read_view(*boxes, partition->room, view, &some);
  if (status != winnow::Status::ok) return answer(status);
  return answer(partition->value.update(as_cpp_span(keys, count), view, some));
}

winnow_status winnow_partition_self_pairs(const winnow_partition* partition,
                                          winnow_pair_buffer* out, winnow_pair_events* events,
                                          const winnow_pair_options* options) {
  winnow::PairOptions own;
  if (partition == nullptr || (out == nullptr && events == nullptr) || !read(options, own)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (events == nullptr) return answer(of(partition).self_pairs(out->value, own));
  if (out == nullptr) return answer(of(partition).self_pairs(events->value, own));
  return answer(of(partition).self_pairs(out->value, events->value, own));
}

winnow::Bytes winnow_scene::body_bytes() const noexcept {
  winnow::Bytes bytes = value.footprint().bodies;
  bytes += {sizeof(*this), sizeof(*this)};
  bytes += room.bytes();
  return bytes;
}

winnow_status winnow_scene_partition(winnow_scene* scene, uint8_t state,
                                     const winnow_partition** partition) {
  winnow::BodyState which{};
  if (!are_given(scene, partition) || !read(state, which)) return WINNOW_INVALID_ARGUMENT;
  winnow_partition& view = scene->sets[state];
  const winnow::Partition* const own = scene->value.partition(which);
  view.target = own;
  *partition = own == nullptr ? nullptr : &view;
  return WINNOW_OK;
}

winnow::Bytes winnow_contacts::room_bytes() const noexcept {
  return winnow::bytes_of(data[0], data[1], whole);
}

winnow::Status winnow_contacts::look_up() noexcept {
  const bool is_whole = value.part_a().lookup().parts == nullptr;
  const std::size_t known = whole.size();
  if (!data[0].resize(value.size()) || !data[1].resize(value.size()) ||
      (is_whole && known < value.manifolds() && !whole.resize(value.manifolds()))) {
    value.clear();
    return winnow::Status::out_of_memory;
  }
  std::ranges::copy(value.data_a(), data[0].begin());
  std::ranges::copy(value.data_b(), data[1].begin());
  std::fill(whole.begin() + known, whole.end(), winnow::kWholeShape);
  return winnow::Status::ok;
}

const std::uint32_t* winnow_contacts::parts(const winnow::PartColumn& column) const noexcept {
  if (column.empty()) return nullptr;
  return column.lookup().parts != nullptr ? column.lookup().parts : whole.data();
}

winnow_status winnow_scene_collide(winnow_scene* scene, winnow_contact_level level,
                                   winnow_contacts* contacts) {
  winnow::ContactLevel own{};
  if (!are_given(scene, contacts) || !read(level, own)) return WINNOW_INVALID_ARGUMENT;
  const winnow::Status status = scene->value.collide(own, contacts->value);
  return answer(status == winnow::Status::ok ? contacts->look_up() : status);
}

winnow_status winnow_scene_load_contacts(const winnow_scene* scene, const uint8_t* bytes,
                                         size_t count, winnow_contacts* contacts) {
  if (!are_given(scene, contacts) || !is_array(bytes, count)) return WINNOW_INVALID_ARGUMENT;
  const winnow::Status status =
      scene->value.load_contacts(std::as_bytes(std::span(bytes, count)), contacts->value);
  return answer(status == winnow::Status::ok ? contacts->look_up() : status);
}
