#pragma once

#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/scene/seams.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// One call of Scene::collide: which pairs keep what they had, the answers about the others, and
/// both put into a new frame, batch by batch.
class Collision {
 public:
  static constexpr std::size_t kPairsPerTask = 512;
  /// Pairs that are answered before what was found of them is put into the frame: few enough that
  /// answers stay near and take little beside the frame, enough for many threads.
  static constexpr std::uint32_t kPairsPerBatch = 32768;

  /// So many of a scene's pairs at a time.
  [[nodiscard]] static std::uint32_t batch_size(const SceneOptions& options,
                                                std::size_t pairs) noexcept;
  /// Elements of what holds one for each pair of a batch.
  [[nodiscard]] static std::size_t batch_room(const SceneOptions& options,
                                              std::size_t pairs) noexcept;

  Collision(SceneState& scene, ContactsState& contacts, ContactLevel level) noexcept;

  [[nodiscard]] Status run();

 private:
  /// Where a pair's contacts come from.
  enum class Origin : std::uint8_t { carried, convex, composite };
  using Place = ContactFrame::Place;

  // What is known of the pairs (pair_memory.cpp).
  [[nodiscard]] bool wake_dormant();
  void merge_dormant() noexcept;
  [[nodiscard]] bool list_records();
  void match(const PairRecords& records) noexcept;
  [[nodiscard]] bool close_frame();
  [[nodiscard]] bool put_to_sleep();
  [[nodiscard]] bool list_ended();
  [[nodiscard]] bool sleeps(const BodyPair& pair) const noexcept;
  /// True if a pair at this place among those of the last frame and those that slept is one of the
  /// latter, which come last.
  [[nodiscard]] bool has_slept(std::uint32_t shown) const noexcept {
    return shown >= shown_last_ && shown != kNoEntry;
  }
  [[nodiscard]] bool note_bodies();

  // Contacts that are carried over (carry_over.cpp).
  [[nodiscard]] bool match_carried();
  [[nodiscard]] bool decide();
  [[nodiscard]] bool keep(std::uint32_t pair, std::uint32_t record) noexcept;
  void turn(CarriedPair& carried, std::uint32_t shown, const double (&to)[4]) noexcept;
  void remember(std::uint32_t pair, std::uint32_t shown) noexcept;
  [[nodiscard]] float carry_limit(std::uint32_t pair, std::uint32_t shown) const noexcept;
  [[nodiscard]] double clearance(std::uint32_t pair) const noexcept;

  // Where contacts were (contact_history.cpp).
  [[nodiscard]] bool begin_history() noexcept;
  [[nodiscard]] bool grow_history() noexcept;
  [[nodiscard]] bool reserve_history() noexcept;
  void match_points() noexcept;
  void match_points(std::uint32_t shown) noexcept;
  [[nodiscard]] bool keep_places() noexcept;
  void note_poses() noexcept;

  // Batches and answers (collide.cpp).
  [[nodiscard]] Status show();
  [[nodiscard]] Status answer();
  [[nodiscard]] bool list_pairs();
  [[nodiscard]] Status answer_convex();
  [[nodiscard]] Status answer_composite();
  [[nodiscard]] Status reduce_composite();

