// RecordedPartition: forwards each call to its partition, and writes successful calls to the
// recording.

#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/pair_tracker.h"
#include "pipeline/recording/recorder_state.h"

#include <type_traits>
#include <variant>

namespace winnow {
namespace {

void put_structure(CallWriter& call, StructureKind structure) {
  call.put_text(structure.name()).put(structure.parameter());
}

template <typename V>
void put_volumes(CallWriter& call, Volume volume, std::span<const V> volumes) {
  call.put(volume).put_array(volumes);
}

/// Writes the boxes of a view in the form of an array of boxes.
void put_boxes(CallWriter& call, const BoxView& boxes) {
  call.put(Volume::aabb).put(std::uint64_t{boxes.count});
  for (std::size_t i = 0; i < boxes.count; ++i) {
    const Aabb box = boxes[i];
    call.put_bytes(&box, sizeof box);
  }
}

void put_rays(CallWriter& call, const RayBatch& rays) {
  call.put(std::uint64_t{rays.count});
  for (std::size_t i = 0; i < rays.count; ++i) {
    const Ray ray = rays[i];
    call.put_bytes(&ray, sizeof ray);
  }
}

void put_cast(CallWriter& call, const Cast& cast) {
  call.put(static_cast<std::uint8_t>(cast.index()));
  std::visit([&](const auto& one) { call.put_bytes(&one, sizeof one); }, cast);
}

void put_region(CallWriter& call, const Region& region) {
  call.put(static_cast<std::uint8_t>(region.index()));
  std::visit(
      [&](const auto& one) {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, std::span<const Plane>>) {
          call.put_array(one);
        } else {
          call.put_bytes(&one, sizeof one);
        }
      },
      region);
}

// Write whether there is a predicate, and if so the results of the query. In a player, a predicate
// that accepts only these objects leads to the same results.

void put_passed(CallWriter& call, const PairPredicate& predicate, std::span<const Pair> pairs) {
  call.put(predicate.accept != nullptr);
  if (predicate.accept != nullptr) call.put_array(pairs);
}

template <typename Ids>
void put_passed(CallWriter& call, const ObjectPredicate& predicate, std::size_t count,
                const Ids& id_of) {
  call.put(predicate.accept != nullptr);
  if (predicate.accept == nullptr) return;
  call.put(std::uint64_t{count});
  for (std::size_t i = 0; i < count; ++i) call.put(ObjectId{id_of(i)});
}

void put_passed(CallWriter& call, const ObjectPredicate& predicate, std::span<const Hit> hits) {
  put_passed(call, predicate, hits.size(), [&](std::size_t i) { return hits[i].key.id; });
}

template <typename... Answer>
void put_digest(CallWriter& call, const Answer&... answer) {
  call.put(digest_of_answers(answer...).value());
}

/// Writes the end of a query for hits: its filter, accepted objects, and the digest of its results.
template <typename Answer>
void put_hits(CallWriter& call, const Filter& filter, std::span<const Hit> hits,
              const Answer& answer) {
  call.put_filter(filter);
  put_passed(call, filter.predicate, hits);
  put_digest(call, answer);
}
void put_hits(CallWriter& call, const Filter& filter, const HitBuffer& hits) {
  put_hits(call, filter, hits.hits(), hits);
}
void put_hit(CallWriter& call, const Filter& filter, const Hit& hit) {
  const std::span<const Hit> one(&hit, 1);
  put_hits(call, filter, one, one);
}

/// A query for the pairs of one partition. `before` is the number of the query whose result is in
/// the buffer; 0 if none. `follows` is set if the events contain the result of that query too.
struct RecordedPairQuery {
  PairForm form;
  std::uint64_t before;
  bool follows = false;

  RecordedPairQuery(PairForm kind, std::uint64_t number) noexcept : form(kind), before(number) {}
  RecordedPairQuery(PairForm kind, std::uint64_t number, const PairEvents& events,
                    const PairBuffer& held) noexcept
      : form(kind),
        before(number),
        follows(number != 0 && EventWriter::provenance(events) == PairTracker::provenance(held)) {}

