// Plays calls of partitions.

#include "core/memory/volume_columns.h"
#include "pipeline/replay/replay_state.h"

namespace winnow {
namespace {

/// Reads a struct of floats.
template <typename T>
T read_floats(ByteReader& in) noexcept {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) == alignof(float));
  T value{};
  (void)in.get_bytes(&value, sizeof value);
  return value;
}

/// Reads the alternative of a variant that has this index.
template <typename Variant, std::size_t I = 0>
Variant read_variant(ByteReader& in, std::size_t index, Column<Plane>& planes) noexcept {
  if constexpr (I < std::variant_size_v<Variant>) {
    if (index != I) return read_variant<Variant, I + 1>(in, index, planes);
    using One = std::variant_alternative_t<I, Variant>;
    if constexpr (std::is_same_v<One, std::span<const Plane>>) {
      (void)in.get_array(planes);
      return std::span<const Plane>(planes.data(), planes.size());
    } else {
      return read_floats<One>(in);
    }
  } else {
    in.fail();
    return {};
  }
}

/// Calls use(volumes) with the floats of a column as an array of volumes.
template <typename V, typename Use>
Status as_volumes(const Column<float>& floats, Use&& use) {
  return use(std::span<const V>(reinterpret_cast<const V*>(floats.data()),
                                floats.size() / (sizeof(V) / sizeof(float))));
}

/// Reads volumes of a kind, and calls use(volumes) if they are complete.
template <typename Use>
Status with_volumes(ReplayState& state, Use&& use) {
  const auto volume = state.in.get_enum(Volume::kdop26);
  const std::size_t width = volume == Volume::sphere ? 4 : column_count(volume);
  const auto count = state.in.get<std::uint64_t>();
  if (!state.in.ok() || count > state.in.rest().size() / (width * sizeof(float))) {
    return Status::invalid_argument;
  }
  if (!state.floats.resize(static_cast<std::size_t>(count) * width)) return Status::out_of_memory;
  (void)state.in.get_bytes(state.floats.data(), state.floats.size() * sizeof(float));
  switch (volume) {
    case Volume::sphere:
      return as_volumes<Sphere>(state.floats, use);
    case Volume::kdop14:
      return as_volumes<Kdop<14>>(state.floats, use);
    case Volume::kdop18:
      return as_volumes<Kdop<18>>(state.floats, use);
    case Volume::kdop26:
      return as_volumes<Kdop<26>>(state.floats, use);
    case Volume::aabb:
      break;
  }
  return as_volumes<Aabb>(state.floats, use);
}

Status insert(ReplayState& replay, ReplayedWorld& into) {
  return with_volumes(replay, [&](const auto& volumes) {
    if (!replay.in.get_array(replay.data)) return status_of(replay.in);
    if (!replay.keys.resize(volumes.size())) return Status::out_of_memory;
    return into.partition->insert(volumes, {replay.data.data(), replay.data.size()},
                                  std::span<Key>(replay.keys.data(), replay.keys.size()));
  });
}

Status update(ReplayState& replay, ReplayedWorld& of) {
  if (!replay.read_keys(*of.partition)) return status_of(replay.in);
  return with_volumes(replay, [&](const auto& volumes) {
    if (!replay.in.ok()) return status_of(replay.in);
    return of.partition->update(std::span<const Key>(replay.keys.data(), replay.keys.size()),
                                volumes);
  });
}

/// Returns the result that a query updates; if it updates none, the oldest result, cleared.
ReplayedPairs& source_query(ReplayedWorld& of, std::uint64_t number) noexcept {
  ReplayedPairs* oldest = of.pair_results.data();
  for (ReplayedPairs& one : of.pair_results) {
    if (number != 0 && one.number == number) return one;
    if (one.number < oldest->number) oldest = &one;
  }
  oldest->pairs.clear();
  oldest->events.clear();
  return *oldest;
}

