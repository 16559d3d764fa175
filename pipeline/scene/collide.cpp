// One call of Scene::collide: lists pairs, computes their contacts in the narrow phase (and the mid
// phase, for composite shapes) and writes them into a frame, batch by batch. Other stages of
// Collision are in the files that collision.h names.

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

Collision::Collision(SceneState& scene, ContactsState& contacts, ContactLevel level) noexcept
    : scene_(scene),
      contacts_(contacts),
      level_(level),
      uses_cache_(scene.options.cache_tolerance > 0.0 && level >= ContactLevel::distance),
      reduces_(scene.options.contact_reduction && level == ContactLevel::manifold),
      stores_positions_(scene.options.warm_start),
      same_scene_(contacts.scene == scene.serial),
      same_level_(same_scene_ && contacts.level == level) {}

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

}  // namespace

Status Collision::run() {
  if (!same_scene_) contacts_.clear();
  // Without caching and sleeping pairs, the records are needed only during the call, so they can
  // be in borrowed storage.
  const BorrowedStorage records(contacts_.records.bits, scene_.pairs.spare(),
                                !uses_cache_ && contacts_.dormant_records.size() == 0);
  contacts_.scene = scene_.serial;
  contacts_.level = level_;
  contacts_.cached_count = 0;
  batch_end_ = pair_count();
  if (!list_records() || !wake_dormant() || !match_cached()) return Status::out_of_memory;
  if (decide()) {
    if (const Status status = show(); status != Status::ok) return status;
    match_points();
  } else if (!store_positions()) {
    return Status::out_of_memory;
  }
  if (!note_bodies()) return Status::out_of_memory;
  contacts_.clock = scene_.clock;
  contacts_.pairs_serial = scene_.pairs.serial();
  contacts_.regroupings = scene_.regroupings;
  return Status::ok;
}

// If ghost contacts are suppressed, all pairs are one batch, because the suppression compares all
// contacts of a body.
std::uint32_t Collision::batch_size(const SceneOptions& options, std::size_t pairs) noexcept {
  const auto all = static_cast<std::uint32_t>(pairs);
  return options.suppress_ghost_contacts ? all : std::min(all, kPairsPerBatch);
}

// The size of a batch that is not full is rounded up to a power of two, so that most small
// increases of the number of pairs need no new allocation.
std::size_t Collision::batch_room(const SceneOptions& options, std::size_t pairs) noexcept {
  const std::size_t batch = batch_size(options, pairs);
  return batch == 0 || batch > kPairsPerBatch ? batch : std::bit_ceil(batch);
}

Status Collision::show() {
  if (!open_frame()) return Status::out_of_memory;
  Cursor end;
  const std::uint32_t step = batch_size(scene_.options, pair_count());
  batch_end_ = 0;
  do {
    batch_first_ = batch_end_;
    batch_end_ += std::min(step, pair_count() - batch_first_);
    if (const Status status = answer(); status != Status::ok) return status;
    const StageScope stage(WorkStage::contacts);
    const bool is_last = batch_end_ == pair_count();
    if (!show_batch(end) || (is_last && !close(end))) return Status::out_of_memory;
  } while (batch_end_ < pair_count());
  return Status::ok;
}

Status Collision::answer() {
  if (!uses_cache_) {
    known_from_ = batch_first_;
    if (!resize_for_batch(contacts_.old_record)) return Status::out_of_memory;
    match(contacts_.records_before);
  }
  if (!list_pairs()) return Status::out_of_memory;
  find_limit();
  for (const Status status : {answer_convex(), answer_composite()}) {
    if (status != Status::ok) return status;
  }
  return drop_ghost_contacts() ? Status::ok : Status::out_of_memory;
}