  template <typename... Answer>
  void put(CallWriter& call, const PairOptions& options, std::span<const Pair> pairs,
           const Answer&... answer) const {
    call.put(form).put(options.order).put(options.incremental);
    call.put(before).put(follows);
    put_passed(call, options.predicate, pairs);
    put_digest(call, answer...);
  }
};

}  // namespace

RecordedPartition::RecordedPartition(Recorder& recorder, StructureKind structure,
                                     const PartitionOptions& options) noexcept
    : recorder_(recorder.state_), world_(new_world(recorder_)), partition_(structure, options) {
  if (partition_.status() != Status::ok) return;
  CallWriter call(recorder_, RecordedCall::make_partition, world_);
  put_structure(call, structure);
  call.put(options.volume).put(options.fat_margin.distance).put(options.fat_margin.share);
  call.put(std::uint64_t{options.build_budget});
}

RecordedPartition::~RecordedPartition() {
  if (partition_.status() != Status::ok) return;
  CallWriter(recorder_, RecordedCall::end_world, world_);
}

Status RecordedPartition::set_structure(StructureKind structure) {
  const Status status = partition_.set_structure(structure);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::set_structure, world_);
  put_structure(call, structure);
  return status;
}

Status RecordedPartition::insert(const BoxView& boxes, std::span<const ClientData> data,
                                 std::span<Key> keys) {
  const Status status = partition_.insert(boxes, data, keys);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::insert, world_);
  put_boxes(call, boxes);
  call.put_array(data);
  return status;
}

Answer<Key> RecordedPartition::insert(const Aabb& box, ClientData data) {
  Key key;
  const Status status = insert(BoxView(std::span<const Aabb>(&box, 1)),
                               std::span<const ClientData>(&data, 1), std::span<Key>(&key, 1));
  if (status != Status::ok) return status;
  return key;
}

Status RecordedPartition::insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                                 std::span<Key> keys) {
  const Status status = partition_.insert(spheres, data, keys);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::insert, world_);
  put_volumes(call, Volume::sphere, spheres);
  call.put_array(data);
  return status;
}

template <int K>
Status RecordedPartition::insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                                 std::span<Key> keys) {
  const Status status = partition_.insert(kdops, data, keys);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::insert, world_);
  put_volumes(call, partition_.volume(), kdops);
  call.put_array(data);
  return status;
}

Status RecordedPartition::update(std::span<const Key> keys, const BoxView& boxes) {
  const Status status = partition_.update(keys, boxes);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::update, world_);
  call.put_ids(keys);
  put_boxes(call, boxes);
  return status;
}

Status RecordedPartition::update(Key key, const Aabb& box) {
  return update(std::span<const Key>(&key, 1), BoxView(std::span<const Aabb>(&box, 1)));
}

Status RecordedPartition::update(std::span<const Key> keys, const BoxView& boxes,
                                 const IndexSubset& entries) {
  const Status status = partition_.update(keys, boxes, entries);
  if (status != Status::ok) return status;
  const auto for_each = [&](const auto& visit) {
    if (!entries.is_mask()) {
      for (const std::uint32_t number : entries.indices()) visit(number);
      return;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if ((entries.words()[i / 64] >> i % 64 & 1U) != 0) visit(i);
    }
  };
  std::uint64_t count = 0;
  for_each([&](std::size_t) { ++count; });
  CallWriter call(recorder_, RecordedCall::update, world_);
  call.put(count);
  for_each([&](std::size_t i) { call.put(keys[i].id); });
  call.put(Volume::aabb).put(count);
  for_each([&](std::size_t i) {
    const Aabb box = boxes[i];
    call.put_bytes(&box, sizeof box);
  });
  return status;
}

Status RecordedPartition::update(std::span<const Key> keys, std::span<const Sphere> spheres) {
  const Status status = partition_.update(keys, spheres);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::update, world_);
  call.put_ids(keys);
  put_volumes(call, Volume::sphere, spheres);
  return status;
}

template <int K>
Status RecordedPartition::update(std::span<const Key> keys, std::span<const Kdop<K>> kdops) {
  const Status status = partition_.update(keys, kdops);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::update, world_);
  call.put_ids(keys);
  put_volumes(call, partition_.volume(), kdops);
  return status;
}