Status self_pairs(ReplayState& replay, ReplayedWorld& of) {
  const auto form = replay.in.get_enum(PairForm::events);
  PairOptions pair_options;
  pair_options.order = replay.in.get_enum(Order::canonical);
  pair_options.incremental = replay.in.get_bool();
  const auto before = replay.in.get<std::uint64_t>();
  const bool follows = replay.in.get_bool();
  pair_options.predicate = replay.filter.read_passed_pairs(replay.in);
  if (!replay.in.ok()) return status_of(replay.in);
  ReplayedPairs& to = source_query(of, before);
  if (!follows && form != PairForm::buffer) to.events.clear();
  to.number = ++of.pair_queries;
  const Partition& partition = *of.partition;
  switch (form) {
    case PairForm::buffer:
      return replay.compare_if(partition.self_pairs(to.pairs, pair_options), to.pairs);
    case PairForm::buffer_and_events:
      return replay.compare_if(partition.self_pairs(to.pairs, to.events, pair_options), to.pairs,
                               to.events);
    case PairForm::events:
      break;
  }
  return replay.compare_if(partition.self_pairs(to.events, pair_options), to.events);
}

Status pairs_with(ReplayState& replay, ReplayedWorld& of) {
  const ReplayedWorld* const other = replay.world(replay.in.get<std::uint32_t>());
  PairOptions pair_options;
  pair_options.order = replay.in.get_enum(Order::canonical);
  pair_options.incremental = replay.in.get_bool();
  pair_options.predicate = replay.filter.read_passed_pairs(replay.in);
  if (!replay.in.ok() || other == nullptr || !other->partition) {
    return replay.in.ok() ? Status::invalid_argument : status_of(replay.in);
  }
  of.other_pairs.clear();
  return replay.compare_if(
      of.partition->pairs_with(*other->partition, of.other_pairs, pair_options), of.other_pairs);
}

Status cast(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  const Cast query = read_variant<Cast>(replay.in, replay.in.get<std::uint8_t>(), replay.planes);
  replay.filter.read_filter(replay.in);
  replay.filter.read_passed_objects(replay.in);
  if (!replay.in.ok()) return status_of(replay.in);
  const Partition& partition = *of.partition;
  if (call == RecordedCall::all_casts) {
    return replay.compare_if(partition.all(query, of.hits, replay.filter.filter()), of.hits);
  }
  const Answer<Hit> hit = call == RecordedCall::any_cast
                              ? partition.any(query, replay.filter.filter())
                              : partition.closest(query, replay.filter.filter());
  const Hit& found = hit;
  return replay.compare_if(hit.status, std::span<const Hit>(&found, 1));
}

Status cast_rays(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  (void)replay.in.get_array(replay.rays);
  replay.filter.read_filter(replay.in);
  replay.filter.read_passed_objects(replay.in);
  const Partition& partition = *of.partition;
  const RayBatch batch(std::span<const Ray>(replay.rays.data(), replay.rays.size()));
  if (call == RecordedCall::all_rays) {
    if (!replay.in.ok()) return status_of(replay.in);
    return replay.compare_if(partition.all(batch, of.hits, replay.filter.filter()), of.hits);
  }
  const bool has_key = replay.in.get_bool();
  const bool has_data = replay.in.get_bool();
  const bool has_t = replay.in.get_bool();
  if (!replay.in.ok()) return status_of(replay.in);
  if (!replay.keys.resize(replay.rays.size()) || !replay.data.resize(replay.rays.size()) ||
      !replay.floats.resize(replay.rays.size())) {
    return Status::out_of_memory;
  }
  const HitColumns hits{has_key ? replay.keys.data() : nullptr,
                        has_data ? replay.data.data() : nullptr,
                        has_t ? replay.floats.data() : nullptr};
  const Status answered = call == RecordedCall::any_rays
                              ? partition.any(batch, hits, replay.filter.filter())
                              : partition.closest(batch, hits, replay.filter.filter());
  return answered == Status::ok ? replay.compare(digest_of_columns(hits, replay.rays.size()))
                                : answered;
}

