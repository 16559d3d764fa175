// Public functions of Partition: they set the floating-point environment, call PartitionState, pass
// successful calls to the observer, and log refused mutations and self pairs. Casts, regions and
// nearest queries are in queries/, snapshots in snapshot/snapshot.cpp.

#include <winnow/partitions/partition.h>

#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "partitions/index/debug_draw.h"
#include "partitions/rows/row_input.h"
#include "partitions/state/box_partition.h"
#include "partitions/state/partition_observer.h"
#include "partitions/state/partition_state.h"

namespace winnow {
namespace {

constexpr const char* kSelfPairs = "Partition::self_pairs";

/// Calls change(rows) for a mutation of `count` objects, marks the structure as stale if rows
/// changed, and logs the status under the name `call`.
template <typename Change>
Status mutate(const char* call, PartitionState* state, Status otherwise, std::size_t count,
              Change&& change) {
  if (state == nullptr) return logged(otherwise, call);
  const Status status = change(state->rows);
  state->note_changes(status, count);
  return logged(status, call);
}

Status find_self_pairs(const PartitionState& state, PairForm form, PairBuffer& out,
                       PairEvents* events, const PairOptions& options) {
  PairOptions used = options;
  // Events are sorted anyway, and the pairs are not returned.
  if (form == PairForm::events) used.order = Order::fast;
  PartitionObserver* const observer = state.observer;
  if (observer == nullptr) return logged(state.self_pairs(out, used, events), kSelfPairs);
  const Lock lock(observer->self_pairs_mutex);
  const ObservedPairQuery query(form, out, events);
  const Status status = state.self_pairs(out, used, events);
  if (status == Status::ok) observer->self_pairs(options, query);
  return logged(status, kSelfPairs);
}

}  // namespace

Partition make_box_partition(StructureKind structure, const PartitionOptions& options) noexcept {
  PartitionOptions without = options;
  without.fat_margin = {};
  return Partition(structure, without, &RowInput::boxes_as_given());
}

Partition::Partition(StructureKind structure, const PartitionOptions& options,
                     const VolumeInput* input) noexcept {
  const DefaultFloatEnvironment environment;
  if (structure.info() == nullptr || input == nullptr) return;
  state_ = PartitionState::make(structure, options, *input);
  status_ = state_ == nullptr ? Status::out_of_memory : Status::ok;
  if (state_ != nullptr && options.recorder != nullptr)
    state_->observer = options.recorder->observe_partition(structure, options);
}

Partition::Partition(StructureKind structure) noexcept
    : Partition(structure, {}, &RowInput::boxes_as_given()) {}

Partition::Partition(StructureKind structure, const PartitionOptions& options) noexcept
    : Partition(structure, options, RowInput::of(options.volume, options.fat_margin)) {}

Partition::~Partition() {
  if (state_ == nullptr) return;
  if (state_->observer != nullptr) state_->observer->end();
  delete_in(state_->memory, state_);
}

StructureKind Partition::structure() const noexcept {
  return state_ == nullptr ? StructureKind{} : state_->structure;
}

Status Partition::set_structure(StructureKind structure) {
  const DefaultFloatEnvironment environment;
  Status status = status_;
  if (structure.info() == nullptr) {
    status = Status::invalid_argument;
  } else if (state_ != nullptr) {
    status = state_->set_structure(structure) ? Status::ok : Status::out_of_memory;
  }
  if (is_observed(status, state_)) state_->observer->set_structure(structure);
  return logged(status, "Partition::set_structure");
}

StructureChoice Partition::choice() const noexcept {
  return state_ == nullptr ? StructureChoice{} : state_->choice();
}

bool Partition::is_exact() const noexcept {
  return state_ == nullptr || state_->is_exact();
}

Volume Partition::volume() const noexcept {
  return state_ == nullptr ? Volume::aabb : state_->rows.pool().volume();
}

FatMargin Partition::fat_margin() const noexcept {
  return state_ == nullptr ? FatMargin{} : state_->rows.fat_margin();
}

Status Partition::insert(const BoxView& boxes, std::span<const ClientData> data,
                         std::span<Key> keys) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->insert(boxes, data, keys);
  if (is_observed(status, state_)) state_->observer->insert(GivenVolumes(boxes), data);
  return logged(status, "Partition::insert");
}