template WINNOW_API Status RecordedPartition::insert(std::span<const Kdop<14>>,
                                                     std::span<const ClientData>, std::span<Key>);
template WINNOW_API Status RecordedPartition::insert(std::span<const Kdop<18>>,
                                                     std::span<const ClientData>, std::span<Key>);
template WINNOW_API Status RecordedPartition::insert(std::span<const Kdop<26>>,
                                                     std::span<const ClientData>, std::span<Key>);
template WINNOW_API Status RecordedPartition::update(std::span<const Key>,
                                                     std::span<const Kdop<14>>);
template WINNOW_API Status RecordedPartition::update(std::span<const Key>,
                                                     std::span<const Kdop<18>>);
template WINNOW_API Status RecordedPartition::update(std::span<const Key>,
                                                     std::span<const Kdop<26>>);

Status RecordedPartition::remove(std::span<const Key> keys) {
  const Status status = partition_.remove(keys);
  if (status != Status::ok) return status;
  CallWriter(recorder_, RecordedCall::remove, world_).put_ids(keys);
  return status;
}

Status RecordedPartition::remove(Key key) {
  return remove(std::span<const Key>(&key, 1));
}

void RecordedPartition::clear() noexcept {
  partition_.clear();
  CallWriter(recorder_, RecordedCall::clear, world_);
}

void RecordedPartition::release_memory() noexcept {
  partition_.release_memory();
  CallWriter(recorder_, RecordedCall::release_memory, world_);
}

Status RecordedPartition::set_filter(std::span<const Key> keys,
                                     std::span<const ObjectFilter> filters) {
  const Status status = partition_.set_filter(keys, filters);
  if (status != Status::ok) return status;
  CallWriter(recorder_, RecordedCall::set_filter, world_).put_ids(keys).put_array(filters);
  return status;
}

Status RecordedPartition::set_filter(Key key, const ObjectFilter& filter) {
  return set_filter(std::span<const Key>(&key, 1), std::span<const ObjectFilter>(&filter, 1));
}

Status RecordedPartition::refresh() const {
  const Status status = partition_.refresh();
  if (status == Status::ok) CallWriter(recorder_, RecordedCall::refresh, world_);
  return status;
}

// A pair query updates the pairs in its buffer. The order of its results depends on which query
// filled the buffer, and on whether that query also filled the events.

std::uint64_t RecordedPartition::source_query(const PairBuffer& out) const noexcept {
  const PairBuffer::Provenance held = PairTracker::provenance(out);
  for (std::uint64_t number = pair_queries_; held.serial != 0 && number != 0; --number) {
    if (number + kPairHistory == pair_queries_) break;
    if (provenances_[number % kPairHistory] == held) return number;
  }
  return 0;
}

void RecordedPartition::store_provenance(const PairBuffer& out) const noexcept {
  provenances_[++pair_queries_ % kPairHistory] = PairTracker::provenance(out);
}

Status RecordedPartition::self_pairs(PairBuffer& out, const PairOptions& options) const {
  const RecordedPairQuery query(PairForm::buffer, source_query(out));
  const Status status = partition_.self_pairs(out, options);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::self_pairs, world_);
  query.put(call, options, out.pairs(), out);
  store_provenance(out);
  return status;
}

Status RecordedPartition::self_pairs(PairBuffer& out, PairEvents& events,
                                     const PairOptions& options) const {
  const RecordedPairQuery query(PairForm::buffer_and_events, source_query(out), events, out);
  const Status status = partition_.self_pairs(out, events, options);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::self_pairs, world_);
  query.put(call, options, out.pairs(), out, events);
  store_provenance(out);
  return status;
}

Status RecordedPartition::self_pairs(PairEvents& events, const PairOptions& options) const {
  const PairBuffer& own = EventWriter::own_buffer(events);
  const RecordedPairQuery query(PairForm::events, source_query(own), events, own);
  const Status status = partition_.self_pairs(events, options);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::self_pairs, world_);
  query.put(call, options, own.pairs(), events);
  store_provenance(own);
  return status;
}

