// AutoPartition: what it hands on.

#include "partitions/choice/auto_partition.h"

namespace winnow {

std::string_view AutoPartition::chosen() const noexcept {
  return look([&](const RowPartition&) { return partition_name(kind_); });
}
std::string_view AutoPartition::reason() const noexcept {
  return look([&](const RowPartition&) { return reason_; });
}
std::uint64_t AutoPartition::switches() const noexcept {
  return look([&](const RowPartition&) { return switches_; });
}
SceneFeatures AutoPartition::features() const noexcept {
  return look([&](const RowPartition&) { return features_; });
}

void AutoPartition::note_changes(std::size_t count) noexcept {
  changed_ += count;
  stale_.store(true, std::memory_order_relaxed);
}

Status AutoPartition::insert(const BoxView& boxes, std::span<const ClientData> data,
                             std::span<Key> keys) {
  note_changes(keys.size());
  return inner_->insert(boxes, data, keys);
}
Status AutoPartition::insert(const Aabb& box, ClientData data, Key& key) {
  note_changes(1);
  return inner_->insert(box, data, key);
}
Status AutoPartition::update(std::span<const Key> keys, const BoxView& boxes) {
  note_changes(keys.size());
  return inner_->update(keys, boxes);
}
Status AutoPartition::update(Key key, const Aabb& box) {
  note_changes(1);
  return inner_->update(key, box);
}
Status AutoPartition::remove(std::span<const Key> keys) {
  note_changes(keys.size());
  return inner_->remove(keys);
}
Status AutoPartition::remove(Key key) {
  note_changes(1);
  return inner_->remove(key);
}
Status AutoPartition::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  note_changes(0);
  return inner_->set_filter(keys, filters);
}
Status AutoPartition::set_filter(Key key, const ObjectFilter& filter) {
  note_changes(0);
  return inner_->set_filter(key, filter);
}
void AutoPartition::clear() noexcept {
  inner_->clear();
  chosen_ = false;
  saved_ = {};
  left_ = {};
  pairs_ = 0;
  note_changes(0);
}
void AutoPartition::release_memory() noexcept {
  inner_->release_memory();
  note_changes(0);
}
Status AutoPartition::reserve(std::size_t objects) {
  return inner_->reserve(objects);
}

std::size_t AutoPartition::size() const noexcept {
  return look([](const RowPartition& inner) { return inner.size(); });
}
bool AutoPartition::contains(Key key) const noexcept {
  return look([&](const RowPartition& inner) { return inner.contains(key); });
}
Status AutoPartition::bounds(Key key, Aabb& box) const noexcept {
  return look([&](const RowPartition& inner) { return inner.bounds(key, box); });
}
Status AutoPartition::client_data(Key key, ClientData& data) const noexcept {
  return look([&](const RowPartition& inner) { return inner.client_data(key, data); });
}
Key AutoPartition::key_of(ObjectId id) const noexcept {
  return look([&](const RowPartition& inner) { return inner.key_of(id); });
}
ClientData AutoPartition::client_data_of(ObjectId id) const noexcept {
  return look([&](const RowPartition& inner) { return inner.client_data_of(id); });
}
Status AutoPartition::filter(Key key, ObjectFilter& filter) const noexcept {
  return look([&](const RowPartition& inner) { return inner.filter(key, filter); });
}
const RowPartition* AutoPartition::row_partition() const noexcept {
  return look([](const RowPartition& inner) { return &inner; });
}
Footprint AutoPartition::footprint() const noexcept {
  return look([](const RowPartition& inner) { return inner.footprint(); });
}
Statistics AutoPartition::statistics() const noexcept {
  return look([](const RowPartition& inner) { return inner.statistics(); });
}

void AutoPartition::note_pairs(const PairBuffer& out, bool full,
                               const PairOptions& options) const noexcept {
  if (full) full_queries_.add(1);
  // What a predicate leaves says nothing about the scene.
  if (options.predicate.accept == nullptr) pairs_.store(out.size(), std::memory_order_relaxed);
}

Status AutoPartition::self_pairs(PairBuffer& out, const PairOptions& options) const {
  const bool full = !options.incremental || out.empty();
  const auto query = [&](const RowPartition& p) { return p.self_pairs(out, options); };
  const Status status = ask(pair_queries_, 1, query, out);
  if (status == Status::ok) note_pairs(out, full, options);
  return status;
}
Status AutoPartition::self_pairs(PairBuffer& out, PairEvents& events,
                                 const PairOptions& options) const {
  const bool full = !options.incremental || out.empty();
  const auto query = [&](const RowPartition& p) { return p.self_pairs(out, events, options); };
  const Status status = ask(pair_queries_, 1, query, out, events);
  if (status == Status::ok) note_pairs(out, full, options);
  return status;
}
Status AutoPartition::pairs_with(const Partition& other, PairBuffer& out,
                                 const PairOptions& options) const {
  return ask(
      regions_, 0, [&](const RowPartition& p) { return p.pairs_with(other, out, options); }, out);
}

Status AutoPartition::closest(const Cast& cast, Hit& hit, const Filter& filter) const {
  return ask(casts_, 1, [&](const RowPartition& p) { return p.closest(cast, hit, filter); });
}
Status AutoPartition::any(const Cast& cast, Hit& hit, const Filter& filter) const {
  return ask(casts_, 1, [&](const RowPartition& p) { return p.any(cast, hit, filter); });
}
Status AutoPartition::all(const Cast& cast, HitBuffer& hits, const Filter& filter) const {
  return ask(
      casts_, 1, [&](const RowPartition& p) { return p.all(cast, hits, filter); }, hits);
}
Status AutoPartition::closest(const RayBatch& rays, const HitColumns& hits,
                              const Filter& filter) const {
  return ask(casts_, rays.count,
             [&](const RowPartition& p) { return p.closest(rays, hits, filter); });
}
Status AutoPartition::any(const RayBatch& rays, const HitColumns& hits,
                          const Filter& filter) const {
  return ask(casts_, rays.count, [&](const RowPartition& p) { return p.any(rays, hits, filter); });
}
Status AutoPartition::all(const RayBatch& rays, HitBuffer& hits, const Filter& filter) const {
  return ask(
      casts_, rays.count, [&](const RowPartition& p) { return p.all(rays, hits, filter); }, hits);
}
Status AutoPartition::overlap(const Region& region, OverlapBuffer& objects, const Filter& filter,
                              Order order) const {
  const auto query = [&](const RowPartition& p) {
    return p.overlap(region, objects, filter, order);
  };
  return ask(regions_, 1, query, objects);
}
Status AutoPartition::overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter,
                              Order order) const {
  return ask(
      regions_, boxes.count,
      [&](const RowPartition& p) { return p.overlap(boxes, out, filter, order); }, out);
}
Status AutoPartition::nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                              const Filter& filter) const {
  const auto query = [&](const RowPartition& p) {
    return p.nearest(from, count, radius, hits, filter);
  };
  return ask(nearest_, 1, query, hits);
}
Status AutoPartition::debug_draw(DebugDraw& draw, const DebugDrawOptions& options) const {
  return ask(regions_, 0, [&](const RowPartition& p) { return p.debug_draw(draw, options); });
}

}  // namespace winnow