// Lists the pairs that need new contacts, convex and composite ones separately.
bool Collision::list_pairs() {
  scene_.convex.clear();
  scene_.composite.clear();
  if (level_ == ContactLevel::pairs) return true;
  if (!resize_for_batch(contacts_.source) ||
      !scene_.convex.grow(batch_room(scene_.options, pair_count())) ||
      (!uses_cache_ && !resize_for_batch(contacts_.origin))) {
    return false;
  }
  for (std::uint32_t i = batch_first_; i < batch_end_; ++i) {
    const BodyPair pair = scene_.pairs[i];
    if (!uses_cache_) {
      contacts_.origin[i - known_from_] = static_cast<std::uint8_t>(origin_of_fresh(pair));
    }
    const ContactSource origin = origin_of(i);
    if (origin == ContactSource::cached) continue;
    Column<BodyPair>& list = origin == ContactSource::convex ? scene_.convex : scene_.composite;
    contacts_.source[i - batch_first_] = static_cast<std::uint32_t>(list.size());
    if (!list.push_back(pair)) return false;
  }
  return true;
}

namespace {

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

}  // namespace

Status Collision::answer_convex() {
  if (level_ == ContactLevel::pairs || scene_.convex.empty()) return Status::ok;
  PairMargins margins = 0.0;
  if (!find_margins(scene_.convex, 0.0, margins)) return Status::out_of_memory;
  const Status status = scene_.narrow.collide(
      scene_.shapes,
      {{scene_.shape.data(), scene_.shape.size()}, {scene_.pose.data(), scene_.pose.size()}},
      {scene_.convex.data(), scene_.convex.size()}, narrow_options(scene_.options, level_, margins),
      scene_.answers);
  if (status != Status::ok) return status;
  scene_.statistics.convex += scene_.narrow.statistics();
  trim_convex();
  return Status::ok;
}

Status Collision::answer_composite() {
  if (level_ == ContactLevel::pairs || scene_.composite.empty()) return Status::ok;
  const SceneOptions& options = scene_.options;
  if (scene_.parts == nullptr) scene_.parts = new_in<PartAnswers>(options.memory, options.memory);
  if (scene_.parts == nullptr) return Status::out_of_memory;
  PrimitivePairs& parts = scene_.parts->pairs;
  // Primitives farther apart than this cannot touch before the pair's contacts are computed again.
  PairMargins margins = 0.0;
  if (!find_margins(scene_.composite, uses_cache_ ? options.cache_tolerance : 0.0, margins)) {
    return Status::out_of_memory;
  }
  Status status = mid::mid_phase_of(*options.composites)
                      .find_primitive_pairs(*options.composites, scene_.shapes,
                                            {{scene_.shape.data(), scene_.shape.size()},
                                             {scene_.pose.data(), scene_.pose.size()}},
                                            {scene_.composite.data(), scene_.composite.size()},
                                            margins, options.execution, parts);
  if (status != Status::ok) return status;
  if (!find_part_margins(margins)) return Status::out_of_memory;
  status = scene_.parts->narrow.collide(
      parts.tables(scene_.shapes),
      {{parts.shapes.data(), parts.shapes.size()}, {parts.poses.data(), parts.poses.size()}},
      {parts.pairs.data(), parts.pairs.size()}, narrow_options(options, level_, margins),
      scene_.parts->answers);
  if (status != Status::ok) return status;
  if (level_ >= ContactLevel::distance) {
    mid::mid_phase_of(*options.composites)
        .correct_internal_edges(scene_.shapes, parts, margins, options.execution,
                                scene_.parts->answers);
  }
  scene_.statistics.parts += scene_.parts->narrow.statistics();
  scene_.statistics.primitive_pairs += parts.pairs.size();
  if (!invert(scene_.parts->answers, options.execution, scene_.parts->slot)) {
    return Status::out_of_memory;
  }
  trim_parts();
  if (const Status reduced = reduce_composite(); reduced != Status::ok) return reduced;
  rest_parts();
  return Status::ok;
}

Status Collision::reduce_composite() {
  if (!reduces_) return Status::ok;
  PairMargins margins = 0.0;
  if (!find_margins(scene_.composite, 0.0, margins)) return Status::out_of_memory;
  const SceneOptions& options = scene_.options;
  return mid::mid_phase_of(*options.composites)
      .reduce_contacts(scene_.shapes, scene_.parts->pairs, scene_.parts->answers, margins,
                       options.execution, scene_.parts->regions);
}

}  // namespace winnow
