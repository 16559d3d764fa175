#pragma once

// The class behind Scene::collide. collide.cpp runs the stages; each group of members below names
// the file that implements it.

#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/ghost_contacts.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// One call of Scene::collide. Decides which pairs keep their contacts, computes the contacts of
/// all other pairs, and writes the contacts of all pairs into a new frame, in batches.
class Collision {
 public:
  static constexpr std::size_t kPairsPerTask = 512;
  /// Pairs whose results are computed before they are written into the frame: few enough that
  /// results stay in cache and use little memory, enough to occupy many threads.
  static constexpr std::uint32_t kPairsPerBatch = 32768;

  /// Returns the number of pairs in one batch.
  [[nodiscard]] static std::uint32_t batch_size(const SceneOptions& options,
                                                std::size_t pairs) noexcept;
  /// Returns the capacity of columns that have one element for each pair of a batch.
  [[nodiscard]] static std::size_t batch_room(const SceneOptions& options,
                                              std::size_t pairs) noexcept;

  Collision(SceneState& scene, ContactsState& contacts, ContactLevel level) noexcept;

  [[nodiscard]] Status run();

 private:
  /// Where a pair's contacts come from.
  enum class ContactSource : std::uint8_t { cached, convex, composite };
  using Cursor = ContactFrame::Cursor;

  // Records of pairs from the last call (pair_records.cpp).
  [[nodiscard]] bool wake_dormant();
  void merge_dormant() noexcept;
  [[nodiscard]] bool list_records();
  void match(const PairRecords& records) noexcept;
  [[nodiscard]] bool close_frame();
  [[nodiscard]] bool put_to_sleep();
  [[nodiscard]] bool list_ended();
  [[nodiscard]] bool sleeps(const BodyPair& pair) const noexcept;
  /// True if index `shown` belongs to a pair that slept: wake_dormant appends such pairs to the
  /// pairs of the last frame.
  [[nodiscard]] bool has_slept(std::uint32_t shown) const noexcept {
    return shown >= last_pairs_ && shown != kNoEntry;
  }
  [[nodiscard]] bool note_bodies();

  // The contact cache (contact_cache.cpp).
  [[nodiscard]] bool match_cached();
  [[nodiscard]] bool decide();
  [[nodiscard]] bool keep(std::uint32_t pair, std::uint32_t record) noexcept;
  void turn(CachedPair& cached, std::uint32_t shown, const double (&to)[4]) noexcept;
  void remember(std::uint32_t pair, std::uint32_t shown) noexcept;
  [[nodiscard]] float cache_limit(std::uint32_t pair, std::uint32_t shown) const noexcept;
  [[nodiscard]] double clearance(std::uint32_t pair) const noexcept;

  // Indices of contacts in the last frame (contact_history.cpp).
  [[nodiscard]] bool begin_history() noexcept;
  [[nodiscard]] bool grow_history() noexcept;
  [[nodiscard]] bool reserve_history() noexcept;
  void match_points() noexcept;
  void match_points(std::uint32_t shown) noexcept;
  [[nodiscard]] bool store_positions() noexcept;
  void note_poses() noexcept;

  // Batches and the narrow phase (collide.cpp).
  [[nodiscard]] Status show();
  [[nodiscard]] Status answer();
  [[nodiscard]] bool list_pairs();
  [[nodiscard]] Status answer_convex();
  [[nodiscard]] Status answer_composite();
  [[nodiscard]] Status reduce_composite();

