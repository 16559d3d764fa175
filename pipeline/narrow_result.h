#pragma once

// The result of NarrowPhase::collide, in columns. Scene::collide copies it to Contacts.

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// A run of consecutive answers in a NarrowResult whose shapes have the same two kinds.
struct NarrowRun {
  ShapeKind a{};            ///< kind of the first shapes
  ShapeKind b{};            ///< kind of the second shapes, not below a
  std::uint32_t first = 0;  ///< first answer of the run
  std::uint32_t count = 0;  ///< number of answers
};

/// Contact points, in columns.
struct ContactColumns {
  /// Creates empty columns. Every allocation comes from `memory`, which must outlive them.
  explicit ContactColumns(std::pmr::memory_resource* memory) noexcept;

  /// Reserves memory for `count` points, and writes to pages if they are to be prefaulted. False if
  /// memory is refused.
  [[nodiscard]] bool grow(std::size_t count, Pages pages = Pages::untouched) noexcept;
  /// Sets the number of points to `count`, within the reserved memory (see `grow`). New points are
  /// not initialised.
  void set_size(std::size_t count) noexcept;
  /// Returns the number of points.
  [[nodiscard]] std::size_t size() const noexcept { return depth.size(); }
  /// Returns the bytes of all columns.
  [[nodiscard]] Bytes bytes() const noexcept;

  Column<float> position[3];      ///< x, y and z; see ContactPoint
  Column<float> depth;            ///< positive where the bodies overlap
  Column<std::uint64_t> feature;  ///< see ContactPoint
};

struct NarrowColumns;

/// Results of the narrow phase in columns, grouped by the kinds of the shapes; within a group in
/// the order of the input. The caller keeps the object from frame to frame.
class WINNOW_API NarrowResult {
 public:
  /// Creates an empty result. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first use.
  explicit NarrowResult(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Returns the number of answers: one for each pair of the input.
  [[nodiscard]] std::size_t size() const noexcept {
    return level_ == ContactLevel::boolean ? overlap_.size() : distance_.size();
  }
  /// Returns the level of the last call. Columns of higher levels are empty.
  [[nodiscard]] ContactLevel level() const noexcept { return level_; }
  /// Returns the input pair that answer i belongs to. Points, normals and features follow the order
  /// (a, b) of that pair, not of the kinds.
  [[nodiscard]] std::uint32_t pair_of(std::size_t i) const noexcept { return order_[i]; }
  /// Returns the input pair of every answer.
  [[nodiscard]] std::span<const std::uint32_t> order() const noexcept {
    return {order_.data(), order_.size()};
  }
  /// Returns the runs of answers with the same two kinds of shapes; together they are all answers.
  [[nodiscard]] std::span<const NarrowRun> runs() const noexcept {
    return {runs_.data(), runs_.size()};
  }

  /// True if the shapes share a point. Available at every level.
  [[nodiscard]] bool overlaps(std::size_t i) const noexcept {
    return level_ == ContactLevel::boolean ? overlap_[i] != 0 : distance_[i] <= 0.0;
  }
  /// Returns, at level boolean, for each answer whether the shapes share a point; nonzero if they
  /// do.
  [[nodiscard]] std::span<const std::uint8_t> overlap() const noexcept {
    return {overlap_.data(), overlap_.size()};
  }
  /// Returns the signed distances, minus the penetration depth if the shapes overlap; <= 0 exactly
  /// if they share a point. At level manifold, for a pair whose gap exceeds the margin, it may be
  /// any lower bound of the distance above the margin. Levels distance and manifold.
  [[nodiscard]] std::span<const double> distance() const noexcept { return span(distance_); }
  /// Returns the error bounds: the true distance is within distance +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return span(error_bound_); }
  /// Returns the unit normals from a to b, in world axes.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept {
    return span(normal_[axis]);
  }
  /// Returns, at level distance, the closest (or deepest) point of a, relative to the position of
  /// body a, in world axes. The point of b is point + distance * normal.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept {
    return span(point_[axis]);
  }
  /// Returns, at level manifold, the first point of each answer: its points are elements
  /// [contact_first()[i], contact_first()[i] + contact_count()[i]) of the contact columns.
  [[nodiscard]] std::span<const std::uint32_t> contact_first() const noexcept {
    return {contact_first_.data(), contact_first_.size()};
  }
  /// Returns the number of points of each answer, 0 to kManifoldPoints.
  [[nodiscard]] std::span<const std::uint32_t> contact_count() const noexcept {
    return {contact_count_.data(), contact_count_.size()};
  }
  /// Returns the number of points of all answers.
  [[nodiscard]] std::size_t contacts() const noexcept { return contacts_.size(); }
  /// Returns one point; the index is below contacts(). O(1).
  [[nodiscard]] ContactPoint contact(std::size_t point) const noexcept {
    return {
        {contacts_.position[0][point], contacts_.position[1][point], contacts_.position[2][point]},
        contacts_.depth[point],
        contacts_.feature[point]};
  }
  /// Returns the points as columns.
  [[nodiscard]] const ContactColumns& contact_columns() const noexcept { return contacts_; }

  /// Returns the columns for corrections in place, by the library. Written values must agree with
  /// what the accessors guarantee.
  [[nodiscard]] NarrowColumns columns() noexcept;

  /// Returns the memory of all columns. `results.reserved` is exactly the number of bytes that are
  /// allocated from the resource; all other purposes are 0.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class NarrowPhase;
  /// Allocates the columns of a level, and no others. False if memory is refused.
  [[nodiscard]] bool resize(std::size_t count, ContactLevel level) noexcept;
  void clear() noexcept;
  [[nodiscard]] static std::span<const double> span(const Column<double>& c) noexcept {
    return {c.data(), c.size()};
  }

  ContactLevel level_ = ContactLevel::boolean;
  Column<std::uint32_t> order_;
  Column<NarrowRun> runs_;
  Column<std::uint8_t> overlap_;
  Column<double> distance_;
  Column<double> error_bound_;
  Column<double> normal_[3];
  Column<double> point_[3];
  Column<std::uint32_t> contact_first_;
  Column<std::uint32_t> contact_count_;
  ContactColumns contacts_;
};

}  // namespace winnow
