#pragma once

// Format of recordings; pipeline/FORMATS.md describes it. Used by the recorder and by
// pipeline/replay. The functions at the end compute digests of results.

#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/results.h>
#include <winnow/partitions/partition.h>
#include "core/memory/byte_stream.h"
#include "partitions/state/partition_observer.h"
#include "pipeline/scene/queries/query_observer.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace winnow {

inline constexpr std::string_view kRecordingMagic = "WINNOWRC";
/// Version that is written. All versions from 1 on can be read.
inline constexpr std::uint32_t kRecordingVersion = 5;
/// Size of magic, version, and 4 bytes of 0.
inline constexpr std::size_t kRecordingHeader = 16;
/// Size of the header of a block: number of bytes, and their digest.
inline constexpr std::size_t kBlockHeader = 16;

/// World number of calls that belong to no partition or scene.
inline constexpr std::uint32_t kNoWorld = ~0U;

enum class RecordedCall : std::uint8_t {
  end_frame,
  end_world,
  make_partition,
  set_structure,
  insert,
  update,
  remove,
  clear,
  release_memory,
  set_filter,
  refresh,
  self_pairs,
  pairs_with,
  closest_cast,
  any_cast,
  all_casts,
  closest_rays,
  any_rays,
  all_rays,
  overlap_region,
  overlap_boxes,
  nearest,
  make_scene,
  add_shape,
  add_bodies,
  remove_bodies,
  clear_bodies,
  move,
  set_body_state,
  set_shape,
  set_body_filter,
  set_ignored,
  refresh_scene,
  collide,
  add_composite,
  change_composite,

  set_offsets,
  set_layer,
  set_layers_collide,

  // Since version 2.
  set_predicate,
  pairs_passed,
  composites_changed,
  query_ray,
  query_rays,
  query_overlap,
  query_shape_cast,
  query_motion_cast,
  query_distance,
  query_least_distance,
  query_overlaps,
  query_nearest,

  // Since version 3.
  load_scene,
  load_contacts,
  make_sensors,
  end_sensors,
  add_sensor,
  remove_sensor,
  move_sensor,
  set_sensor,
  sense,
  find_impacts,
  find_impacts_of_motions,

  // Since version 4. The older calls for the same queries use PairRules::none.
  query_distance_by_rules,
  query_least_distance_by_rules,
  query_overlaps_by_rules,
  query_any_contact,
  query_any_contact_of_sets,

  // Since version 5. Rays have a min_t; see HitForm.
  query_crossings,
  query_distances,
  add_sensor_in_layer,
  set_sensor_in_layer,
};

/// Returns the last call of a version; nullopt for an unknown version.
[[nodiscard]] constexpr std::optional<RecordedCall> last_call_of(std::uint32_t version) noexcept {
  if (version == 1) return RecordedCall::set_layers_collide;
  if (version == 2) return RecordedCall::query_nearest;
  if (version == 3) return RecordedCall::find_impacts_of_motions;
  if (version == 4) return RecordedCall::query_any_contact_of_sets;
  if (version == 5) return RecordedCall::set_sensor_in_layer;
  static_assert(kRecordingVersion == 5);
  return std::nullopt;
}

/// A pair by ids: a player's keys differ from the recorded ones, its ids do not.
struct RecordedPair {
  std::uint32_t first;
  std::uint32_t second;
};

/// Orders a pair by id, as recordings store pairs of one scene.
[[nodiscard]] constexpr Pair lower_first(ObjectId one, ObjectId other) noexcept {
  return one < other ? Pair{one, other} : Pair{other, one};
}

/// A body to add, with the number of its shape in the recording.
struct RecordedBody {
  std::uint32_t shape;
  std::uint32_t state;
  double pose[7];  // position, orientation
  std::uint32_t filter[3];
  std::uint32_t unused;
  std::uint64_t data;
};
static_assert(sizeof(RecordedBody) == 88);

/// Id of a shape in a snapshot, and its number in the recording.
struct RecordedName {
  std::uint32_t bits;
  std::uint32_t number;
};

// Digests of results: overloads of add_to, here and in contact_digest.h, query_digest.h and
// impact_digest.h.

/// Digest of several results in order.
template <typename... Answers>
[[nodiscard]] Digest digest_of_answers(const Answers&... answers) noexcept {
  Digest digest;
  (add_to(digest, answers), ...);
  return digest;
}

/// Digest of the first `count` entries of columns.
template <typename Columns>
[[nodiscard]] Digest digest_of_columns(const Columns& columns, std::size_t count) noexcept {
  Digest digest;
  add_to(digest, columns, count);
  return digest;
}

inline void add_to(Digest& digest, std::span<const Hit> hits) noexcept {
  for (const Hit& hit : hits) {
    digest.add(std::uint64_t{hit.key.id});
    digest.add(hit.data);
    digest.add(hit.t);
  }
  digest.add(std::uint64_t{hits.size()});
}

inline void add_to(Digest& digest, const PairBuffer& pairs) noexcept {
  digest.add_array(pairs.pairs());
}

inline void add_to(Digest& digest, const PairEvents& events) noexcept {
  const auto add_all = [&](std::span<const KeyPair> pairs) {
    for (const KeyPair& pair : pairs) {
      digest.add(std::uint64_t{pair.first.id} << 32U | pair.second.id);
    }
    digest.add(std::uint64_t{pairs.size()});
  };
  add_all(events.begun());
  add_all(events.ended());
  digest.add(std::uint64_t{events.persisting()});
}

inline void add_to(Digest& digest, const HitBuffer& hits) noexcept {
  add_to(digest, hits.hits());
  for (std::size_t i = 0; i < hits.queries(); ++i) {
    digest.add(std::uint64_t{hits.of(i).size()});
  }
}

inline void add_to(Digest& digest, const OverlapBuffer& objects) noexcept {
  digest.add_array(objects.ids());
  digest.add(std::uint64_t{objects.inside().size()});
}

/// Skips null columns.
inline void add_to(Digest& digest, const HitColumns& hits, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    if (hits.key != nullptr) digest.add(std::uint64_t{hits.key[i].id});
    if (hits.data != nullptr) digest.add(hits.data[i]);
    if (hits.t != nullptr) digest.add(hits.t[i]);
  }
}

}  // namespace winnow
