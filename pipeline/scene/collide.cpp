// One call of Scene::collide. The stages are named in Collision::run and Collision::collide_batch:
// find pairs, match them with the last frame, decide which keep their contacts, compute the
// contacts of all others in the narrow phase (and the mid phase, for composite shapes), filter the
// results, and write them into a frame, batch by batch. collision.h has the classes of the other
// stages.

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"
#include "core/sort/parallel_ranges.h"
#include "core/threads/float_environment.h"
#include "pipeline/narrow/answer_slots.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"

#include <algorithm>
#include <bit>
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

[[nodiscard]] NarrowOptions narrow_options(const SceneOptions& options, ContactLevel level,
                                           const PairMargins& margins) noexcept {
  return {level, options.tier, margins.largest, options.execution, margins.each};
}

// Computes the index of the result for each input pair.
[[nodiscard]] bool invert(const NarrowResult& answers, const Execution& execution,
                          Column<std::uint32_t>& slots) noexcept {
  if (!resize_tightly(slots, answers.size())) return false;
  find_slots(answers, execution, slots.data());
  return true;
}

class Collision {
 public:
  Collision(SceneState& scene, ContactsState& contacts, ContactLevel level) noexcept
      : call_(scene, contacts, level),
        scene_(scene),
        contacts_(contacts),
        cache_(call_),
        filters_(call_),
        writer_(call_, cache_) {}

  [[nodiscard]] Status run();

 private:
  [[nodiscard]] Status write_frame();
  [[nodiscard]] Status collide_batch();
  [[nodiscard]] bool list_pairs();
  [[nodiscard]] Status collide_convex();
  [[nodiscard]] Status collide_composite();
  [[nodiscard]] Status reduce_composite();

  CollideCall call_;
  SceneState& scene_;
  ContactsState& contacts_;
  ContactCache cache_;
  ContactFilters filters_;
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
  } else {
    contacts.clear();
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
  if (!cache_.match_batch() || !list_pairs()) return Status::out_of_memory;
  filters_.find_limit();
  for (const Status status : {collide_convex(), collide_composite()}) {
    if (status != Status::ok) return status;
  }
  return filters_.drop_ghost_contacts() ? Status::ok : Status::out_of_memory;
}

// Lists the pairs that need new contacts, convex and composite ones separately.
bool Collision::list_pairs() {
  scene_.batch.convex.clear();
  scene_.batch.composite.clear();
  if (call_.level == ContactLevel::pairs) return true;
  if (!call_.resize_for_batch(contacts_.source) ||
      !scene_.batch.convex.grow(call_.batch_room(scene_.options, call_.pair_count())) ||
      (!call_.uses_cache && !call_.resize_for_batch(contacts_.origin))) {
    return false;
  }
  for (std::uint32_t i = call_.batch_first; i < call_.batch_end; ++i) {
    const BodyPair pair = scene_.pairs[i];
    if (!call_.uses_cache) {
      contacts_.origin[i - call_.known_from] =
          static_cast<std::uint8_t>(call_.origin_of_fresh(pair));
    }
    const ContactSource origin = call_.origin_of(i);
    if (origin == ContactSource::cached) continue;
    Column<BodyPair>& list =
        origin == ContactSource::convex ? scene_.batch.convex : scene_.batch.composite;
    contacts_.source[i - call_.batch_first] = static_cast<std::uint32_t>(list.size());
    if (!list.push_back(pair)) return false;
  }
  return true;
}

Status Collision::collide_convex() {
  if (call_.level == ContactLevel::pairs || scene_.batch.convex.empty()) return Status::ok;
  PairMargins margins = 0.0;
  if (!filters_.find_margins(scene_.batch.convex, 0.0, margins)) return Status::out_of_memory;
  const Status status = scene_.batch.narrow.collide(
      scene_.shapes,
      {{scene_.shape.data(), scene_.shape.size()}, {scene_.pose.data(), scene_.pose.size()}},
      {scene_.batch.convex.data(), scene_.batch.convex.size()},
      narrow_options(scene_.options, call_.level, margins), scene_.batch.answers);
  if (status != Status::ok) return status;
  scene_.statistics.convex += scene_.batch.narrow.statistics();
  filters_.trim_convex();
  return Status::ok;
}