  // Offsets of bodies (contact_offsets.cpp).
  void find_limit() noexcept;
  /// Computes the contact distance of each pair of bodies, grown by `more`. Returns false if memory
  /// is refused.
  [[nodiscard]] bool find_margins(const Column<BodyPair>& pairs, double more, PairMargins& margins);
  /// As find_margins, but for pairs of primitives and not grown.
  [[nodiscard]] bool find_part_margins(PairMargins& margins);
  void trim(double gap, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void trim_convex() noexcept;
  void trim_parts() noexcept;
  void rest(const BodyPair& bodies, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void rest_parts() noexcept;
  void rest_regions(const BodyPair& bodies, std::size_t pair) noexcept;

  // Suppression of ghost contacts (ghost_contacts.cpp).
  class FloorWriter;
  [[nodiscard]] bool is_cacheable(const BodyPair& pair) const noexcept;
  [[nodiscard]] bool list_floor_contacts();
  void drop_ghost_contacts_of(FloorContact* first, FloorContact* end) noexcept;
  [[nodiscard]] bool list_floor_answer(const NarrowResult& answers, FloorContact::Source source,
                                       std::uint32_t at, const double* offset, FloorWriter& writer);
  [[nodiscard]] bool list_floor_parts(std::uint32_t pair, FloorWriter& writer);
  [[nodiscard]] bool list_floor_regions(std::uint32_t pair, FloorWriter& writer);
  [[nodiscard]] bool drop_ghost_contacts();
  void drop(const FloorContact& seam) noexcept;
  void close_regions() noexcept;

  // Output of the frame (write_contacts.cpp).
  [[nodiscard]] bool reads_last_manifolds() const noexcept {
    return uses_cache_ || stores_positions_;
  }
  [[nodiscard]] bool open_frame();
  [[nodiscard]] bool close(const Cursor& end);
  [[nodiscard]] bool show_batch(Cursor& end);
  [[nodiscard]] bool grow_frame(const Cursor& end);
  [[nodiscard]] bool reserve_next();
  /// Index of a pair's contacts in the last frame, or kNoEntry.
  [[nodiscard]] std::uint32_t shown_before(std::uint32_t pair) const noexcept;
  [[nodiscard]] std::uint32_t count_cached(std::uint32_t pair, std::uint32_t end) const noexcept;
  [[nodiscard]] ContactSource origin_of_fresh(const BodyPair& pair) const noexcept {
    const bool is_composite =
        scene_.shape[pair.a].is_composite() || scene_.shape[pair.b].is_composite();
    return is_composite ? ContactSource::composite : ContactSource::convex;
  }
  [[nodiscard]] ContactSource origin_of(std::uint32_t pair) const noexcept {
    return static_cast<ContactSource>(contacts_.origin[pair - known_from_]);
  }
  /// Index in SceneState::convex or composite of a pair that is not cached. For a convex pair
  /// this is also the index of its result, because SceneState::convex is sorted by kinds, as
  /// results are.
  [[nodiscard]] std::uint32_t source_of(std::uint32_t pair) const noexcept {
    return contacts_.source[pair - batch_first_];
  }
  [[nodiscard]] bool is_fresh_convex(std::uint32_t pair) const noexcept;
  [[nodiscard]] Cursor extent(std::uint32_t pair) const noexcept;
  [[nodiscard]] Cursor count(std::uint32_t first, std::uint32_t end) const noexcept;
  void write_task(std::uint32_t first, std::uint32_t end, Cursor at) noexcept;
  [[nodiscard]] bool touches(const NarrowResult& answers, std::size_t at) const noexcept;
  void write_bodies(std::span<const std::uint32_t> pairs, std::uint32_t to) noexcept;
  void write_all(std::uint32_t first, std::uint32_t end, std::uint32_t to) noexcept;
  void write_convex(std::uint32_t first, std::uint32_t end, Cursor& at) noexcept;
  void write_answers(std::span<const std::uint32_t> pairs, Cursor& at) noexcept;
  void write_composite(std::uint32_t pair, const Cursor& to) noexcept;
  /// Value of Contacts::previous_pair: a pair that slept was not in the last frame.
  [[nodiscard]] std::uint32_t last_point_of(std::uint32_t shown) const noexcept {
    return has_slept(shown) ? kNoContact : shown;
  }
  void write_manifold(const NarrowResult& answers, std::size_t at, const double* offset,
                      Cursor& to) noexcept;
  void write_points(const NarrowResult& answers, std::size_t at, const double* offset,
                    std::uint32_t& to) noexcept;
  void write_region(const ContactRegion& region, Cursor& to) noexcept;
  [[nodiscard]] bool write_runs();

  [[nodiscard]] std::uint32_t pair_count() const noexcept {
    return static_cast<std::uint32_t>(scene_.pairs.size());
  }
  template <typename T>
  [[nodiscard]] bool resize_for_batch(Column<T>& column) const noexcept {
    return column.grow(batch_room(scene_.options, pair_count())) &&
           column.resize(batch_end_ - batch_first_);
  }
  /// Number of tasks in the batch.
  [[nodiscard]] std::size_t task_count() const noexcept {
    return (batch_end_ - batch_first_ + kPairsPerTask - 1) / kPairsPerTask;
  }
  /// Calls body(task, first pair, end) in parallel for consecutive ranges of the batch's pairs.
  template <typename Body>
  void for_tasks(Body&& body) const {
    scene_.options.execution.for_each(task_count(), [&](std::size_t task) {
      const auto first = batch_first_ + static_cast<std::uint32_t>(task * kPairsPerTask);
      body(task, first, std::min(batch_end_, first + static_cast<std::uint32_t>(kPairsPerTask)));
    });
  }

  SceneState& scene_;
  ContactsState& contacts_;
  ContactLevel level_;
  /// The scene has a contact cache and the level allows it.
  bool uses_cache_;
  /// Manifolds of composite shapes are merged into contact regions.
  bool reduces_;
  /// SceneOptions::warm_start: previous indices of contacts are required.
  bool stores_positions_;
  /// Pairs with at most this distance are in contact.
  double limit_ = 0.0;
  /// Number of pairs in the contacts before this call; and including sleeping pairs that may have
  /// woken.
  std::uint32_t last_pairs_ = 0;
  std::uint32_t last_records_ = 0;
  /// The contacts were last filled by this scene; and at this level.
  bool same_scene_;
  bool same_level_;
  /// Record i belongs to pair i: the pairs are the same as in the last call.
  bool same_pairs_ = false;
  /// The current batch is [batch_first_, batch_end_). It is all pairs until the narrow phase
  /// begins.
  std::uint32_t batch_first_ = 0;
  std::uint32_t batch_end_ = 0;
  /// First pair of the columns `origin` and `old_record`: the batch's first pair, or 0 with
  /// caching, which is decided for all pairs at once.
  std::uint32_t known_from_ = 0;
};

}  // namespace winnow
