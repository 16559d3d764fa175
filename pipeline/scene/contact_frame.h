#pragma once

#include <winnow/core/column.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/narrow_result.h>
#include "pipeline/scene/body_pairs.h"
#include "pipeline/scene/contact_history.h"

#include <cstdint>
#include <memory_resource>

namespace winnow {

struct SceneOptions;
struct SceneRoom;

/// No entry.
inline constexpr std::uint32_t kNoEntry = ~0U;

/// What `collide` shows: see Contacts. Pairs are sorted as BodyPairs are. Client data is that of
/// ContactsState::known.
struct ContactFrame {
  explicit ContactFrame(std::pmr::memory_resource* memory) noexcept;

  Column<ContactRun> runs;
  Column<Key> key[2];
  Column<ContactEvent> event;
  /// One more than pairs, and one more than manifolds.
  Column<std::uint32_t> manifold_first;
  /// Empty without composite shapes.
  Column<std::uint32_t> part[2];
  Column<double> distance;
  Column<double> error_bound;
  Column<double> normal[3];
  Column<double> point[3];
  Column<std::uint32_t> point_first;
  ContactColumns points;
  std::size_t manifolds = 0;
  /// There are, or were a while ago, composite shapes.
  bool with_parts = false;

  [[nodiscard]] std::size_t pairs() const noexcept { return event.size(); }
  /// True if so much needs no more memory.
  [[nodiscard]] bool has_room(ContactLevel level, std::size_t pair_count,
                              std::size_t manifold_count, std::size_t point_count) const noexcept;
  [[nodiscard]] std::uint32_t part_of(int side, std::size_t manifold) const noexcept {
    return with_parts ? part[side][manifold] : kWholeShape;
  }
  /// Room for what a level has, and no more. False if memory is refused.
  [[nodiscard]] bool resize(ContactLevel level, std::size_t pair_count, std::size_t manifold_count,
                            std::size_t point_count) noexcept;
  /// Room for so much at a level, for every run there may be, and for parts if there may be any.
  /// False if memory is refused.
  [[nodiscard]] bool reserve(ContactLevel level, bool parts, std::size_t pair_count,
                             std::size_t manifold_count, std::size_t point_count,
                             Pages pages) noexcept;
  /// As much room as another frame has, so that the two can change places.
  [[nodiscard]] bool reserve_as(const ContactFrame& other) noexcept;
  void clear() noexcept;
  void swap(ContactFrame& other) noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

  /// Where something is written: the next pair, manifold and point.
  struct Place {
    std::uint32_t pair = 0;
    std::uint32_t manifold = 0;
    std::uint32_t point = 0;

    Place& operator+=(const Place& other) noexcept {
      pair += other.pair;
      manifold += other.manifold;
      point += other.point;
      return *this;
    }
  };
  /// How much pairs [first, first + count) take.
  [[nodiscard]] Place extent(std::uint32_t first, std::uint32_t count = 1) const noexcept;
  /// Copies pairs [first, first + count) of another frame of the same level to a place, with their
  /// manifolds and points, but for runs; without any where the other has pairs alone.
  void copy(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
            const Place& to) noexcept;
  /// Writes what ends the columns of firsts.
  void close(ContactLevel level, const Place& end) noexcept;

 private:
  /// Calls make(column, count) for every column but those of runs and of points, until it is false.
  template <typename Make>
  [[nodiscard]] bool make_columns(ContactLevel level, bool parts, std::size_t pair_count,
                                  std::size_t manifold_count, Make&& make) noexcept;
  void copy_points(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
                   const Place& to) noexcept;
};

/// What is remembered of pairs from one `collide` to the next, in their order: of those that touch,
/// and with carry-over of all.
struct PairRecords {
  explicit PairRecords(std::pmr::memory_resource* memory) noexcept : bits(memory), shown(memory) {}

  /// PairOrder::bits.
  Column<std::uint64_t> bits;
  /// Its place in the ContactFrame, kNoEntry if it does not touch. Empty where record i is that of
  /// pair i of the frame.
  Column<std::uint32_t> shown;

