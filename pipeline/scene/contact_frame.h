#pragma once

// Storage of Contacts: the columns of one frame, and the records that `collide` keeps from one call
// to the next. contacts.cpp implements it; Collision (collision.h) fills it.

#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/scene/body_pairs.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

struct SceneOptions;
struct SceneCapacity;

/// No index.
inline constexpr std::uint32_t kNoEntry = ~0U;

/// The columns that Contacts show. Pairs are sorted like BodyPairs. Client data is in
/// ContactsState::known.
struct ContactFrame {
  explicit ContactFrame(std::pmr::memory_resource* memory) noexcept;

  Column<ContactRun> runs;
  Column<Key> key[2];
  Column<ContactEvent> event;
  /// One element more than pairs; likewise `point_first` has one more than manifolds.
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
  /// The scene has a composite shape (see SceneState::has_composites).
  bool with_parts = false;

  [[nodiscard]] std::size_t pairs() const noexcept { return event.size(); }
  /// True if the columns have the capacity for these counts.
  [[nodiscard]] bool has_room(ContactLevel level, std::size_t pair_count,
                              std::size_t manifold_count, std::size_t point_count) const noexcept;
  [[nodiscard]] std::uint32_t part_of(int side, std::size_t manifold) const noexcept {
    return with_parts ? part[side][manifold] : kWholeShape;
  }
  /// Resizes the columns that a level uses and empties the others. Returns false if memory is
  /// refused.
  [[nodiscard]] bool resize(ContactLevel level, std::size_t pair_count, std::size_t manifold_count,
                            std::size_t point_count) noexcept;
  /// Reserves capacity for these counts at a level, for the largest number of runs, and for parts
  /// if `parts`. Returns false if memory is refused.
  [[nodiscard]] bool reserve(ContactLevel level, bool parts, std::size_t pair_count,
                             std::size_t manifold_count, std::size_t point_count,
                             Pages pages) noexcept;
  /// Reserves the same capacities as another frame, so that the two can be swapped.
  [[nodiscard]] bool reserve_as(const ContactFrame& other) noexcept;
  void clear() noexcept;
  void swap(ContactFrame& other) noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

  /// A write position: the next pair, manifold and point.
  struct Cursor {
    std::uint32_t pair = 0;
    std::uint32_t manifold = 0;
    std::uint32_t point = 0;

    Cursor& operator+=(const Cursor& other) noexcept {
      pair += other.pair;
      manifold += other.manifold;
      point += other.point;
      return *this;
    }
  };
  /// Number of pairs, manifolds and points in pairs [first, first + count).
  [[nodiscard]] Cursor extent(std::uint32_t first, std::uint32_t count = 1) const noexcept;
  /// Copies pairs [first, first + count) of another frame of the same level to a position, with
  /// manifolds and points but not runs. If the other frame has only pairs, the copies have no
  /// manifolds.
  void copy(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
            const Cursor& to) noexcept;
  /// Writes the last elements of manifold_first and point_first.
  void close(ContactLevel level, const Cursor& end) noexcept;

 private:
  /// Calls make(column, count) for every column except runs and points, until it returns false.
  template <typename Make>
  [[nodiscard]] bool make_columns(ContactLevel level, bool parts, std::size_t pair_count,
                                  std::size_t manifold_count, Make&& make) noexcept;
  void copy_points(const ContactFrame& other, std::uint32_t first, std::uint32_t count,
                   const Cursor& to) noexcept;
};

/// Records of the pairs of one frame, sorted like BodyPairs.
///
/// With caching, ContactsState has records of all pairs, in contact or not, from call to call.
/// Without, `collide` lists the records of the pairs in the last frame before it overwrites that
/// frame, and drops them at its end. It lists only `bits`, in the spare buffer of BodyPairs, if no
/// pair sleeps: record i then belongs to pair i of the frame.
struct PairRecords {
  explicit PairRecords(std::pmr::memory_resource* memory) noexcept
      : bits(memory), frame_index(memory) {}

  /// PairOrder::bits.
  Column<std::uint64_t> bits;
  /// Index of the pair in the ContactFrame, or kNoEntry if it is not in contact. Empty if record i
  /// belongs to pair i of the frame.
  Column<std::uint32_t> frame_index;

  [[nodiscard]] std::size_t size() const noexcept { return bits.size(); }
  [[nodiscard]] PairOrder order_of(std::size_t record) const noexcept { return {bits[record]}; }
  [[nodiscard]] std::uint32_t frame_index_of(std::size_t record) const noexcept {
    return frame_index.empty() ? static_cast<std::uint32_t>(record) : frame_index[record];
  }
  void push_back_within_room(PairOrder of, std::uint32_t at) noexcept {
    (void)bits.push_back(of.bits);
    (void)frame_index.push_back(at);
  }
  [[nodiscard]] bool reserve(std::size_t count, Pages pages = Pages::untouched) noexcept {
    return bits.reserve(count, pages) && frame_index.reserve(count, pages);
  }
  void clear() noexcept {
    bits.clear();
    frame_index.clear();
  }
  void swap(PairRecords& other) noexcept {
    bits.swap(other.bits);
    frame_index.swap(other.frame_index);
  }
  [[nodiscard]] Bytes bytes() const noexcept {
    Bytes sum = bits.bytes();
    sum += frame_index.bytes();
    return sum;
  }
};

