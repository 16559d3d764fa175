// Plays calls of partitions.

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

}  // namespace

Status ReplayState::change_partition(RecordedCall call, ReplayedWorld& of) {
  if (call == RecordedCall::make_partition) {
    PartitionOptions made{.memory = options.memory, .execution = options.execution};
    const StructureKind structure = read_structure(in);
    made.volume = in.get_enum(Volume::kdop26);
    made.fat_margin.distance = in.get<float>();
    made.fat_margin.share = in.get<float>();
    made.build_budget = static_cast<std::size_t>(in.get<std::uint64_t>());
    if (reading() != Status::ok) return reading();
    return of.partition.emplace(structure, made).status();
  }
  Partition& partition = *of.partition;
  switch (call) {
    case RecordedCall::set_structure: {
      const StructureKind structure = read_structure(in);
      return in.ok() ? partition.set_structure(structure) : reading();
    }
    case RecordedCall::insert:
      return insert(of);
    case RecordedCall::update:
      return update(of);
    case RecordedCall::remove:
      return read_keys(partition) ? partition.remove({keys.data(), keys.size()}) : reading();
    case RecordedCall::clear:
      partition.clear();
      return Status::ok;
    case RecordedCall::release_memory:
      partition.release_memory();
      return Status::ok;
    case RecordedCall::set_filter:
      if (!read_keys(partition) || !in.get_array(filters)) return reading();
      return partition.set_filter({keys.data(), keys.size()}, {filters.data(), filters.size()});
    case RecordedCall::refresh:
      return partition.refresh();
    case RecordedCall::self_pairs:
      return self_pairs(of);
    case RecordedCall::pairs_with:
      return pairs_with(of);
    case RecordedCall::closest_cast:
    case RecordedCall::any_cast:
    case RecordedCall::all_casts:
      return cast(call, of);
    case RecordedCall::closest_rays:
    case RecordedCall::any_rays:
    case RecordedCall::all_rays:
      return cast_rays(call, of);
    case RecordedCall::overlap_region:
    case RecordedCall::overlap_boxes:
      return overlap(call, of);
    default:
      return nearest(of);
  }
}

/// Reads ids and looks up their keys. Ids without a live object become null keys, which every call
/// refuses.
bool ReplayState::read_keys(const Partition& of) {
  if (!in.get_array(ids)) return false;
  if (!keys.resize(ids.size())) return in.refuse_memory();
  for (std::size_t i = 0; i < ids.size(); ++i) keys[i] = of.key_of(ids[i]);
  return true;
}

Status ReplayState::insert(ReplayedWorld& into) {
  return with_volumes(*this, [&](const auto& volumes) {
    if (!in.get_array(data)) return reading();
    if (!keys.resize(volumes.size())) return Status::out_of_memory;
    return into.partition->insert(volumes, {data.data(), data.size()},
                                  std::span<Key>(keys.data(), keys.size()));
  });
}

Status ReplayState::update(ReplayedWorld& of) {
  if (!read_keys(*of.partition)) return reading();
  return with_volumes(*this, [&](const auto& volumes) {
    if (!in.ok()) return reading();
    return of.partition->update(std::span<const Key>(keys.data(), keys.size()), volumes);
  });
}

/// Returns the result that a query updates; if it updates none, the oldest result, cleared.
ReplayedPairs& ReplayState::source_query(ReplayedWorld& of, std::uint64_t number) noexcept {
  ReplayedPairs* oldest = of.pair_results.data();
  for (ReplayedPairs& one : of.pair_results) {
    if (number != 0 && one.number == number) return one;
    if (one.number < oldest->number) oldest = &one;
  }
  oldest->pairs.clear();
  oldest->events.clear();
  return *oldest;
}

Status ReplayState::self_pairs(ReplayedWorld& of) {
  const auto form = in.get_enum(PairForm::events);
  PairOptions pair_options;
  pair_options.order = in.get_enum(Order::canonical);
  pair_options.incremental = in.get_bool();
  const auto before = in.get<std::uint64_t>();
  const bool follows = in.get_bool();
  pair_options.predicate = filter.read_passed_pairs(in);
  if (!in.ok()) return reading();
  ReplayedPairs& to = source_query(of, before);
  if (!follows && form != PairForm::buffer) to.events.clear();
  to.number = ++of.pair_queries;
  const Partition& partition = *of.partition;
  Status answered = Status::ok;
  switch (form) {
    case PairForm::buffer:
      answered = partition.self_pairs(to.pairs, pair_options);
      return answered == Status::ok ? compare(to.pairs) : answered;
    case PairForm::buffer_and_events:
      answered = partition.self_pairs(to.pairs, to.events, pair_options);
      return answered == Status::ok ? compare(to.pairs, to.events) : answered;
    case PairForm::events:
      break;
  }
  answered = partition.self_pairs(to.events, pair_options);
  return answered == Status::ok ? compare(to.events) : answered;
}

