#pragma once

// The stages of Scene::collide, which collide.cpp calls one after the other: ContactCache matches
// pairs with the last frame, FreshContacts computes the contacts of the others, ContactFilters
// changes results of the narrow phase, and ContactFrameWriter writes the new frame. CollideCall is
// the data that they share.

#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/ghost_contacts.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

struct NarrowColumns;

/// Where a pair's contacts come from: the last frame, or the results of a new test.
enum class ContactSource : std::uint8_t { cached, convex, composite };

/// One call of Scene::collide.
struct CollideCall {
  static constexpr std::size_t kPairsPerTask = 512;
  /// Pairs whose results are computed before they are written into the frame: few enough that
  /// results stay in cache and use little memory, enough to occupy many threads.
  static constexpr std::uint32_t kPairsPerBatch = 32768;

  CollideCall(SceneState& of, ContactsState& into, ContactLevel at) noexcept
      : scene(of),
        contacts(into),
        level(at),
        uses_cache(of.options.cache_tolerance > 0.0 && at >= ContactLevel::distance),
        reduces(of.options.contact_reduction && at == ContactLevel::manifold),
        stores_positions(of.options.warm_start),
        same_scene(into.scene == of.serial),
        same_level(same_scene && into.level == at) {}

  SceneState& scene;
  ContactsState& contacts;
  const ContactLevel level;
  /// The scene has a contact cache and the level allows it.
  const bool uses_cache;
  /// Manifolds of composite shapes are merged into contact regions.
  const bool reduces;
  /// SceneOptions::warm_start: previous indices of contacts are required.
  const bool stores_positions;
  /// The contacts were last filled by this scene; and at this level.
  const bool same_scene;
  const bool same_level;
  /// Pairs with at most this distance are in contact (ContactFilters::find_limit).
  double limit = 0.0;
  /// The current batch is [batch_first, batch_end). It is all pairs until the narrow phase begins.
  std::uint32_t batch_first = 0;
  std::uint32_t batch_end = 0;
  /// First pair of the columns `source` and `old_record`: the batch's first pair, or 0 with
  /// caching, which is decided for all pairs at once.
  std::uint32_t known_from = 0;

  /// Returns the number of pairs in one batch.
  [[nodiscard]] static std::uint32_t batch_size(const SceneOptions& options,
                                                std::size_t pairs) noexcept;
  /// Returns the capacity of columns that have one element for each pair of a batch.
  [[nodiscard]] static std::size_t batch_room(const SceneOptions& options,
                                              std::size_t pairs) noexcept;
  [[nodiscard]] std::uint32_t pair_count() const noexcept {
    return static_cast<std::uint32_t>(scene.pairs.size());
  }
  template <typename T>
  [[nodiscard]] bool resize_for_batch(Column<T>& column) const noexcept {
    return column.grow(batch_room(scene.options, pair_count())) &&
           column.resize(batch_end - batch_first);
  }
  /// Number of tasks in the batch.
  [[nodiscard]] std::size_t task_count() const noexcept {
    return (batch_end - batch_first + kPairsPerTask - 1) / kPairsPerTask;
  }
  /// Calls body(task, first pair, end) in parallel for consecutive ranges of the batch's pairs.
  template <typename Body>
  void for_tasks(Body&& body) const {
    scene.options.execution.for_each(task_count(), [&](std::size_t task) {
      const auto first = batch_first + static_cast<std::uint32_t>(task * kPairsPerTask);
      body(task, first, std::min(batch_end, first + static_cast<std::uint32_t>(kPairsPerTask)));
    });
  }

  /// True if one of the bodies is fixed, so that contacts of the pair may be ghost contacts.
  [[nodiscard]] bool is_floor_pair(const BodyPair& pair) const noexcept {
    return scene.body_state[pair.a] == BodyState::fixed ||
           scene.body_state[pair.b] == BodyState::fixed;
  }
  /// False if other pairs decide which contacts of the pair are ghost contacts.
  [[nodiscard]] bool is_cacheable(const BodyPair& pair) const noexcept {
    return !scene.options.suppress_ghost_contacts || !is_floor_pair(pair);
  }
  [[nodiscard]] ContactSource source_of_fresh(const BodyPair& pair) const noexcept {
    const bool is_composite =
        scene.shape[pair.a].is_composite() || scene.shape[pair.b].is_composite();
    return is_composite ? ContactSource::composite : ContactSource::convex;
  }
  [[nodiscard]] ContactSource source_of(std::uint32_t pair) const noexcept {
    return static_cast<ContactSource>(contacts.source[pair - known_from]);
  }
  /// Index in PairBatch::convex or composite of a pair that is not cached. For a convex pair
  /// this is also the index of its result, because PairBatch::convex is sorted by kinds, as
  /// results are.
  [[nodiscard]] std::uint32_t input_of(std::uint32_t pair) const noexcept {
    return contacts.input[pair - batch_first];
  }
};

