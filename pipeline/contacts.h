#pragma once

// The result of `Scene::collide`: pairs, manifolds and points in columns, and events. Contacts also
// store what events, the contact cache and warm starts need of the previous frame. See
// scene/contacts.cpp.

#include <winnow/core/export.h>
#include <winnow/core/indexed_view.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/contact_types.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct ContactColumns;
class Contacts;
struct ContactsState;

/// Whether a pair of bodies was present when these Contacts were last filled.
enum class ContactEvent : std::uint8_t {
  begun,      ///< it was not present
  persisted,  ///< it was present
};

/// A run of consecutive pairs whose shapes have the same two kinds. Kinds are numbered as in
/// ShapeId::kind_index.
struct ContactRun {
  std::uint8_t kind_a = 0;  ///< kind of the shapes of a
  std::uint8_t kind_b = 0;  ///< kind of the shapes of b, not below kind_a
  std::uint32_t first = 0;  ///< first pair of the run
  std::uint32_t count = 0;  ///< number of pairs
};

/// A pair that was present when these Contacts were last filled and is not now. The key of a
/// removed body is stale.
struct EndedContact {
  Key a;                  ///< first body of the pair
  Key b;                  ///< second body of the pair
  ClientData data_a = 0;  ///< client data of a
  ClientData data_b = 0;  ///< client data of b
};

namespace detail {

/// Function that returns the client data of a pair's body; see DataColumn.
struct DataLookup {
  const Key* bodies;       ///< body of each pair
  const ClientData* data;  ///< client data, by body id

  /// Returns the client data of pair i.
  [[nodiscard]] ClientData operator()(std::size_t i) const noexcept { return data[bodies[i].id]; }
};

/// Function that returns a part of a composite shape; see PartColumn.
struct PartLookup {
  const std::uint32_t* parts;  ///< part of each manifold; null if all shapes are convex

  /// Returns the part of manifold m.
  [[nodiscard]] std::uint32_t operator()(std::size_t m) const noexcept {
    return parts != nullptr ? parts[m] : kWholeShape;
  }
};

}  // namespace detail

/// Client data of one body of each pair. Used like a span: size(), [i], begin(), end().
using DataColumn = IndexedView<detail::DataLookup>;
/// Part of one shape in each manifold. Used like a span.
using PartColumn = IndexedView<detail::PartLookup>;

namespace detail {

/// Function that returns a point of a manifold.
struct PointLookup {
  const Contacts* contacts;  ///< contacts that contain the point
  std::uint32_t first;       ///< first point of the manifold

  /// Returns point i of the manifold.
  [[nodiscard]] ContactPoint operator()(std::size_t i) const noexcept;
};

}  // namespace detail

/// A manifold of Contacts, and the range of its points, which is empty below level manifold. Valid
/// until the contacts change.
class WINNOW_API ContactManifold : public IndexedView<detail::PointLookup> {
 public:
  /// Reads manifold `index` of the contacts.
  ContactManifold(const Contacts& contacts, std::uint32_t index) noexcept;

  /// Returns the index of the manifold in the columns of the contacts.
  [[nodiscard]] std::uint32_t index() const noexcept { return index_; }
  /// As Contacts::distance; 0 at level boolean.
  [[nodiscard]] double distance() const noexcept;
  /// As Contacts::error_bound; 0 at level boolean.
  [[nodiscard]] double error_bound() const noexcept;
  /// Unit normal from a to b, in world axes; zero at level boolean.
  [[nodiscard]] Vec3d normal() const noexcept;
  /// As Contacts::point; zero except at level distance.
  [[nodiscard]] Vec3d point() const noexcept;
  /// As Contacts::part_a.
  [[nodiscard]] std::uint32_t part_a() const noexcept;
  /// As Contacts::part_b.
  [[nodiscard]] std::uint32_t part_b() const noexcept;

 private:
  std::uint32_t index_;
};

namespace detail {

/// Function that returns a manifold of a pair.
struct ManifoldLookup {
  const Contacts* contacts;  ///< contacts that contain the manifold
  std::uint32_t first;       ///< first manifold of the pair

