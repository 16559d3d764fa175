// C binding of Partition: options, objects and state. Queries are in partition_queries.cpp.

#include <winnow/c/partition.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/structures.h"
#include "pipeline/c/binding/views.h"

#include <winnow/core/kdop.h>

namespace winnow::c {

StructureKind structure_of(winnow_structure_kind given) noexcept {
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
      return given.parameter == 0.0F ? loose_octree() : loose_octree(given.parameter);
    case WINNOW_LOOSE_QUADTREE:
      return given.parameter == 0.0F ? loose_quadtree() : loose_quadtree(given.parameter);
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
    if (structure_of({i, 0.0F}).info() == kind.info()) found.structure = i;
  }
  return found;
}

bool read_options(const winnow_partition_options* given, const winnow_memory*& memory,
                  PartitionOptions& options) noexcept {
  winnow_partition_options own{};
  if (!read_sized(given, own) || !read_execution(own.execution, options.execution) ||
      !read_choice(own.volume, Volume::kdop26, options.volume)) {
    return false;
  }
  memory = own.memory;
  options.fat_margin = {own.fat_margin.distance, own.fat_margin.share};
  options.build_budget = own.build_budget;
  return true;
}

namespace {

[[nodiscard]] std::span<const ClientData> data_of(const uint64_t* data,
                                                  std::size_t count) noexcept {
  return {data, data == nullptr ? 0 : count};
}

[[nodiscard]] IndexSubset entries_of(const winnow_entries& given) noexcept {
  return given.words != nullptr ? IndexSubset::masked({given.words, given.count})
                                : IndexSubset::listed({given.numbers, given.count});
}

/// Calls `use` with the array as K-DOPs of compile-time K, if `k` is a valid one.
template <typename Use>
[[nodiscard]] Status with_kdops(std::uint32_t k, const float* kdops, std::size_t count,
                                Use&& use) noexcept {
  const auto of = [&]<int K>() {
    static_assert(sizeof(Kdop<K>) == K * sizeof(float));
    return use(std::span(reinterpret_cast<const Kdop<K>*>(kdops), count));
  };
  if (k == 14) return of.template operator()<14>();
  if (k == 18) return of.template operator()<18>();
  if (k == 26) return of.template operator()<26>();
  return Status::invalid_argument;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

const char* winnow_structure_name(winnow_structure_kind structure) {
  const std::string_view name = structure_of(structure).name();
  return name.empty() ? "" : name.data();
}

winnow_status winnow_structure_named(const char* name, winnow_structure_kind* structure) {
  if (!are_given(name, structure)) return WINNOW_INVALID_ARGUMENT;
  const winnow_structure_kind found = structure_of(winnow::structure_named(name));
  if (found.structure < 0) return WINNOW_INVALID_ARGUMENT;
  *structure = found;
  return WINNOW_OK;
}

winnow_status winnow_partition_create(winnow_structure_kind structure,
                                      const winnow_partition_options* options,
                                      winnow_partition** partition) {
  winnow::PartitionOptions read;
  const winnow_memory* memory = nullptr;
  if (partition == nullptr || !read_options(options, memory, read)) return WINNOW_INVALID_ARGUMENT;
  winnow_partition* made = nullptr;
  winnow_status status = create(memory, &made, structure_of(structure), read);
  if (status != WINNOW_OK) return status;
  status = answer(made->value.status());
  if (status == WINNOW_OK) {
    *partition = made;
  } else {
    destroy(made);
  }
  return status;
}

void winnow_partition_destroy(winnow_partition* partition) {
  destroy(partition);
}

winnow_status winnow_partition_structure(const winnow_partition* partition,
                                         winnow_structure_kind* structure) {
  if (!are_given(partition, structure)) return WINNOW_INVALID_ARGUMENT;
  *structure = structure_of(partition->target->structure());
  return WINNOW_OK;
}

winnow_status winnow_partition_set_structure(winnow_partition* partition,
                                             winnow_structure_kind structure) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->value.set_structure(structure_of(structure)));
}