/// The data that contacts keep from frame to frame.
class ContactCache {
 public:
  explicit ContactCache(CollideCall& call) noexcept
      : call_(call), scene_(call.scene), contacts_(call.contacts) {}

  // Records of pairs, which also store sleeping pairs and find ended ones (contact_cache.cpp).

  /// Lists the records of the last frame, with those of pairs that may have woken, and with
  /// caching finds the record of each pair. Returns false if memory is refused.
  [[nodiscard]] bool open_records();
  /// Prepares the records of the new frame, after ContactFrameWriter::open.
  [[nodiscard]] bool open_frame();
  /// Without caching: finds the record of each pair of the batch.
  [[nodiscard]] bool match_batch();
  /// Index of a pair's contacts in the last frame, or kNoEntry.
  [[nodiscard]] std::uint32_t index_before(std::uint32_t pair) const noexcept {
    const std::uint32_t record = same_pairs_ ? pair : contacts_.old_record[pair - call_.known_from];
    return record == kNoEntry ? kNoEntry : contacts_.records_before.frame_index_of(record);
  }
  /// Completes the records after the last batch: pairs of the last frame that are not in this frame
  /// have ended, or sleep.
  [[nodiscard]] bool close_frame();
  /// Stores the keys and data of all bodies.
  [[nodiscard]] bool note_bodies();

  // Caching: how far each pair may move until its contacts are computed again (contact_cache.cpp).

  /// Decides for every pair where its contacts come from. Returns false if all pairs keep their
  /// contacts and the last frame can stay as it is.
  [[nodiscard]] bool decide();
  /// Stores the record of a pair, whose index in the new frame is `index` or kNoEntry, and the data
  /// that its caching needs in the next call. The columns must have room.
  void remember(std::uint32_t pair, std::uint32_t index) noexcept;

  // Warm starts: the index of each contact in the last frame (contact_history.cpp).

  /// Value of Contacts::previous_pair: a pair that slept was not in the last frame.
  [[nodiscard]] std::uint32_t previous_pair_of(std::uint32_t index) const noexcept {
    return has_slept(index) ? kNoContact : index;
  }
  /// Resizes to the frame.
  [[nodiscard]] bool grow_history() noexcept;
  /// Matches the points of all pairs of the frame.
  void match_points() noexcept;
  /// Called if the frame stays as it is: every contact keeps its index.
  [[nodiscard]] bool store_positions() noexcept;

 private:
  [[nodiscard]] bool list_records();
  [[nodiscard]] bool wake_dormant();
  void merge_dormant() noexcept;
  [[nodiscard]] bool match_cached();
  void match(const PairRecords& records) noexcept;
  [[nodiscard]] bool keep(std::uint32_t pair, std::uint32_t record) noexcept;
  void turn(CachedPair& cached, std::uint32_t index, const Quaternion& to) noexcept;
  [[nodiscard]] float cache_limit(std::uint32_t pair, std::uint32_t index) const noexcept;
  [[nodiscard]] double clearance(std::uint32_t pair) const noexcept;
  [[nodiscard]] bool put_to_sleep();
  [[nodiscard]] bool list_ended();
  [[nodiscard]] bool sleeps(const BodyPair& pair) const noexcept;
  /// True if an index in the last frame belongs to a pair that slept: wake_dormant appends such
  /// pairs to the frame.
  [[nodiscard]] bool has_slept(std::uint32_t index) const noexcept {
    return index >= last_pairs_ && index != kNoEntry;
  }
  [[nodiscard]] bool begin_history() noexcept;
  void match_points(std::uint32_t index) noexcept;
  void note_poses() noexcept;

  CollideCall& call_;
  SceneState& scene_;
  ContactsState& contacts_;
  /// Number of pairs in the contacts before this call; and including sleeping pairs that may have
  /// woken.
  std::uint32_t last_pairs_ = 0;
  std::uint32_t last_records_ = 0;
  /// Record i belongs to pair i: the pairs are the same as in the last call.
  bool same_pairs_ = false;
};

/// Changes results of the narrow phase: offsets of bodies (contact_offsets.cpp) and suppression of
/// ghost contacts (ghost_contacts.cpp). In a scene without both, all pairs have the scene's margin,
/// and all other functions return at once.
class ContactFilters {
 public:
  explicit ContactFilters(CollideCall& call) noexcept : call_(call), scene_(call.scene) {}

  /// Sets CollideCall::limit for the batch.
  void find_limit() noexcept;
  /// Computes the contact distance of each pair of bodies, grown by `more`. Returns false if memory
  /// is refused.
  [[nodiscard]] bool find_margins(const Column<BodyPair>& pairs, double more, PairMargins& margins);
  /// As find_margins, but for pairs of primitives and not grown.
  [[nodiscard]] bool find_part_margins(PairMargins& margins);
  /// Apply the offsets: to results of convex pairs; and to those of primitive pairs, before and
  /// after they are merged into contact regions.
  void trim_convex() noexcept;
  void trim_parts() noexcept;
  void rest_parts() noexcept;
  /// Drops ghost contacts. Returns false if memory is refused.
  [[nodiscard]] bool drop_ghost_contacts();