  /// Returns manifold i of the pair.
  [[nodiscard]] ContactManifold operator()(std::size_t i) const noexcept {
    return {*contacts, first + static_cast<std::uint32_t>(i)};
  }
};

}  // namespace detail

/// A pair of bodies of Contacts, and the range of its manifolds, which is empty at level pairs.
/// Valid until the contacts change.
class WINNOW_API ContactPair : public IndexedView<detail::ManifoldLookup> {
 public:
  /// Reads pair `index` of the contacts.
  ContactPair(const Contacts& contacts, std::size_t index) noexcept;

  /// Returns the index of the pair in the columns of the contacts.
  [[nodiscard]] std::size_t index() const noexcept { return index_; }
  [[nodiscard]] Key a() const noexcept;               ///< first body
  [[nodiscard]] Key b() const noexcept;               ///< second body
  [[nodiscard]] ClientData data_a() const noexcept;   ///< client data of a
  [[nodiscard]] ClientData data_b() const noexcept;   ///< client data of b
  [[nodiscard]] ContactEvent event() const noexcept;  ///< whether the pair is new

 private:
  std::size_t index_;
};

namespace detail {

/// Function that returns a pair of Contacts.
struct PairLookup {
  const Contacts* contacts;  ///< contacts that contain the pair

  /// Returns pair i.
  [[nodiscard]] ContactPair operator()(std::size_t i) const noexcept { return {*contacts, i}; }
};

}  // namespace detail

