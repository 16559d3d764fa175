// FreshContacts: new contacts of the pairs of a batch. Collision::collide_batch (collide.cpp) calls
// it. Convex pairs go to the narrow phase; pairs with a composite shape go first to the mid phase,
// which finds the primitives that may touch.

#include "pipeline/narrow/answer_slots.h"
#include "pipeline/narrow/tight_growth.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/solid_contacts.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

void add_to(NarrowStatistics& sum, const NarrowStatistics& statistics) noexcept {
  sum.pairs += statistics.pairs;
  sum.recomputed += statistics.recomputed;
  sum.without_lanes += statistics.without_lanes;
  sum.exact += statistics.exact;
  sum.bounded += statistics.bounded;
}

}  // namespace

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

bool FreshContacts::list_pairs() {
  ContactsState& contacts = call_.contacts;
  batch_.convex.clear();
  batch_.composite.clear();
  if (call_.level == ContactLevel::pairs) return true;
  if (!call_.resize_for_batch(contacts.input) ||
      !batch_.convex.grow(call_.batch_room(scene_.options, call_.pair_count())) ||
      (!call_.uses_cache && !call_.resize_for_batch(contacts.source))) {
    return false;
  }
  for (std::uint32_t i = call_.batch_first; i < call_.batch_end; ++i) {
    const BodyPair pair = scene_.pairs[i];
    if (!call_.uses_cache) {
      contacts.source[i - call_.known_from] =
          static_cast<std::uint8_t>(call_.source_of_fresh(pair));
    }
    const ContactSource source = call_.source_of(i);
    if (source == ContactSource::cached) continue;
    Column<BodyPair>& list = source == ContactSource::convex ? batch_.convex : batch_.composite;
    contacts.input[i - call_.batch_first] = static_cast<std::uint32_t>(list.size());
    if (!list.push_back(pair)) return false;
  }
  return true;
}

NarrowOptions FreshContacts::narrow_options(const PairMargins& margins) const noexcept {
  const SceneOptions& options = scene_.options;
  return {call_.level, options.tier, margins.largest, options.execution, margins.each};
}

Status FreshContacts::collide_convex() {
  if (call_.level == ContactLevel::pairs || batch_.convex.empty()) return Status::ok;
  PairMargins margins = 0.0;
  if (!filters_.find_margins(batch_.convex, 0.0, margins)) return Status::out_of_memory;
  const Status status = batch_.narrow.collide(
      scene_.shapes,
      {{scene_.shape.data(), scene_.shape.size()}, {scene_.pose.data(), scene_.pose.size()}},
      {batch_.convex.data(), batch_.convex.size()}, narrow_options(margins), batch_.answers);
  if (status != Status::ok) return status;
  add_to(scene_.statistics.convex, batch_.narrow.statistics());
  filters_.trim_convex();
  return Status::ok;
}

Status FreshContacts::collide_composite() {
  if (call_.level == ContactLevel::pairs || batch_.composite.empty()) return Status::ok;
  const SceneOptions& options = scene_.options;
  if (batch_.parts == nullptr) batch_.parts = new_in<PartAnswers>(options.memory, options.memory);
  if (batch_.parts == nullptr) return Status::out_of_memory;
  PartAnswers& found = *batch_.parts;
  const mid::MidPhase& mid_phase = mid::PoolAccess::mid_phase(*options.composites);

  // Primitives farther apart than this cannot touch before the pair's contacts are computed again.
  PairMargins margins = 0.0;
  const double more = call_.uses_cache ? options.cache_tolerance : 0.0;
  if (!filters_.find_margins(batch_.composite, more, margins)) return Status::out_of_memory;
  const Bodies bodies{{scene_.shape.data(), scene_.shape.size()},
                      {scene_.pose.data(), scene_.pose.size()}};
  Status status = mid_phase.find_primitive_pairs(*options.composites, scene_.shapes, bodies,
                                                 {batch_.composite.data(), batch_.composite.size()},
                                                 margins, options.execution, found.pairs);
  if (status != Status::ok) return status;

  if (!filters_.find_part_margins(margins)) return Status::out_of_memory;
  const PrimitivePairs& parts = found.pairs;
  status = found.narrow.collide(
      parts.tables(scene_.shapes),
      {{parts.shapes.data(), parts.shapes.size()}, {parts.poses.data(), parts.poses.size()}},
      {parts.pairs.data(), parts.pairs.size()}, narrow_options(margins), found.answers);
  if (status != Status::ok) return status;
  if (call_.level >= ContactLevel::distance) {
    status =
        mid_phase.correct_surface_contacts({*options.composites,
                                            scene_.shapes,
                                            bodies,
                                            {batch_.composite.data(), batch_.composite.size()}},
                                           found.pairs, margins, options.execution, found.answers);
    if (status != Status::ok) return status;
  }
  add_to(scene_.statistics.parts, found.narrow.statistics());
  scene_.statistics.primitive_pairs += parts.pairs.size();
  if (!resize_tightly(found.slot, found.answers.size())) return Status::out_of_memory;
  find_slots(found.answers, options.execution, found.slot.data());
  status = correct_solid_contacts(scene_, batch_.composite, margins, found);
  if (status != Status::ok) return status;
  filters_.trim_parts();
  if (const Status reduced = reduce_composite(); reduced != Status::ok) return reduced;
  filters_.rest_parts();
  return Status::ok;
}

Status FreshContacts::reduce_composite() {
  if (!call_.reduces) return Status::ok;
  PairMargins margins = 0.0;
  if (!filters_.find_margins(batch_.composite, 0.0, margins)) return Status::out_of_memory;
  PartAnswers& found = *batch_.parts;
  return mid::PoolAccess::mid_phase(*scene_.options.composites)
      .reduce_contacts(scene_.shapes, found.pairs, found.answers, margins, scene_.options.execution,
                       found.regions);
}

}  // namespace winnow
