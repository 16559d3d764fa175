// One call of Scene::collide. The stages are named in Collision::run and Collision::collide_batch:
// find pairs, match them with the last frame, decide which keep their contacts, compute the
// contacts of all others in the narrow phase (and the mid phase, for composite shapes), filter the
// results, and write them into a frame, batch by batch. collision.h has the classes of the stages.

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/scene_observer.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

/// Lets a column use the storage of another column during the lifetime of this object.
template <typename T>
class BorrowedStorage {
 public:
  /// Borrows only if `may`, the column is empty and both have the same memory resource.
  BorrowedStorage(Column<T>& column, Column<T>& room, bool may) noexcept
      : column_(column),
        room_(room),
        is_borrowed_(may && column.empty() && column.memory() == room.memory()) {
    if (!is_borrowed_) return;
    room_.clear();
    column_.swap(room_);
  }
  BorrowedStorage(const BorrowedStorage&) = delete;
  BorrowedStorage& operator=(const BorrowedStorage&) = delete;
  ~BorrowedStorage() {
    if (is_borrowed_) column_.swap(room_);
  }

 private:
  Column<T>& column_;
  Column<T>& room_;
  bool is_borrowed_;
};

class Collision {
 public:
  Collision(SceneState& scene, ContactsState& contacts, ContactLevel level) noexcept
      : call_(scene, contacts, level),
        scene_(scene),
        contacts_(contacts),
        cache_(call_),
        filters_(call_),
        fresh_(call_, filters_),
        writer_(call_, cache_) {}

  [[nodiscard]] Status run();

 private:
  [[nodiscard]] Status write_frame();
  [[nodiscard]] Status collide_batch();

  CollideCall call_;
  SceneState& scene_;
  ContactsState& contacts_;
  ContactCache cache_;
  ContactFilters filters_;
  FreshContacts fresh_;
  ContactFrameWriter writer_;
};

}  // namespace

Status Scene::collide(ContactLevel level, Contacts& contacts) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr || contacts.state_ == nullptr) {
    contacts.clear();
    return logged(Status::out_of_memory, "Scene::collide");
  }
  if (!state_->options_are_good || level > ContactLevel::manifold) {
    return logged(Status::invalid_argument, "Scene::collide");
  }
  const ContactsOrigin before = contacts.state_->origin();
  state_->statistics = {};
  Status status = state_->find_pairs(level == ContactLevel::pairs);
  if (status == Status::ok) {
    state_->statistics.body_pairs = state_->pairs.size() + state_->pairs.apart();
    state_->statistics.rejected_by_spheres = state_->pairs.apart();
    status = Collision(*state_, *contacts.state_, level).run();
  }
  if (status == Status::ok) {
    state_->statistics.cached_pairs = contacts.state_->cached_count;
    state_->statistics.boxes_updated = std::exchange(state_->boxes_updated, 0);
    ++state_->clock;
    if (state_->observer != nullptr)
      state_->observer->collide(level, before, contacts.state_->origin(), contacts);
  } else {
    contacts.clear();
    if (state_->observer != nullptr) state_->observer->fail();
  }
  return logged(status, "Scene::collide");
}

Status Collision::run() {
  if (!call_.same_scene) contacts_.clear();
  // Without caching and sleeping pairs, the records are needed only during the call, so they can
  // be in borrowed storage.
  const BorrowedStorage records(contacts_.records.bits, scene_.pairs.spare(),
                                !call_.uses_cache && contacts_.dormant_records.size() == 0);
  contacts_.scene = scene_.serial;
  contacts_.level = call_.level;
  contacts_.cached_count = 0;
  call_.batch_end = call_.pair_count();
  if (!cache_.open_records()) return Status::out_of_memory;
  if (cache_.decide()) {
    if (const Status status = write_frame(); status != Status::ok) return status;
    cache_.match_points();
  } else if (!cache_.store_positions()) {
    return Status::out_of_memory;
  }
  if (!cache_.note_bodies()) return Status::out_of_memory;
  contacts_.clock = scene_.clock;
  contacts_.pairs_serial = scene_.pairs.serial();
  contacts_.regroupings = scene_.regroupings;
  return Status::ok;
}

// Writes a new frame, batch by batch.
Status Collision::write_frame() {
  if (!writer_.open() || !cache_.open_frame()) return Status::out_of_memory;
  ContactFrame::Cursor end;
  const std::uint32_t pairs = call_.pair_count();
  const std::uint32_t step = CollideCall::batch_size(scene_.options, pairs);
  call_.batch_end = 0;
  do {
    call_.batch_first = call_.batch_end;
    call_.batch_end += std::min(step, pairs - call_.batch_first);
    if (const Status status = collide_batch(); status != Status::ok) return status;
    const StageScope stage(WorkStage::contacts);
    const bool is_last = call_.batch_end == pairs;
    if (!writer_.write_batch(end) || (is_last && !(writer_.close(end) && cache_.close_frame()))) {
      return Status::out_of_memory;
    }
  } while (call_.batch_end < pairs);
  return Status::ok;
}

// Computes the contacts of a batch's pairs that are not cached.
Status Collision::collide_batch() {
  if (!cache_.match_batch() || !fresh_.list_pairs()) return Status::out_of_memory;
  filters_.find_limit();
  for (const Status status : {fresh_.collide_convex(), fresh_.collide_composite()}) {
    if (status != Status::ok) return status;
  }
  return filters_.drop_ghost_contacts() ? Status::ok : Status::out_of_memory;
}

}  // namespace winnow