/// Result of `Scene::collide`, in columns: pairs of bodies, sorted by the kinds of their shapes,
/// then by body; for each pair its manifolds; for each manifold its points. A pair of convex shapes
/// has one manifold. A pair with a composite shape has one per contact region, or one per pair of
/// parts that touch (see SceneOptions::part_manifolds). In a pair, a is the body with the smaller
/// kind of shape, or with the smaller id if the kinds are equal.
///
/// Pairs, manifolds and points can also be read as nested ranges:
///
///     for (const winnow::ContactPair& pair : contacts) {
///       for (const winnow::ContactManifold& manifold : pair) {
///         for (const winnow::ContactPoint& point : manifold) { ... }
///       }
///     }
///
/// The caller keeps the object from frame to frame: it stores the previous frame, for events and
/// for contacts that are cached. A new or cleared object stores no previous frame. It is not
/// thread-safe. If memory for the object itself is refused, it stays empty and `collide` returns
/// `out_of_memory`.
class WINNOW_API Contacts {
 public:
  /// Creates empty contacts. Every allocation comes from `memory`, which must outlive the object.
  explicit Contacts(std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~Contacts();
  Contacts(const Contacts&) = delete;
  Contacts& operator=(const Contacts&) = delete;

  /// Returns the level of the last `collide`. Columns of higher levels are empty.
  [[nodiscard]] ContactLevel level() const noexcept;
  /// Returns the number of pairs.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns pair i; i must be below `size()`.
  [[nodiscard]] ContactPair operator[](std::size_t i) const noexcept { return {*this, i}; }
  /// Iterators over the pairs.
  /// @{
  [[nodiscard]] IndexedView<detail::PairLookup>::iterator begin() const noexcept {
    return {detail::PairLookup{this}, 0};
  }
  [[nodiscard]] IndexedView<detail::PairLookup>::iterator end() const noexcept {
    return {detail::PairLookup{this}, size()};
  }
  /// @}
  /// Returns the runs of pairs with the same two kinds of shapes; together they are all pairs.
  [[nodiscard]] std::span<const ContactRun> runs() const noexcept;
  /// Returns the first body of each pair.
  [[nodiscard]] std::span<const Key> a() const noexcept;
  /// Returns the second body of each pair.
  [[nodiscard]] std::span<const Key> b() const noexcept;
  /// Returns the client data of the first bodies, as of the last `collide`. It is looked up by
  /// body; no column of it is stored.
  [[nodiscard]] DataColumn data_a() const noexcept;
  /// Returns the client data of the second bodies.
  [[nodiscard]] DataColumn data_b() const noexcept;
  /// Returns for each pair whether it is new in this frame.
  [[nodiscard]] std::span<const ContactEvent> event() const noexcept;
  /// Returns the pairs that ended, in the same order for any number of threads.
  [[nodiscard]] std::span<const EndedContact> ended() const noexcept;

  /// Returns the first manifold of each pair: the manifolds of pair i are [manifold_first()[i],
  /// manifold_first()[i + 1]). Empty at level pairs.
  [[nodiscard]] std::span<const std::uint32_t> manifold_first() const noexcept;
  /// Returns the number of manifolds.
  [[nodiscard]] std::size_t manifolds() const noexcept;
  /// Returns the part of a in each manifold (of its deepest manifold, for a contact region): the
  /// number of the triangle or child; kWholeShape for a convex shape. In scenes with only convex
  /// shapes no column is stored.
  [[nodiscard]] PartColumn part_a() const noexcept;
  /// Returns the part of b in each manifold.
  [[nodiscard]] PartColumn part_b() const noexcept;
  /// Returns the signed distance of each manifold, minus the penetration depth if the bodies
  /// overlap. The true value is within distance +- error_bound. Levels distance and manifold.
  [[nodiscard]] std::span<const double> distance() const noexcept;
  /// Returns the error bound of each distance, in either direction; a length.
  [[nodiscard]] std::span<const double> error_bound() const noexcept;
  /// Returns the unit normals from a to b, in world axes.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept;
  /// Returns, at level distance, the closest (or deepest) point of a, relative to the position of
  /// body a. The point of b is point + distance * normal.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept;

  /// Returns, at level manifold, the first point of each manifold: the points of manifold m are
  /// [point_first()[m], point_first()[m + 1]). Point positions are relative to the position of body
  /// a, in world axes, halfway between the surfaces.
  [[nodiscard]] std::span<const std::uint32_t> point_first() const noexcept;
  /// Returns the number of points.
  [[nodiscard]] std::size_t points() const noexcept;
  /// Returns one point; the index is below points(). O(1).
  [[nodiscard]] ContactPoint contact(std::size_t point) const noexcept;
  /// Returns all points as columns.
  [[nodiscard]] const ContactColumns& contact_columns() const noexcept;

  /// Returns the index of each pair in the previous frame (when these Contacts were last filled),
  /// or kNoContact. A solver warm starts with one gather:
  ///
  ///     impulse[i] = before[i] == kNoContact ? 0 : last_impulse[before[i]]
  ///
  /// Only for a scene with SceneOptions::warm_start, otherwise empty. No two pairs have the same
  /// index. New pairs and pairs that were asleep have kNoContact.
  [[nodiscard]] std::span<const std::uint32_t> previous_pair() const noexcept;
  /// Returns, at level manifold, the index of each point in the previous frame, or kNoContact, as
  /// for `previous_pair`. No two points have the same index. Points of a persisting pair are
  /// matched in this order: the same feature between the same parts; with contact reduction, the
  /// same feature; then the nearest remaining point, if it moved by at most 1/50 of the smaller
  /// body's radius in the frame of body a or of body b. The last step is skipped if the pair has
  /// more than 256 unmatched points in the previous frame.
  [[nodiscard]] std::span<const std::uint32_t> previous_point() const noexcept;

  /// Returns the number of pairs that kept their previous manifolds; see
  /// SceneOptions::cache_tolerance.
  [[nodiscard]] std::size_t cached_pairs() const noexcept;

  /// Removes all contents; memory is kept.
  void clear() noexcept;
  /// Returns the bytes of readable columns under `results`, of the data kept between frames under
  /// `scratch`, and of the object itself under `structure`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class Scene;
  friend class RankScene;
  /// Returns the state, or an empty one if memory was refused.
  [[nodiscard]] const ContactsState& state() const noexcept;

  std::pmr::memory_resource* memory_;
  /// Null if memory was refused.
  ContactsState* state_;
};

}  // namespace winnow