  // Offsets of bodies (contact_offsets.cpp).
  void find_limit() noexcept;
  /// The gaps of pairs of bodies, each grown by `more`. False if memory is refused.
  [[nodiscard]] bool find_margins(const Column<BodyPair>& pairs, double more, PairMargins& margins);
  /// The same for the pairs of parts, not grown.
  [[nodiscard]] bool find_part_margins(PairMargins& margins);
  void trim(double gap, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void trim_convex() noexcept;
  void trim_parts() noexcept;
  void rest(const BodyPair& bodies, std::uint32_t at, const NarrowColumns& answers) noexcept;
  void rest_parts() noexcept;
  void rest_regions(const BodyPair& bodies, std::size_t pair) noexcept;

  // Seams of floors (seams.cpp).
  class FloorWriter;
  [[nodiscard]] bool is_carried_over(const BodyPair& pair) const noexcept;
  [[nodiscard]] bool list_floor_contacts();
  void drop_seams_of(FloorContact* first, FloorContact* end) noexcept;
  [[nodiscard]] bool list_floor_answer(const NarrowResult& answers, FloorContact::Source source,
                                       std::uint32_t at, const double* offset, FloorWriter& writer);
  [[nodiscard]] bool list_floor_parts(std::uint32_t pair, FloorWriter& writer);
  [[nodiscard]] bool list_floor_regions(std::uint32_t pair, FloorWriter& writer);
  [[nodiscard]] bool drop_seams();
  void drop(const FloorContact& seam) noexcept;
  void close_regions() noexcept;

  // The frame (show_contacts.cpp).
  [[nodiscard]] bool reads_last_manifolds() const noexcept { return carries_ || remembers_places_; }
  [[nodiscard]] bool open_frame();
  [[nodiscard]] bool close(const Place& end);
  [[nodiscard]] bool show_batch(Place& end);
  [[nodiscard]] bool grow_frame(const Place& end);
  [[nodiscard]] bool reserve_next();
  /// The place in the last frame of a pair's contacts; kNoEntry.
  [[nodiscard]] std::uint32_t shown_before(std::uint32_t pair) const noexcept;
  [[nodiscard]] std::uint32_t carried_stretch(std::uint32_t pair, std::uint32_t end) const noexcept;
  [[nodiscard]] Origin origin_of_fresh(const BodyPair& pair) const noexcept {
    const bool is_composite =
        scene_.shape[pair.a].is_composite() || scene_.shape[pair.b].is_composite();
    return is_composite ? Origin::composite : Origin::convex;
  }
  [[nodiscard]] Origin origin_of(std::uint32_t pair) const noexcept {
    return static_cast<Origin>(contacts_.origin[pair - known_from_]);
  }
  /// Of a pair that is not carried over: its place in the list of those like it, which of convex
  /// ones is that of their answer, for they come in the order of their kinds.
  [[nodiscard]] std::uint32_t source_of(std::uint32_t pair) const noexcept {
    return contacts_.source[pair - batch_first_];
  }
  [[nodiscard]] bool is_fresh_convex(std::uint32_t pair) const noexcept;
  [[nodiscard]] Place extent(std::uint32_t pair) const noexcept;
  [[nodiscard]] Place count(std::uint32_t first, std::uint32_t end) const noexcept;
  void write_task(std::uint32_t first, std::uint32_t end, Place at) noexcept;
  [[nodiscard]] bool touches(const NarrowResult& answers, std::size_t at) const noexcept;
  void write_bodies(std::span<const std::uint32_t> pairs, std::uint32_t to) noexcept;
  void write_all(std::uint32_t first, std::uint32_t end, std::uint32_t to) noexcept;
  void write_convex(std::uint32_t first, std::uint32_t end, Place& at) noexcept;
  void write_answers(std::span<const std::uint32_t> pairs, Place& at) noexcept;
  void write_composite(std::uint32_t pair, const Place& to) noexcept;
  /// What is told of a pair's place in the last frame: none that slept was shown in it.
  [[nodiscard]] std::uint32_t place_before(std::uint32_t shown) const noexcept {
    return has_slept(shown) ? kNoContact : shown;
  }
  void write_manifold(const NarrowResult& answers, std::size_t at, const double* offset,
                      Place& to) noexcept;
  void write_points(const NarrowResult& answers, std::size_t at, const double* offset,
                    std::uint32_t& to) noexcept;
  void write_region(const ContactRegion& region, Place& to) noexcept;
  [[nodiscard]] bool write_runs();

  [[nodiscard]] std::uint32_t pair_count() const noexcept {
    return static_cast<std::uint32_t>(scene_.pairs.size());
  }
  template <typename T>
  [[nodiscard]] bool resize_for_batch(Column<T>& column) const noexcept {
    return column.grow(batch_room(scene_.options, pair_count())) &&
           column.resize(batch_end_ - batch_first_);
  }
  /// Of the batch.
  [[nodiscard]] std::size_t task_count() const noexcept {
    return (batch_end_ - batch_first_ + kPairsPerTask - 1) / kPairsPerTask;
  }
  /// Calls body(task, first pair, end) for runs of the batch's pairs, in parallel.
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
  /// Levels at which pairs are carried over, in a scene that does.
  bool carries_;
  /// Manifolds of composite shapes are those of regions.
  bool reduces_;
  /// It is told where contacts were.
  bool remembers_places_;
  /// What is no farther apart touches.
  double limit_ = 0.0;
  /// Pairs that the contacts showed before this call; and with those that slept and may have woken.
  std::uint32_t shown_last_ = 0;
  std::uint32_t known_last_ = 0;
  /// What the contacts remember is of this scene; and of this level.
  bool same_scene_;
  bool same_level_;
  /// Record i is of pair i.
  bool same_pairs_ = false;
  /// The pairs that are worked on: [batch_first_, batch_end_). All, until answers are asked for.
  std::uint32_t batch_first_ = 0;
  std::uint32_t batch_end_ = 0;
  /// The pair that the columns `origin` and `old_record` begin with: the batch's first, but where
  /// pairs are carried over, which is decided of all at once.
  std::uint32_t known_from_ = 0;
};

}  // namespace winnow