 private:
  /// Contact distance of a pair: bodies at most this far apart are in contact.
  [[nodiscard]] double gap_of(const BodyPair& pair) const noexcept;
  void trim(double gap, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void rest(const BodyPair& bodies, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void rest_regions(const BodyPair& bodies, std::size_t pair) noexcept;

  class FloorWriter;
  [[nodiscard]] bool list_floor_contacts();
  [[nodiscard]] bool list_floor_answer(const NarrowResult& answers, FloorContact::Source source,
                                       std::uint32_t at, const double* offset, FloorWriter& writer);
  [[nodiscard]] bool list_floor_parts(std::uint32_t pair, FloorWriter& writer);
  [[nodiscard]] bool list_floor_regions(std::uint32_t pair, FloorWriter& writer);
  void drop_ghost_contacts_of(FloorContact* first, FloorContact* end) noexcept;
  void drop(const FloorContact& contact) noexcept;
  void close_regions() noexcept;

  CollideCall& call_;
  SceneState& scene_;
};

/// Computes the contacts of a batch's pairs that are not cached (fresh_contacts.cpp).
class FreshContacts {
 public:
  FreshContacts(CollideCall& call, ContactFilters& filters) noexcept
      : call_(call), filters_(filters), scene_(call.scene), batch_(call.scene.batch) {}

  /// Lists the pairs, convex and composite ones separately. Returns false if memory is refused.
  [[nodiscard]] bool list_pairs();
  /// Call the narrow phase for the listed pairs; for composite shapes after the mid phase.
  [[nodiscard]] Status collide_convex();
  [[nodiscard]] Status collide_composite();

 private:
  [[nodiscard]] NarrowOptions narrow_options(const PairMargins& margins) const noexcept;
  [[nodiscard]] Status reduce_composite();

  CollideCall& call_;
  ContactFilters& filters_;
  SceneState& scene_;
  PairBatch& batch_;
};

/// Writes the contacts of all pairs into the frame, batch by batch (contact_frame_writer.cpp).
class ContactFrameWriter {
 public:
  using Cursor = ContactFrame::Cursor;

  ContactFrameWriter(const CollideCall& call, ContactCache& cache) noexcept
      : call_(call), cache_(cache), scene_(call.scene), contacts_(call.contacts) {}

  /// Makes the current frame the last frame, or clears it if nothing reads the last frame. Returns
  /// false if memory is refused, like all of the following.
  [[nodiscard]] bool open();
  /// Counts the contacts of a batch, makes room, and writes them from `end` on.
  [[nodiscard]] bool write_batch(Cursor& end);
  /// Completes the frame after the last batch.
  [[nodiscard]] bool close(const Cursor& end);

 private:
  [[nodiscard]] bool reads_last_manifolds() const noexcept {
    return call_.uses_cache || call_.stores_positions;
  }
  [[nodiscard]] bool touches(const NarrowResult& answers, std::size_t at) const noexcept {
    return call_.level == ContactLevel::boolean ? answers.overlaps(at)
                                                : answers.distance()[at] <= call_.limit;
  }
  [[nodiscard]] bool is_fresh_convex(std::uint32_t pair) const noexcept {
    return call_.source_of(pair) == ContactSource::convex;
  }
  [[nodiscard]] bool grow_frame(const Cursor& end);
  [[nodiscard]] std::uint32_t count_cached(std::uint32_t pair, std::uint32_t end) const noexcept;
  [[nodiscard]] Cursor composite_extent(std::uint32_t pair) const noexcept;
  [[nodiscard]] Cursor count(std::uint32_t first, std::uint32_t end) const noexcept;
  void write_task(std::uint32_t first, std::uint32_t end, Cursor at) noexcept;
  void write_bodies(std::span<const std::uint32_t> pairs, std::uint32_t to) noexcept;
  void write_all(std::uint32_t first, std::uint32_t end, std::uint32_t to) noexcept;
  void write_convex(std::uint32_t first, std::uint32_t end, Cursor& at) noexcept;
  void write_answers(std::span<const std::uint32_t> pairs, Cursor& at) noexcept;
  void write_composite(std::uint32_t pair, const Cursor& to) noexcept;
  void write_manifold(const NarrowResult& answers, std::size_t at, const double* offset,
                      Cursor& to) noexcept;
  void write_points(const NarrowResult& answers, std::size_t at, const double* offset,
                    std::uint32_t& to) noexcept;
  void write_region(const ContactRegion& region, Cursor& to) noexcept;
  [[nodiscard]] bool write_runs();

  const CollideCall& call_;
  ContactCache& cache_;
  SceneState& scene_;
  ContactsState& contacts_;
};

}  // namespace winnow
