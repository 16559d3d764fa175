#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/looked_up.h>
#include <winnow/pipeline/contact_types.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct ContactColumns;
struct ContactsState;

/// What became of a pair of bodies since these Contacts were last filled.
enum class ContactEvent : std::uint8_t {
  begun,      ///< it was not there
  persisted,  ///< it was
};

/// Pairs of bodies whose shapes are of the same two kinds, next to each other. Kinds as in
/// ShapeId::kind_index.
struct ContactRun {
  std::uint8_t kind_a = 0;  ///< of the shapes of a
  std::uint8_t kind_b = 0;  ///< of the shapes of b, not below kind_a
  std::uint32_t first = 0;  ///< pair that the run begins with
  std::uint32_t count = 0;  ///< pairs in it
};

/// A pair that was there when these Contacts were last filled and is not now. A removed body's key
/// is stale.
struct EndedContact {
  Key a;                  ///< the body that was a
  Key b;                  ///< the body that was b
  ClientData data_a = 0;  ///< that a was added with
  ClientData data_b = 0;  ///< that b was added with
};

/// Client data by body.
struct DataLookup {
  const Key* bodies;       ///< of each pair
  const ClientData* data;  ///< by id of a body

  /// Of pair i.
  [[nodiscard]] ClientData operator()(std::size_t i) const noexcept { return data[bodies[i].id]; }
};

/// Parts of composite shapes.
struct PartLookup {
  const std::uint32_t* parts;  ///< of each manifold; null where all shapes are convex

  /// Of manifold m.
  [[nodiscard]] std::uint32_t operator()(std::size_t m) const noexcept {
    return parts != nullptr ? parts[m] : kWholeShape;
  }
};

/// Client data of one body of each pair: size(), [i], begin() and end(), as of a span.
using DataColumn = LookedUp<DataLookup>;
/// The part of one shape in each manifold, likewise.
using PartColumn = LookedUp<PartLookup>;

/// What `Scene::collide` found, as columns: pairs of bodies, sorted by the kinds of their shapes
/// and then by body; for each pair its manifolds, one for each region of contact, or for each pair
/// of parts that touch (see SceneOptions::contact_reduction; one alone if both shapes are convex);
/// for each manifold its points. In a pair, a is the body with the smaller kind of shape, or the
/// smaller id if they are of one kind.
///
/// The caller's, reused from frame to frame: it remembers what was found, so that events can be
/// told and manifolds of what rests carried over. Fresh ones, or cleared ones, remember nothing.
/// Not for use from two threads at once. Where memory for them is refused at once, `collide`
/// answers `out_of_memory` and they stay empty.
class WINNOW_API Contacts {
 public:
  /// Every allocation comes from `memory`, which must outlive the object.
  explicit Contacts(std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~Contacts();
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  /// What the last `collide` was asked for: columns of higher levels are empty.
  [[nodiscard]] ContactLevel level() const noexcept;
  /// Pairs of bodies.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Where pairs of each two kinds of shapes lie; together they are all pairs.
  [[nodiscard]] std::span<const ContactRun> runs() const noexcept;
  /// First body of each pair.
  [[nodiscard]] std::span<const Key> a() const noexcept;
  /// Second body of each pair.
  [[nodiscard]] std::span<const Key> b() const noexcept;
  /// Client data of the first bodies, as it was when these Contacts were filled. It is looked up by
  /// body: no column of it is kept.
  [[nodiscard]] DataColumn data_a() const noexcept;
  /// Client data of the second bodies.
  [[nodiscard]] DataColumn data_b() const noexcept;
  /// Whether each pair is new since the frame before.
  [[nodiscard]] std::span<const ContactEvent> event() const noexcept;
  /// Pairs that came to an end, in the same order on any number of threads.
  [[nodiscard]] std::span<const EndedContact> ended() const noexcept;

  /// Manifolds of pair i: [manifold_first()[i], manifold_first()[i + 1]). None at level pairs.
  [[nodiscard]] std::span<const std::uint32_t> manifold_first() const noexcept;
  /// All manifolds of all pairs.
  [[nodiscard]] std::size_t manifolds() const noexcept;
  /// The parts that touch, of a region those of its deepest manifold: numbers of triangles or
  /// children, kWholeShape of convex shapes. Of scenes in which all are convex no column of them is
  /// kept.
  [[nodiscard]] PartColumn part_a() const noexcept;
  /// The same of body b.
  [[nodiscard]] PartColumn part_b() const noexcept;
  /// Levels distance and manifold: negative by the depth of penetration; the true one is within
  /// distance +- error_bound.
  [[nodiscard]] std::span<const double> distance() const noexcept;
  /// By how much `distance` may be wrong, either way; a length.
  [[nodiscard]] std::span<const double> error_bound() const noexcept;
  /// Unit, from a to b, in the axes of the world.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept;
  /// Level distance: the closest (or deepest) point of a, relative to the position of body a. That
  /// of b is distance * normal farther.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept;

  /// Level manifold: points of manifold m are [point_first()[m], point_first()[m + 1]). Positions
  /// are relative to that of body a, in the axes of the world, halfway between the surfaces.
  [[nodiscard]] std::span<const std::uint32_t> point_first() const noexcept;
  /// All points of all manifolds.
  [[nodiscard]] std::size_t points() const noexcept;
  /// One point, below points(). O(1).
  [[nodiscard]] ContactPoint contact(std::size_t point) const noexcept;
  /// The same as columns.
  [[nodiscard]] const ContactColumns& contact_columns() const noexcept;

  /// Where a scene with SceneOptions::warm_start was asked, else empty: the index that each pair,
  /// and at level manifold each point, had when these Contacts were last filled, or kNoContact, so
  /// that a solver starts from what it found then by one gather:
  ///
  ///     impulse[i] = before[i] == kNoContact ? 0 : last_impulse[before[i]]
  ///
  /// No two have the same. Pairs that begin have none, nor do those that slept. Points of a pair
  /// that persists are, in this order: that of the same feature, between the same parts; with
  /// contact reduction that of the same feature; the nearest one left, where it moved by no more
  /// than 1/50 of the smaller body's radius in the frame of body a or in that of body b (unless
  /// more than 256 are left of one pair).
  [[nodiscard]] std::span<const std::uint32_t> previous_pair() const noexcept;
  /// The same of each point, into the points of the frame before.
  [[nodiscard]] std::span<const std::uint32_t> previous_point() const noexcept;

  /// How many pairs kept the manifolds they had.
  [[nodiscard]] std::size_t carried() const noexcept;

  /// Forgets everything; memory is kept.
  void clear() noexcept;
  /// Columns that can be read under `results`, what is remembered beside them under `scratch`, and
  /// what holds both under `structure`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class Scene;
  friend class RankScene;
  friend class RecordedScene;
  /// That of contacts with nothing in them where memory was refused.
  [[nodiscard]] const ContactsState& state() const noexcept;

  std::pmr::memory_resource* memory_;
  /// Null where memory was refused.
  ContactsState* state_;
};

}  // namespace winnow