Answer<Key> Partition::insert(const Aabb& box, ClientData data) {
  Key key;
  const Status status =
      insert(BoxView(std::span<const Aabb>(&box, 1)), std::span(&data, 1), std::span(&key, 1));
  return status == Status::ok ? Answer<Key>(key) : status;
}

Status Partition::insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                         std::span<Key> keys) {
  const DefaultFloatEnvironment environment;
  const Status status = mutate("Partition::insert", state_, status_, keys.size(), [&](Rows& rows) {
    return RowInput(rows).insert(spheres, data, keys);
  });
  if (is_observed(status, state_)) state_->observer->insert({Volume::sphere, spheres}, data);
  return status;
}

template <int K>
Status Partition::insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                         std::span<Key> keys) {
  const DefaultFloatEnvironment environment;
  const Status status = mutate("Partition::insert", state_, status_, keys.size(), [&](Rows& rows) {
    return RowInput(rows).insert(kdops, data, keys);
  });
  if (is_observed(status, state_)) state_->observer->insert({volume(), kdops}, data);
  return status;
}

Status Partition::update(std::span<const Key> keys, const BoxView& boxes) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->update(UpdateSubset(keys), boxes);
  if (is_observed(status, state_)) state_->observer->update(keys, GivenVolumes(boxes));
  return logged(status, "Partition::update");
}

Status Partition::update(std::span<const Key> keys, const BoxView& boxes,
                         const IndexSubset& entries) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->update(keys, boxes, entries);
  if (is_observed(status, state_)) state_->observer->update(keys, boxes, entries);
  return logged(status, "Partition::update");
}

Status Partition::update(Key key, const Aabb& box) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->update(key, box);
  if (is_observed(status, state_)) state_->observer->update({&key, 1}, GivenVolumes(box));
  return logged(status, "Partition::update");
}

Status Partition::update(std::span<const Key> keys, std::span<const Sphere> spheres) {
  const DefaultFloatEnvironment environment;
  const Status status = mutate("Partition::update", state_, status_, keys.size(),
                               [&](Rows& rows) { return RowInput(rows).update(keys, spheres); });
  if (is_observed(status, state_)) state_->observer->update(keys, {Volume::sphere, spheres});
  return status;
}

template <int K>
Status Partition::update(std::span<const Key> keys, std::span<const Kdop<K>> kdops) {
  const DefaultFloatEnvironment environment;
  const Status status = mutate("Partition::update", state_, status_, keys.size(),
                               [&](Rows& rows) { return RowInput(rows).update(keys, kdops); });
  if (is_observed(status, state_)) state_->observer->update(keys, {volume(), kdops});
  return status;
}

template Status Partition::insert(std::span<const Kdop<14>>, std::span<const ClientData>,
                                  std::span<Key>);
template Status Partition::insert(std::span<const Kdop<18>>, std::span<const ClientData>,
                                  std::span<Key>);
template Status Partition::insert(std::span<const Kdop<26>>, std::span<const ClientData>,
                                  std::span<Key>);
template Status Partition::update(std::span<const Key>, std::span<const Kdop<14>>);
template Status Partition::update(std::span<const Key>, std::span<const Kdop<18>>);
template Status Partition::update(std::span<const Key>, std::span<const Kdop<26>>);

Status Partition::remove(std::span<const Key> keys) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->remove(keys);
  if (is_observed(status, state_)) state_->observer->remove(keys);
  return logged(status, "Partition::remove");
}

Status Partition::remove(Key key) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->remove(key);
  if (is_observed(status, state_)) state_->observer->remove({&key, 1});
  return logged(status, "Partition::remove");
}

void Partition::clear() noexcept {
  if (state_ == nullptr) return;
  state_->clear();
  if (state_->observer != nullptr) state_->observer->clear();
}

void Partition::release_memory() noexcept {
  if (state_ == nullptr) return;
  state_->release_memory();
  if (state_->observer != nullptr) state_->observer->release_memory();
}

Status Partition::reserve(std::size_t objects, Pages pages) {
  const DefaultFloatEnvironment environment;
  return logged(state_ == nullptr ? status_ : state_->reserve(objects, pages),
                "Partition::reserve");
}

std::size_t Partition::size() const noexcept {
  return state_ == nullptr ? 0 : state_->rows.size();
}

bool Partition::contains(Key key) const noexcept {
  return state_ != nullptr && state_->rows.keys().is_valid(key);
}