  [[nodiscard]] std::size_t size() const noexcept { return bits.size(); }
  [[nodiscard]] PairOrder order_of(std::size_t record) const noexcept { return {bits[record]}; }
  [[nodiscard]] std::uint32_t shown_of(std::size_t record) const noexcept {
    return shown.empty() ? static_cast<std::uint32_t>(record) : shown[record];
  }
  void push_back_within_room(PairOrder of, std::uint32_t at) noexcept {
    (void)bits.push_back(of.bits);
    (void)shown.push_back(at);
  }
  [[nodiscard]] bool reserve(std::size_t count, Pages pages = Pages::untouched) noexcept {
    return bits.reserve(count, pages) && shown.reserve(count, pages);
  }
  void clear() noexcept {
    bits.clear();
    shown.clear();
  }
  void swap(PairRecords& other) noexcept {
    bits.swap(other.bits);
    shown.swap(other.shown);
  }
  [[nodiscard]] Bytes bytes() const noexcept {
    Bytes sum = bits.bytes();
    sum += shown.bytes();
    return sum;
  }
};

/// Which objects bodies were when contacts were last filled, by number: who they are now may have
/// come in the place of others.
struct KnownBodies {
  explicit KnownBodies(std::pmr::memory_resource* memory) noexcept : stamp(memory), data(memory) {}

  Column<std::uint32_t> stamp;  ///< of keys
  Column<ClientData> data;
  std::size_t live = 0;

  [[nodiscard]] Key key(std::uint32_t body) const noexcept { return {body, stamp[body]}; }
  void clear() noexcept {
    stamp.clear();
    data.clear();
    live = 0;
  }
  [[nodiscard]] bool reserve(std::size_t bodies, Pages pages = Pages::untouched) noexcept {
    return stamp.reserve(bodies, pages) && data.reserve(bodies, pages);
  }
  [[nodiscard]] Bytes bytes() const noexcept {
    Bytes sum = stamp.bytes();
    sum += data.bytes();
    return sum;
  }
};

/// With carry-over, of every pair.
struct CarriedPair {
  /// The limit of a pair that is made anew in the next frame, whether it moves or not.
  static constexpr float kNever = -1.0F;

  /// When its manifolds were made: b in the frame of a, or a in that of b if `from_b`.
  Pose relative;
  /// Orientation of a to which normals and points belong.
  double turn[4];
  /// How far it may have moved against `relative` before it must be made anew.
  float limit;
  /// While it sleeps and when it wakes: the call in which it was last looked at.
  std::uint32_t looked_at;
  /// Of the body that is looked at from the other one; and of body a.
  float radius;
  float radius_a;
  /// What turning its points in float has cost so far, as a length.
  float drift;
  bool from_b;
  /// `error_bound` has been widened.
  bool widened;
};

/// Everything that Contacts are.
struct ContactsState {
  explicit ContactsState(std::pmr::memory_resource* memory) noexcept;

  ContactLevel level = ContactLevel::pairs;
  ContactFrame frame;
  /// The last one, where manifolds are carried over or points are to be found in it.
  ContactFrame before;
  Column<EndedContact> ended;
  /// Without carry-over and between two calls they are empty: the frame has the same.
  PairRecords records;
  PairRecords records_before;
  KnownBodies known;
  Column<CarriedPair> carried;
  Column<CarriedPair> carried_before;
  /// Pairs of bodies that sleep, with what is known of them; sorted.
  ContactFrame dormant;
  PairRecords dormant_records;
  Column<CarriedPair> dormant_carried;
  /// Of what is shown.
  ContactHistory history;
  /// Which scene filled these, and how it stood then.
  std::uint64_t scene = 0;
  std::uint32_t clock = 0;
  std::uint64_t pairs_serial = 0;
  std::uint64_t regroupings = 0;
  std::size_t carried_count = 0;

  /// By pair of the scene: the record it had, and where its answer comes from.
  Column<std::uint32_t> old_record;
  Column<std::uint32_t> source;
  Column<std::uint8_t> origin;
  /// By pair of the last frame: shown again.
  Column<std::uint8_t> shown_again;
  /// What tasks counted, then where they write.
  Column<ContactFrame::Place> sums;
  /// Every pair shown persisted and none ended.
  bool is_settled = false;

  void clear() noexcept;
  /// See Scene::reserve_contacts (reserve.cpp).
  [[nodiscard]] bool reserve(const SceneRoom& room, const SceneOptions& options,
                             Pages pages) noexcept;
};

}  // namespace winnow