/// Keys and client data of all bodies when contacts were last filled, by id. Another body may have
/// the same id now.
struct KnownBodies {
  explicit KnownBodies(std::pmr::memory_resource* memory) noexcept : stamp(memory), data(memory) {}

  Column<std::uint32_t> stamp;  ///< stamp of the key
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

/// Data of a pair, in or out of contact, in a scene with caching.
struct CachedPair {
  /// A limit that forces new contacts in the next frame, even if the pair does not move.
  static constexpr float kNever = -1.0F;

  /// Relative pose at the time the manifolds were computed: b in the frame of a, or a in the frame
  /// of b if `from_b`.
  Pose relative;
  /// Orientation of a for which normals and points are stored.
  Quaternion turned_for;
  /// The pair may move by at most this, relative to `relative`, before its contacts are computed
  /// again.
  float limit;
  /// While the pair sleeps and when it wakes: the clock of the last call that tested it.
  std::uint32_t tested_at;
  /// Radius of the smaller body, which is the one whose relative pose is stored.
  float radius;
  /// Radius of body a.
  float radius_a;
  /// Accumulated float error from rotating the points, as a length.
  float drift;
  bool from_b;
  /// `error_bound` includes the cache tolerance.
  bool widened;
};

/// Maps the pairs and points of a ContactFrame to their indices in the frame before, for warm
/// starts. Empty without SceneOptions::warm_start.
struct ContactHistory {
  explicit ContactHistory(std::pmr::memory_resource* memory) noexcept
      : pair(memory), point(memory), taken(memory), pose(memory) {}

  /// Index in the frame before, by pair and by point, or kNoContact.
  Column<std::uint32_t> pair;
  Column<std::uint32_t> point;
  /// By point of the frame before: 1 if a point of this frame matched it.
  Column<std::uint8_t> taken;
  /// Pose at the last `collide`, by body id.
  Column<Pose> pose;
  /// The last call kept the whole frame: every pair and point maps to itself.
  bool is_same = false;

  void clear() noexcept;
  /// Reserves for Scene::reserve_contacts.
  [[nodiscard]] bool reserve(std::size_t pairs, std::size_t points, std::size_t bodies,
                             Pages pages) noexcept;
};

/// The call of `collide` that filled Contacts.
struct ContactsOrigin {
  std::uint64_t scene = 0;  // serial number of the scene; 0: no call
  std::uint32_t clock = 0;  // of the scene
  std::uint64_t pairs_serial = 0;

  friend constexpr bool operator==(const ContactsOrigin&, const ContactsOrigin&) noexcept = default;
};

/// The state of Contacts.
struct ContactsState {
  explicit ContactsState(std::pmr::memory_resource* memory) noexcept;

  ContactLevel level = ContactLevel::pairs;
  ContactFrame frame;
  /// The last frame, if manifolds are cached or points are matched with it.
  ContactFrame before;
  Column<EndedContact> ended;
  /// See PairRecords for when they are not empty.
  PairRecords records;
  PairRecords records_before;
  KnownBodies known;
  Column<CachedPair> cached;
  Column<CachedPair> cached_before;
  /// Pairs of sleeping bodies with their records, sorted.
  ContactFrame dormant;
  PairRecords dormant_records;
  Column<CachedPair> dormant_cached;
  /// Previous indices of the pairs and points in `frame`.
  ContactHistory history;
  /// The scene that filled these contacts, and its counters at that time.
  std::uint64_t scene = 0;
  std::uint32_t clock = 0;
  std::uint64_t pairs_serial = 0;
  std::uint64_t regroupings = 0;
  std::size_t cached_count = 0;

  /// By pair of the batch (`old_record` and `source` with caching: of the scene): its record of
  /// the last call; its index in the input of the narrow phase; and its ContactSource.
  Column<std::uint32_t> old_record;
  Column<std::uint32_t> input;
  Column<std::uint8_t> source;
  /// By pair of the last frame: 1 if the pair is in the new frame too.
  Column<std::uint8_t> is_in_new_frame;
  /// Counts by task, which become the write positions of the tasks.
  Column<ContactFrame::Cursor> sums;
  /// In the last call all pairs persisted and none ended.
  bool is_settled = false;

  [[nodiscard]] ContactsOrigin origin() const noexcept { return {scene, clock, pairs_serial}; }
  void clear() noexcept;
  /// Implements Scene::reserve_contacts (reserve.cpp).
  [[nodiscard]] bool reserve(const SceneCapacity& room, const SceneOptions& options,
                             Pages pages) noexcept;
};

}  // namespace winnow