winnow_status winnow_partition_choice(const winnow_partition* partition,
                                      winnow_structure_choice* choice) {
  if (partition == nullptr || !is_sized(choice)) return WINNOW_INVALID_ARGUMENT;
  const winnow::StructureChoice chosen = partition->target->choice();
  const winnow::SceneFeatures& scene = chosen.features;
  write_sized({0,
               structure_of(chosen.structure),
               chosen.reason.empty() ? "" : chosen.reason.data(),
               chosen.changes,
               scene.objects,
               {scene.room[0], scene.room[1], scene.room[2]},
               scene.size_spread,
               scene.crowding,
               scene.pairs},
              *choice);
  return WINNOW_OK;
}

winnow_status winnow_partition_is_exact(const winnow_partition* partition, bool* is_exact) {
  if (!are_given(partition, is_exact)) return WINNOW_INVALID_ARGUMENT;
  *is_exact = partition->target->is_exact();
  return WINNOW_OK;
}

winnow_status winnow_partition_volume(const winnow_partition* partition, winnow_volume* volume) {
  if (!are_given(partition, volume)) return WINNOW_INVALID_ARGUMENT;
  *volume = static_cast<winnow_volume>(partition->target->volume());
  return WINNOW_OK;
}

winnow_status winnow_partition_fat_margin(const winnow_partition* partition,
                                          winnow_fat_margin* fat_margin) {
  if (!are_given(partition, fat_margin)) return WINNOW_INVALID_ARGUMENT;
  const winnow::FatMargin own = partition->target->fat_margin();
  *fat_margin = {own.distance, own.share};
  return WINNOW_OK;
}

