// Writes the calls of a partition to a recording.

#include "partitions/state/partition_observer.h"
#include "pipeline/recording/recorder_state.h"

#include <type_traits>
#include <variant>

namespace winnow {
namespace {

CallWriter& put_structure(CallWriter& call, StructureKind structure) {
  return call.put_text(structure.name()).put(structure.parameter());
}

CallWriter& put_box(CallWriter& call, const Aabb& box) {
  return call.put_bytes(&box, sizeof box);
}

/// Writes an array of volumes.
CallWriter& put_volumes(CallWriter& call, const GivenVolumes& volumes) {
  call.put(volumes.volume).put(std::uint64_t{volumes.count});
  for (std::size_t i = 0; i < volumes.boxes.count; ++i) put_box(call, volumes.boxes[i]);
  return call.put_bytes(volumes.bytes.data(), volumes.bytes.size());
}

/// Calls visit(index) for each of `count` entries that is in the subset.
template <typename Visit>
void for_each_in(const IndexSubset& entries, std::size_t count, Visit&& visit) {
  if (!entries.is_mask) {
    for (const std::uint32_t index : entries.indices) visit(index);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if ((entries.words[i / 64] >> i % 64 & 1U) != 0) visit(i);
  }
}

CallWriter& put_rays(CallWriter& call, const RayBatch& rays) {
  call.put(std::uint64_t{rays.count});
  for (std::size_t i = 0; i < rays.count; ++i) {
    const Ray ray = rays[i];
    call.put_bytes(&ray, sizeof ray);
  }
  return call;
}

CallWriter& put_cast(CallWriter& call, const Cast& cast) {
  call.put(static_cast<std::uint8_t>(cast.index()));
  std::visit([&](const auto& one) { call.put_bytes(&one, sizeof one); }, cast);
  return call;
}

CallWriter& put_region(CallWriter& call, const Region& region) {
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
  return call;
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

template <typename Results>
void put_digest(CallWriter& call, const Results& results) {
  call.put(digest_of_answers(results).value());
}

/// Writes the end of a query for hits: its filter, accepted objects, and the digest of its results.
template <typename Results>
void put_hits(CallWriter& call, const Filter& filter, std::span<const Hit> hits,
              const Results& results) {
  call.put_filter(filter.object());
  put_passed(call, filter.predicate, hits.size(), [&](std::size_t i) { return hits[i].key.id; });
  put_digest(call, results);
}
void put_hits(CallWriter& call, const Filter& filter, const HitBuffer& hits) {
  put_hits(call, filter, hits.hits(), hits);
}

/// The recording of one partition.
class PartitionRecording final : public PartitionObserver {
 public:
  PartitionRecording(RecorderState& recorder, std::uint32_t number) noexcept
      : recorder_(recorder), number_(number) {}

  void begin(StructureKind structure, const PartitionOptions& options) noexcept;
  void end() noexcept override {
    write(RecordedCall::end_world);
    recorder_.destroy(this);
  }
  void give_up() noexcept override { recorder_.stop(Status::unsupported); }

  void set_structure(StructureKind structure) noexcept override {
    CallWriter call = write(RecordedCall::set_structure);
    put_structure(call, structure);
  }
  void insert(const GivenVolumes& volumes, std::span<const ClientData> data) noexcept override {
    CallWriter call = write(RecordedCall::insert);
    put_volumes(call, volumes).put_array(data);
  }
  void update(std::span<const Key> keys, const GivenVolumes& volumes) noexcept override {
    CallWriter call = write(RecordedCall::update);
    put_volumes(call.put_ids(keys), volumes);
  }
  void update(std::span<const Key> keys, const BoxView& boxes,
              const IndexSubset& entries) noexcept override;
  void remove(std::span<const Key> keys) noexcept override {
    write(RecordedCall::remove).put_ids(keys);
  }
  void clear() noexcept override { write(RecordedCall::clear); }
  void release_memory() noexcept override { write(RecordedCall::release_memory); }
  void set_filter(std::span<const Key> keys,
                  std::span<const ObjectFilter> filters) noexcept override {
    write(RecordedCall::set_filter).put_ids(keys).put_array(filters);
  }
  void refresh() noexcept override { write(RecordedCall::refresh); }

  void self_pairs(const PairOptions& options, const ObservedPairQuery& query) noexcept override;
  void pairs_with(PartitionObserver* other, const PairOptions& options,
                  const PairBuffer& out) noexcept override;
  void closest(const Cast& cast, const Filter& filter, const Hit& hit) noexcept override {
    write_cast(RecordedCall::closest_cast, cast, filter, hit);
  }
  void any(const Cast& cast, const Filter& filter, const Hit& hit) noexcept override {
    write_cast(RecordedCall::any_cast, cast, filter, hit);
  }
  void all(const Cast& cast, const Filter& filter, const HitBuffer& hits) noexcept override {
    CallWriter call = write(RecordedCall::all_casts);
    put_hits(put_cast(call, cast), filter, hits);
  }
  void closest(const RayBatch& rays, const Filter& filter,
               const HitColumns& hits) noexcept override {
    write_rays(RecordedCall::closest_rays, rays, filter, hits);
  }
  void any(const RayBatch& rays, const Filter& filter, const HitColumns& hits) noexcept override {
    write_rays(RecordedCall::any_rays, rays, filter, hits);
  }
  void all(const RayBatch& rays, const Filter& filter, const HitBuffer& hits) noexcept override {
    CallWriter call = write(RecordedCall::all_rays);
    put_hits(put_rays(call, rays), filter, hits);
  }
  void overlap(const Region& region, const Filter& filter, Order order,
               const OverlapBuffer& objects) noexcept override;
  void overlap(const BoxView& boxes, const Filter& filter, Order order,
               const PairBuffer& out) noexcept override;
  void nearest(const Aabb& from, std::size_t count, float radius, const Filter& filter,
               const HitBuffer& hits) noexcept override;

 private:
  /// Begins a call, which is complete when the returned object is destroyed.
  CallWriter write(RecordedCall call) noexcept { return {recorder_, call, number_}; }
  void write_cast(RecordedCall kind, const Cast& cast, const Filter& filter,
                  const Hit& hit) noexcept;
  void write_rays(RecordedCall kind, const RayBatch& rays, const Filter& filter,
                  const HitColumns& hits) noexcept;
  [[nodiscard]] std::uint64_t number_of(PairBuffer::Provenance query) const noexcept;

  RecorderState& recorder_;
  const std::uint32_t number_;
  /// The last pair queries; query i is at i % kPairHistory. Protected by `self_pairs_mutex`.
  static constexpr std::size_t kPairHistory = 16;
  PairBuffer::Provenance last_queries_[kPairHistory];
  std::uint64_t pair_queries_ = 0;
};

void PartitionRecording::begin(StructureKind structure, const PartitionOptions& options) noexcept {
  CallWriter call = write(RecordedCall::make_partition);
  put_structure(call, structure)
      .put(options.volume)
      .put(options.fat_margin.distance)
      .put(options.fat_margin.share)
      .put(std::uint64_t{options.build_budget});
}

void PartitionRecording::update(std::span<const Key> keys, const BoxView& boxes,
                                const IndexSubset& entries) noexcept {
  std::uint64_t count = 0;
  for_each_in(entries, keys.size(), [&](std::size_t) { ++count; });
  CallWriter call = write(RecordedCall::update);
  call.put(count);
  for_each_in(entries, keys.size(), [&](std::size_t i) { call.put(keys[i].id); });
  call.put(Volume::aabb).put(count);
  for_each_in(entries, keys.size(), [&](std::size_t i) { put_box(call, boxes[i]); });
}

/// Returns the number of a recorded pair query; 0 if it is none of the last kPairHistory queries.
std::uint64_t PartitionRecording::number_of(PairBuffer::Provenance query) const noexcept {
  for (std::uint64_t number = pair_queries_; query.serial != 0 && number != 0; --number) {
    if (number + kPairHistory == pair_queries_) break;
    if (last_queries_[number % kPairHistory] == query) return number;
  }
  return 0;
}

// A pair query updates the pairs in its buffer. The order of its results depends on which query
// filled the buffer, and on whether that query also filled the events.
void PartitionRecording::self_pairs(const PairOptions& options,
                                    const ObservedPairQuery& query) noexcept {
  const std::uint64_t before = number_of(query.pairs_before);
  const bool follows =
      query.events != nullptr && before != 0 && query.events_before == query.pairs_before;
  CallWriter call = write(RecordedCall::self_pairs);
  call.put(query.form).put(options.order).put(options.incremental).put(before).put(follows);
  put_passed(call, options.predicate, query.pairs.pairs());
  Digest digest;
  if (query.form != PairForm::events) add_to(digest, query.pairs);
  if (query.form != PairForm::buffer) add_to(digest, *query.events);
  call.put(digest.value());
  last_queries_[++pair_queries_ % kPairHistory] = PairTracker::provenance(query.pairs);
}

void PartitionRecording::pairs_with(PartitionObserver* other, const PairOptions& options,
                                    const PairBuffer& out) noexcept {
  auto* const second = static_cast<PartitionRecording*>(other);
  if (second == nullptr || &second->recorder_ != &recorder_) {
    give_up();
    if (second != nullptr) second->give_up();
    return;
  }
  CallWriter call = write(RecordedCall::pairs_with);
  call.put(second->number_).put(options.order).put(options.incremental);
  put_passed(call, options.predicate, out.pairs());
  put_digest(call, out);
}

void PartitionRecording::write_cast(RecordedCall kind, const Cast& cast, const Filter& filter,
                                    const Hit& hit) noexcept {
  CallWriter call = write(kind);
  const std::span<const Hit> one(&hit, 1);
  put_hits(put_cast(call, cast), filter, one, one);
}

/// A query with a predicate but without a column of keys is not recorded, because the accepted
/// objects are unknown.
void PartitionRecording::write_rays(RecordedCall kind, const RayBatch& rays, const Filter& filter,
                                    const HitColumns& hits) noexcept {
  if (filter.predicate.accept != nullptr && hits.key == nullptr) return;
  CallWriter call = write(kind);
  put_rays(call, rays).put_filter(filter.object());
  put_passed(call, filter.predicate, rays.count, [&](std::size_t i) { return hits.key[i].id; });
  call.put(hits.key != nullptr).put(hits.data != nullptr).put(hits.t != nullptr);
  call.put(digest_of_columns(hits, rays.count).value());
}

void PartitionRecording::overlap(const Region& region, const Filter& filter, Order order,
                                 const OverlapBuffer& objects) noexcept {
  CallWriter call = write(RecordedCall::overlap_region);
  put_region(call, region).put_filter(filter.object()).put(order);
  const std::span<const ObjectId> ids = objects.ids();
  put_passed(call, filter.predicate, ids.size(), [&](std::size_t i) { return ids[i]; });
  put_digest(call, objects);
}

void PartitionRecording::overlap(const BoxView& boxes, const Filter& filter, Order order,
                                 const PairBuffer& out) noexcept {
  CallWriter call = write(RecordedCall::overlap_boxes);
  put_volumes(call, GivenVolumes(boxes)).put_filter(filter.object()).put(order);
  put_passed(call, filter.predicate, out.size(), [&](std::size_t i) { return out[i].second; });
  put_digest(call, out);
}

void PartitionRecording::nearest(const Aabb& from, std::size_t count, float radius,
                                 const Filter& filter, const HitBuffer& hits) noexcept {
  CallWriter call = write(RecordedCall::nearest);
  put_box(call, from).put(std::uint64_t{count}).put(radius);
  put_hits(call, filter, hits);
}

}  // namespace

PartitionObserver* Recorder::observe_partition(StructureKind structure,
                                               const PartitionOptions& options) noexcept {
  if (state_ == nullptr) return nullptr;
  auto* const made = state_->make_world<PartitionRecording>();
  if (made != nullptr) made->begin(structure, options);
  return made;
}

}  // namespace winnow