Status Collision::collide_composite() {
  if (call_.level == ContactLevel::pairs || scene_.batch.composite.empty()) return Status::ok;
  const SceneOptions& options = scene_.options;
  if (scene_.batch.parts == nullptr)
    scene_.batch.parts = new_in<PartAnswers>(options.memory, options.memory);
  if (scene_.batch.parts == nullptr) return Status::out_of_memory;
  PrimitivePairs& parts = scene_.batch.parts->pairs;
  // Primitives farther apart than this cannot touch before the pair's contacts are computed again.
  PairMargins margins = 0.0;
  if (!filters_.find_margins(scene_.batch.composite,
                             call_.uses_cache ? options.cache_tolerance : 0.0, margins)) {
    return Status::out_of_memory;
  }
  Status status =
      mid::mid_phase_of(*options.composites)
          .find_primitive_pairs(*options.composites, scene_.shapes,
                                {{scene_.shape.data(), scene_.shape.size()},
                                 {scene_.pose.data(), scene_.pose.size()}},
                                {scene_.batch.composite.data(), scene_.batch.composite.size()},
                                margins, options.execution, parts);
  if (status != Status::ok) return status;
  if (!filters_.find_part_margins(margins)) return Status::out_of_memory;
  status = scene_.batch.parts->narrow.collide(
      parts.tables(scene_.shapes),
      {{parts.shapes.data(), parts.shapes.size()}, {parts.poses.data(), parts.poses.size()}},
      {parts.pairs.data(), parts.pairs.size()}, narrow_options(options, call_.level, margins),
      scene_.batch.parts->answers);
  if (status != Status::ok) return status;
  if (call_.level >= ContactLevel::distance) {
    mid::mid_phase_of(*options.composites)
        .correct_internal_edges(scene_.shapes, parts, margins, options.execution,
                                scene_.batch.parts->answers);
  }
  scene_.statistics.parts += scene_.batch.parts->narrow.statistics();
  scene_.statistics.primitive_pairs += parts.pairs.size();
  if (!invert(scene_.batch.parts->answers, options.execution, scene_.batch.parts->slot)) {
    return Status::out_of_memory;
  }
  filters_.trim_parts();
  if (const Status reduced = reduce_composite(); reduced != Status::ok) return reduced;
  filters_.rest_parts();
  return Status::ok;
}

Status Collision::reduce_composite() {
  if (!call_.reduces) return Status::ok;
  PairMargins margins = 0.0;
  if (!filters_.find_margins(scene_.batch.composite, 0.0, margins)) return Status::out_of_memory;
  const SceneOptions& options = scene_.options;
  return mid::mid_phase_of(*options.composites)
      .reduce_contacts(scene_.shapes, scene_.batch.parts->pairs, scene_.batch.parts->answers,
                       margins, options.execution, scene_.batch.parts->regions);
}

// If ghost contacts are suppressed, all pairs are one batch, because the suppression compares all
// contacts of a body.
std::uint32_t CollideCall::batch_size(const SceneOptions& options, std::size_t pairs) noexcept {
  const auto all = static_cast<std::uint32_t>(pairs);
  return options.suppress_ghost_contacts ? all : std::min(all, kPairsPerBatch);
}

// The size of a batch that is not full is rounded up to a power of two, so that most small
// increases of the number of pairs need no new allocation.
std::size_t CollideCall::batch_room(const SceneOptions& options, std::size_t pairs) noexcept {
  const std::size_t batch = batch_size(options, pairs);
  return batch == 0 || batch > kPairsPerBatch ? batch : std::bit_ceil(batch);
}

}  // namespace winnow