Answer<Aabb> Partition::bounds(Key key) const noexcept {
  Aabb box;
  const Status status = bounds({&key, 1}, {&box, 1});
  return status == Status::ok ? Answer<Aabb>(box) : status;
}

Status Partition::bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  return keys.size() == boxes.size() ? state_->bounds(keys, boxes) : Status::size_mismatch;
}

ClientData Partition::client_data(Key key) const noexcept {
  return contains(key) ? state_->rows.keys().client_data(key.id) : 0;
}

Key Partition::key_of(ObjectId id) const noexcept {
  return state_ == nullptr ? Key{} : state_->rows.keys().key_of(id);
}

ClientData Partition::client_data_of(ObjectId id) const noexcept {
  return client_data(key_of(id));
}

Status Partition::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->set_filter(keys, filters);
  if (is_observed(status, state_)) state_->observer->set_filter(keys, filters);
  return logged(status, "Partition::set_filter");
}

Status Partition::set_filter(Key key, const ObjectFilter& filter) {
  return set_filter(std::span<const Key>(&key, 1), std::span<const ObjectFilter>(&filter, 1));
}

Answer<ObjectFilter> Partition::filter(Key key) const noexcept {
  if (!contains(key)) return state_ == nullptr ? status_ : Status::invalid_key;
  return state_->rows.filters().of(key.id);
}

Status Partition::refresh() const {
  const DefaultFloatEnvironment environment;
  const Status status = state_ == nullptr ? status_ : state_->refresh_early();
  if (is_observed(status, state_)) state_->observer->refresh();
  return logged(status, "Partition::refresh");
}

Status Partition::self_pairs(PairBuffer& out, const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  if (state_ != nullptr) return find_self_pairs(*state_, PairForm::buffer, out, nullptr, options);
  out.clear();
  return status_;
}

Status Partition::self_pairs(PairBuffer& out, PairEvents& events,
                             const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  if (state_ != nullptr)
    return find_self_pairs(*state_, PairForm::buffer_and_events, out, &events, options);
  out.clear();
  events.clear();
  return status_;
}

Status Partition::self_pairs(PairEvents& events, const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  PairBuffer& own = EventWriter::own_buffer(events);
  if (state_ != nullptr) return find_self_pairs(*state_, PairForm::events, own, &events, options);
  own.clear();
  events.clear();
  return status_;
}

Status Partition::pairs_with(const Partition& other, PairBuffer& out,
                             const PairOptions& options) const {
  const DefaultFloatEnvironment environment;
  out.clear();
  if (state_ == nullptr || other.state_ == nullptr) {
    return state_ == nullptr ? status_ : other.status_;
  }
  const Status status = state_->pairs_with(*other.state_, options, out);
  PartitionObserver* const observer_of_other = other.state_->observer;
  if (is_observed(status, state_)) {
    state_->observer->pairs_with(observer_of_other, options, out);
  } else if (status == Status::ok && observer_of_other != nullptr) {
    observer_of_other->give_up();
  }
  return status;
}

Status Partition::reserve_pairs(PairBuffer& out, std::size_t pairs, Pages pages) const {
  const DefaultFloatEnvironment environment;
  return state_ == nullptr ? status_ : state_->reserve_pairs(out, pairs, pages);
}

Status Partition::reserve_events(PairEvents& out, std::size_t pairs, bool with_pairs,
                                 Pages pages) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  if (!state_->reserve_events(out, pairs, pages)) return Status::out_of_memory;
  return with_pairs ? reserve_pairs(EventWriter::own_buffer(out), pairs, pages) : Status::ok;
}

Status Partition::debug_draw(DebugDraw& draw, const DebugDrawOptions& options) const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return status_;
  if (options.max_depth < 0) return Status::invalid_argument;
  if (const Status status = state_->settle(); status != Status::ok) return status;
  if (options.structure) {
    draw_structure(draw, state_->rows, state_->index, static_cast<std::size_t>(options.max_depth));
  }
  draw_objects(draw, state_->rows, options);
  return Status::ok;
}

Footprint Partition::footprint() const noexcept {
  return state_ == nullptr ? Footprint{} : state_->footprint();
}

Statistics Partition::statistics() const noexcept {
  return state_ == nullptr ? Statistics{} : state_->statistics();
}

}  // namespace winnow