Status overlap(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  const Partition& partition = *of.partition;
  if (call == RecordedCall::overlap_region) {
    const Region region =
        read_variant<Region>(replay.in, replay.in.get<std::uint8_t>(), replay.planes);
    replay.filter.read_filter(replay.in);
    const auto order = replay.in.get_enum(Order::canonical);
    replay.filter.read_passed_objects(replay.in);
    if (!replay.in.ok()) return status_of(replay.in);
    return replay.compare_if(partition.overlap(region, of.objects, replay.filter.filter(), order),
                             of.objects);
  }
  return with_volumes(replay, [&](const auto& volumes) {
    replay.filter.read_filter(replay.in);
    const auto order = replay.in.get_enum(Order::canonical);
    replay.filter.read_passed_objects(replay.in);
    if constexpr (std::is_same_v<std::decay_t<decltype(volumes)>, std::span<const Aabb>>) {
      if (!replay.in.ok()) return status_of(replay.in);
      of.other_pairs.clear();
      return replay.compare_if(
          partition.overlap(volumes, of.other_pairs, replay.filter.filter(), order),
          of.other_pairs);
    } else {
      return Status::invalid_argument;
    }
  });
}

Status nearest(ReplayState& replay, ReplayedWorld& of) {
  const Aabb from = read_floats<Aabb>(replay.in);
  const auto count = static_cast<std::size_t>(replay.in.get<std::uint64_t>());
  const auto radius = replay.in.get<float>();
  replay.filter.read_filter(replay.in);
  replay.filter.read_passed_objects(replay.in);
  if (!replay.in.ok()) return status_of(replay.in);
  return replay.compare_if(
      of.partition->nearest(from, count, radius, of.hits, replay.filter.filter()), of.hits);
}

}  // namespace

Status change_partition(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  if (call == RecordedCall::make_partition) {
    PartitionOptions made{.memory = replay.options.memory, .execution = replay.options.execution};
    const StructureKind structure = read_structure(replay.in);
    made.volume = replay.in.get_enum(Volume::kdop26);
    made.fat_margin.distance = replay.in.get<float>();
    made.fat_margin.share = replay.in.get<float>();
    made.build_budget = static_cast<std::size_t>(replay.in.get<std::uint64_t>());
    if (status_of(replay.in) != Status::ok) return status_of(replay.in);
    return of.partition.emplace(structure, made).status();
  }
  Partition& partition = *of.partition;
  switch (call) {
    case RecordedCall::set_structure: {
      const StructureKind structure = read_structure(replay.in);
      return replay.in.ok() ? partition.set_structure(structure) : status_of(replay.in);
    }
    case RecordedCall::insert:
      return insert(replay, of);
    case RecordedCall::update:
      return update(replay, of);
    case RecordedCall::remove:
      return replay.read_keys(partition)
                 ? partition.remove({replay.keys.data(), replay.keys.size()})
                 : status_of(replay.in);
    case RecordedCall::clear:
      partition.clear();
      return Status::ok;
    case RecordedCall::release_memory:
      partition.release_memory();
      return Status::ok;
    case RecordedCall::set_filter:
      if (!replay.read_keys(partition) || !replay.in.get_array(replay.filters))
        return status_of(replay.in);
      return partition.set_filter({replay.keys.data(), replay.keys.size()},
                                  {replay.filters.data(), replay.filters.size()});
    case RecordedCall::refresh:
      return partition.refresh();
    case RecordedCall::self_pairs:
      return self_pairs(replay, of);
    case RecordedCall::pairs_with:
      return pairs_with(replay, of);
    case RecordedCall::closest_cast:
    case RecordedCall::any_cast:
    case RecordedCall::all_casts:
      return cast(replay, call, of);
    case RecordedCall::closest_rays:
    case RecordedCall::any_rays:
    case RecordedCall::all_rays:
      return cast_rays(replay, call, of);
    case RecordedCall::overlap_region:
    case RecordedCall::overlap_boxes:
      return overlap(replay, call, of);
    default:
      return nearest(replay, of);
  }
}

}  // namespace winnow