Status ReplayState::pairs_with(ReplayedWorld& of) {
  const ReplayedWorld* const other = world(in.get<std::uint32_t>());
  PairOptions pair_options;
  pair_options.order = in.get_enum(Order::canonical);
  pair_options.incremental = in.get_bool();
  pair_options.predicate = filter.read_passed_pairs(in);
  if (!in.ok() || other == nullptr || !other->partition) {
    return in.ok() ? Status::invalid_argument : reading();
  }
  of.other_pairs.clear();
  const Status answered = of.partition->pairs_with(*other->partition, of.other_pairs, pair_options);
  return answered == Status::ok ? compare(of.other_pairs) : answered;
}

Status ReplayState::cast(RecordedCall call, ReplayedWorld& of) {
  const Cast query = read_variant<Cast>(in, in.get<std::uint8_t>(), planes);
  filter.read_filter(in);
  filter.read_passed_objects(in);
  if (!in.ok()) return reading();
  const Partition& partition = *of.partition;
  if (call == RecordedCall::all_casts) {
    const Status answered = partition.all(query, of.hits, filter.filter());
    return answered == Status::ok ? compare(of.hits) : answered;
  }
  Hit hit;
  const Status answered = call == RecordedCall::any_cast
                              ? partition.any(query, hit, filter.filter())
                              : partition.closest(query, hit, filter.filter());
  return answered == Status::ok ? compare(std::span<const Hit>(&hit, 1)) : answered;
}

Status ReplayState::cast_rays(RecordedCall call, ReplayedWorld& of) {
  (void)in.get_array(rays);
  filter.read_filter(in);
  filter.read_passed_objects(in);
  const Partition& partition = *of.partition;
  const RayBatch batch(std::span<const Ray>(rays.data(), rays.size()));
  if (call == RecordedCall::all_rays) {
    if (!in.ok()) return reading();
    const Status answered = partition.all(batch, of.hits, filter.filter());
    return answered == Status::ok ? compare(of.hits) : answered;
  }
  const bool has_key = in.get_bool();
  const bool has_data = in.get_bool();
  const bool has_t = in.get_bool();
  if (!in.ok()) return reading();
  if (!keys.resize(rays.size()) || !data.resize(rays.size()) || !floats.resize(rays.size())) {
    return Status::out_of_memory;
  }
  const HitColumns hits{has_key ? keys.data() : nullptr, has_data ? data.data() : nullptr,
                        has_t ? floats.data() : nullptr};
  const Status answered = call == RecordedCall::any_rays
                              ? partition.any(batch, hits, filter.filter())
                              : partition.closest(batch, hits, filter.filter());
  return answered == Status::ok ? compare(digest_of_columns(hits, rays.size())) : answered;
}

Status ReplayState::overlap(RecordedCall call, ReplayedWorld& of) {
  const Partition& partition = *of.partition;
  if (call == RecordedCall::overlap_region) {
    const Region region = read_variant<Region>(in, in.get<std::uint8_t>(), planes);
    filter.read_filter(in);
    const auto order = in.get_enum(Order::canonical);
    filter.read_passed_objects(in);
    if (!in.ok()) return reading();
    const Status answered = partition.overlap(region, of.objects, filter.filter(), order);
    return answered == Status::ok ? compare(of.objects) : answered;
  }
  return with_volumes(*this, [&](const auto& volumes) {
    filter.read_filter(in);
    const auto order = in.get_enum(Order::canonical);
    filter.read_passed_objects(in);
    if constexpr (std::is_same_v<std::decay_t<decltype(volumes)>, std::span<const Aabb>>) {
      if (!in.ok()) return reading();
      of.other_pairs.clear();
      const Status answered = partition.overlap(volumes, of.other_pairs, filter.filter(), order);
      return answered == Status::ok ? compare(of.other_pairs) : answered;
    } else {
      return Status::invalid_argument;
    }
  });
}

Status ReplayState::nearest(ReplayedWorld& of) {
  const Aabb from = read_floats<Aabb>(in);
  const auto count = static_cast<std::size_t>(in.get<std::uint64_t>());
  const auto radius = in.get<float>();
  filter.read_filter(in);
  filter.read_passed_objects(in);
  if (!in.ok()) return reading();
  const Status answered = of.partition->nearest(from, count, radius, of.hits, filter.filter());
  return answered == Status::ok ? compare(of.hits) : answered;
}

}  // namespace winnow