Status RecordedPartition::pairs_with(const RecordedPartition& other, PairBuffer& out,
                                     const PairOptions& options) const {
  const Status status = partition_.pairs_with(other.partition_, out, options);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::pairs_with, world_);
  call.put(other.world_).put(options.order).put(options.incremental);
  put_passed(call, options.predicate, out.pairs());
  put_digest(call, out);
  return status;
}

Answer<Hit> RecordedPartition::closest(const Cast& cast, const Filter& filter) const {
  const Answer<Hit> hit = partition_.closest(cast, filter);
  if (hit.status != Status::ok) return hit;
  CallWriter call(recorder_, RecordedCall::closest_cast, world_);
  put_cast(call, cast);
  put_hit(call, filter, hit);
  return hit;
}

Answer<Hit> RecordedPartition::any(const Cast& cast, const Filter& filter) const {
  const Answer<Hit> hit = partition_.any(cast, filter);
  if (hit.status != Status::ok) return hit;
  CallWriter call(recorder_, RecordedCall::any_cast, world_);
  put_cast(call, cast);
  put_hit(call, filter, hit);
  return hit;
}

Status RecordedPartition::all(const Cast& cast, HitBuffer& hits, const Filter& filter) const {
  const Status status = partition_.all(cast, hits, filter);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::all_casts, world_);
  put_cast(call, cast);
  put_hits(call, filter, hits);
  return status;
}

Status RecordedPartition::closest(const RayBatch& rays, const HitColumns& hits,
                                  const Filter& filter) const {
  const Status status = partition_.closest(rays, hits, filter);
  if (status == Status::ok) record(RecordedCall::closest_rays, rays, hits, filter);
  return status;
}

Status RecordedPartition::any(const RayBatch& rays, const HitColumns& hits,
                              const Filter& filter) const {
  const Status status = partition_.any(rays, hits, filter);
  if (status == Status::ok) record(RecordedCall::any_rays, rays, hits, filter);
  return status;
}

Status RecordedPartition::all(const RayBatch& rays, HitBuffer& hits, const Filter& filter) const {
  const Status status = partition_.all(rays, hits, filter);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::all_rays, world_);
  put_rays(call, rays);
  put_hits(call, filter, hits);
  return status;
}

Status RecordedPartition::overlap(const Region& region, OverlapBuffer& objects,
                                  const Filter& filter, Order order) const {
  const Status status = partition_.overlap(region, objects, filter, order);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::overlap_region, world_);
  put_region(call, region);
  call.put_filter(filter);
  call.put(order);
  const std::span<const ObjectId> ids = objects.ids();
  put_passed(call, filter.predicate, ids.size(), [&](std::size_t i) { return ids[i]; });
  put_digest(call, objects);
  return status;
}

Status RecordedPartition::overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter,
                                  Order order) const {
  const Status status = partition_.overlap(boxes, out, filter, order);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::overlap_boxes, world_);
  put_boxes(call, boxes);
  call.put_filter(filter);
  call.put(order);
  put_passed(call, filter.predicate, out.size(), [&](std::size_t i) { return out[i].second; });
  put_digest(call, out);
  return status;
}

Status RecordedPartition::nearest(const Aabb& from, std::size_t count, float radius,
                                  HitBuffer& hits, const Filter& filter) const {
  const Status status = partition_.nearest(from, count, radius, hits, filter);
  if (status != Status::ok) return status;
  CallWriter call(recorder_, RecordedCall::nearest, world_);
  call.put_bytes(&from, sizeof from).put(std::uint64_t{count}).put(radius);
  put_hits(call, filter, hits);
  return status;
}

/// Records the results of a batch of rays. A query with a predicate but without a column of keys is
/// not recorded, because the accepted objects are unknown.
void RecordedPartition::record(RecordedCall kind, const RayBatch& rays, const HitColumns& hits,
                               const Filter& filter) const {
  if (filter.predicate.accept != nullptr && hits.key == nullptr) return;
  CallWriter call(recorder_, kind, world_);
  put_rays(call, rays);
  call.put_filter(filter);
  put_passed(call, filter.predicate, rays.count, [&](std::size_t i) { return hits.key[i].id; });
  call.put(hits.key != nullptr).put(hits.data != nullptr).put(hits.t != nullptr);
  call.put(digest_of_columns(hits, rays.count).value());
}

}  // namespace winnow