winnow_status winnow_partition_insert(winnow_partition* partition, const winnow_box_view* boxes,
                                      const uint64_t* data, winnow_key* keys) {
  if (!are_given(partition, boxes) || !is_array(keys, boxes->count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow::BoxView view;
  const winnow::Status status = read_boxes(boxes, nullptr, partition->room, view);
  if (status != winnow::Status::ok) return answer(status);
  return answer(
      partition->value.insert(view, data_of(data, boxes->count), as_cpp_span(keys, boxes->count)));
}

winnow_status winnow_partition_update(winnow_partition* partition, const winnow_key* keys,
                                      size_t count, const winnow_box_view* boxes,
                                      const winnow_entries* entries) {
  if (!are_given(partition, boxes) || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  if (count != boxes->count) return WINNOW_SIZE_MISMATCH;
  if (entries != nullptr && entries->words == nullptr &&
      !is_array(entries->numbers, entries->count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow::BoxView view;
  if (entries == nullptr) {
    const winnow::Status status = read_boxes(boxes, nullptr, partition->room, view);
    if (status != winnow::Status::ok) return answer(status);
    return answer(partition->value.update(as_cpp_span(keys, count), view));
  }
  const winnow::IndexSubset some = entries_of(*entries);
  const winnow::Status status = read_boxes(boxes, &some, partition->room, view);
  if (status != winnow::Status::ok) return answer(status);
  return answer(partition->value.update(as_cpp_span(keys, count), view, some));
}

winnow_status winnow_partition_insert_spheres(winnow_partition* partition,
                                              const winnow_sphere* spheres, size_t count,
                                              const uint64_t* data, winnow_key* keys) {
  if (partition == nullptr || !is_array(spheres, count) || !is_array(keys, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->value.insert(as_cpp_span(spheres, count), data_of(data, count),
                                        as_cpp_span(keys, count)));
}

winnow_status winnow_partition_update_spheres(winnow_partition* partition, const winnow_key* keys,
                                              const winnow_sphere* spheres, size_t count) {
  if (partition == nullptr || !is_array(spheres, count) || !is_array(keys, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->value.update(as_cpp_span(keys, count), as_cpp_span(spheres, count)));
}

winnow_status winnow_partition_insert_kdops(winnow_partition* partition, uint32_t k,
                                            const float* kdops, size_t count, const uint64_t* data,
                                            winnow_key* keys) {
  if (partition == nullptr || !is_array(kdops, count) || !is_array(keys, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(with_kdops(k, kdops, count, [&](auto given) {
    return partition->value.insert(given, data_of(data, count), as_cpp_span(keys, count));
  }));
}

winnow_status winnow_partition_update_kdops(winnow_partition* partition, uint32_t k,
                                            const winnow_key* keys, const float* kdops,
                                            size_t count) {
  if (partition == nullptr || !is_array(kdops, count) || !is_array(keys, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(with_kdops(k, kdops, count, [&](auto given) {
    return partition->value.update(as_cpp_span(keys, count), given);
  }));
}

winnow_status winnow_partition_remove(winnow_partition* partition, const winnow_key* keys,
                                      size_t count) {
  if (partition == nullptr || !is_array(keys, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->value.remove(as_cpp_span(keys, count)));
}

winnow_status winnow_partition_clear(winnow_partition* partition) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  partition->value.clear();
  return answer(partition->value.status());
}

winnow_status winnow_partition_release_memory(winnow_partition* partition) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  partition->value.release_memory();
  partition->room.release();
  return answer(partition->value.status());
}

winnow_status winnow_partition_reserve(winnow_partition* partition, size_t objects,
                                       winnow_pages pages) {
  winnow::Pages touch{};
  if (partition == nullptr || !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->value.reserve(objects, touch));
}

winnow_status winnow_partition_size(const winnow_partition* partition, size_t* size) {
  if (!are_given(partition, size)) return WINNOW_INVALID_ARGUMENT;
  *size = partition->target->size();
  return WINNOW_OK;
}

winnow_status winnow_partition_contains(const winnow_partition* partition, winnow_key key,
                                        bool* contains) {
  if (!are_given(partition, contains)) return WINNOW_INVALID_ARGUMENT;
  *contains = partition->target->contains(*as_cpp(&key));
  return WINNOW_OK;
}

winnow_status winnow_partition_bounds(const winnow_partition* partition, winnow_key key,
                                      winnow_aabb* box) {
  if (!are_given(partition, box)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->bounds(*as_cpp(&key)), as_cpp(box));
}

winnow_status winnow_partition_bounds_of(const winnow_partition* partition, const winnow_key* keys,
                                         winnow_aabb* boxes, size_t count) {
  if (partition == nullptr || !is_array(keys, count) || !is_array(boxes, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->target->bounds(as_cpp_span(keys, count), as_cpp_span(boxes, count)));
}

winnow_status winnow_partition_client_data(const winnow_partition* partition, winnow_key key,
                                           uint64_t* data) {
  if (!are_given(partition, data)) return WINNOW_INVALID_ARGUMENT;
  if (!partition->target->contains(*as_cpp(&key))) return WINNOW_INVALID_KEY;
  *data = partition->target->client_data(*as_cpp(&key));
  return WINNOW_OK;
}

winnow_status winnow_partition_key_of(const winnow_partition* partition, uint32_t id,
                                      winnow_key* key) {
  if (!are_given(partition, key)) return WINNOW_INVALID_ARGUMENT;
  *as_cpp(key) = partition->target->key_of(id);
  return WINNOW_OK;
}

winnow_status winnow_partition_set_filter(winnow_partition* partition, const winnow_key* keys,
                                          const winnow_object_filter* filters, size_t count) {
  if (partition == nullptr || !is_array(keys, count) || !is_array(filters, count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->value.set_filter(as_cpp_span(keys, count), as_cpp_span(filters, count)));
}

winnow_status winnow_partition_filter(const winnow_partition* partition, winnow_key key,
                                      winnow_object_filter* filter) {
  if (!are_given(partition, filter)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->filter(*as_cpp(&key)), as_cpp(filter));
}

winnow_status winnow_partition_footprint(const winnow_partition* partition,
                                         winnow_footprint* footprint) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(partition, partition->target->footprint(), partition->room.bytes(),
                         footprint);
}

winnow_status winnow_partition_statistics(const winnow_partition* partition,
                                          winnow_statistics* statistics) {
  if (partition == nullptr || !is_sized(statistics)) return WINNOW_INVALID_ARGUMENT;
  const winnow::Statistics own = partition->target->statistics();
  write_sized({0, own.objects, own.regular, own.irregular, own.cells, own.depth, own.levels,
               own.builds, own.planned_builds, own.refits, own.full_queries,
               own.incremental_queries, own.last_tests, own.last_pairs},
              *statistics);
  return WINNOW_OK;
}
