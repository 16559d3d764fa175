#pragma once

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

/// Pairs of one kind, next to each other in a NarrowResult.
struct NarrowRun {
  ShapeKind a{};            ///< kind of the first shapes
  ShapeKind b{};            ///< kind of the second shapes, not below a
  std::uint32_t first = 0;  ///< answer that the run begins with
  std::uint32_t count = 0;  ///< answers in it
};

/// Contact points as columns.
struct ContactColumns {
  /// Every allocation comes from `memory`, which must outlive the columns.
  explicit ContactColumns(std::pmr::memory_resource* memory) noexcept;

  /// Room for `count` points. False if memory is refused.
  [[nodiscard]] bool grow(std::size_t count) noexcept;
  /// `count` points, of which new ones are not set; there must be room for them (see `grow`).
  void set_size(std::size_t count) noexcept;
  /// Writes to the pages behind the last point.
  void touch() noexcept {
    for (Column<float>& column : position) column.touch();
    depth.touch();
    feature.touch();
  }
  /// Points.
  [[nodiscard]] std::size_t size() const noexcept { return depth.size(); }
  /// Of all columns.
  [[nodiscard]] Bytes bytes() const noexcept;

  Column<float> position[3];      ///< x, y and z; as in ContactPoint
  Column<float> depth;            ///< positive where the bodies overlap
  Column<std::uint64_t> feature;  ///< as in ContactPoint
};

/// The columns of a NarrowResult to be written to: see the accessors of the same names. Those that
/// its level has not are empty.
struct NarrowColumns {
  std::span<double> distance;              ///< one of each answer
  std::span<double> error_bound;           ///< one of each answer
  std::span<double> normal[3];             ///< x, y, z
  std::span<double> point[3];              ///< x, y, z
  std::span<std::uint32_t> contact_first;  ///< into `contacts`
  std::span<std::uint32_t> contact_count;  ///< at most kManifoldPoints
  /// May grow.
  ContactColumns& contacts;
};

/// Answers as columns, grouped by pair kind; within a kind in the order of the input. The caller's,
/// reused from frame to frame.
class WINNOW_API NarrowResult {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// use.
  explicit NarrowResult(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Answers, one for each pair that was asked about.
  [[nodiscard]] std::size_t size() const noexcept {
    return level_ == ContactLevel::boolean ? overlap_.size() : distance_.size();
  }
  /// What the last call was asked for: columns of higher levels are empty.
  [[nodiscard]] ContactLevel level() const noexcept { return level_; }
  /// Which pair of the input answer i is about. Points, normals and features are in its order, not
  /// that of the kinds.
  [[nodiscard]] std::uint32_t pair_of(std::size_t i) const noexcept { return order_[i]; }
  /// The same of all answers.
  [[nodiscard]] std::span<const std::uint32_t> order() const noexcept {
    return {order_.data(), order_.size()};
  }
  /// Where answers of each two kinds of shapes lie; together they are all answers.
  [[nodiscard]] std::span<const NarrowRun> runs() const noexcept {
    return {runs_.data(), runs_.size()};
  }

  /// At every level.
  [[nodiscard]] bool overlaps(std::size_t i) const noexcept {
    return level_ == ContactLevel::boolean ? overlap_[i] != 0 : distance_[i] <= 0.0;
  }
  /// Level boolean: the same of all answers, not 0 where they do.
  [[nodiscard]] std::span<const std::uint8_t> overlap() const noexcept {
    return {overlap_.data(), overlap_.size()};
  }
  /// Levels distance and manifold. Negative by the penetration depth, and <= 0 exactly where the
  /// shapes share a point. At level manifold a pair farther apart than the margin may have any
  /// lower bound of its distance that is above the margin.
  [[nodiscard]] std::span<const double> distance() const noexcept { return span(distance_); }
  /// The true distance is within distance +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return span(error_bound_); }
  /// Unit vectors from a to b, in the axes of the world.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept {
    return span(normal_[axis]);
  }
  /// Level distance: the point of a, relative to the position of body a, in the axes of the world.
  /// That of b is distance * normal farther.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept {
    return span(point_[axis]);
  }
  /// Level manifold: points of pair i are [contact_first()[i], + contact_count()[i]) of the columns
  /// of contacts.
  [[nodiscard]] std::span<const std::uint32_t> contact_first() const noexcept {
    return {contact_first_.data(), contact_first_.size()};
  }
  /// Points of each pair, 0 to kManifoldPoints.
  [[nodiscard]] std::span<const std::uint32_t> contact_count() const noexcept {
    return {contact_count_.data(), contact_count_.size()};
  }
  /// All points of all pairs.
  [[nodiscard]] std::size_t contacts() const noexcept { return contacts_.size(); }
  /// One point, below contacts(). O(1).
  [[nodiscard]] ContactPoint contact(std::size_t point) const noexcept {
    return {
        {contacts_.position[0][point], contacts_.position[1][point], contacts_.position[2][point]},
        contacts_.depth[point],
        contacts_.feature[point]};
  }
  /// The points as columns.
  [[nodiscard]] const ContactColumns& contact_columns() const noexcept { return contacts_; }

  /// For who corrects answers where they stand (see MidPhase::smooth): what is written has to keep
  /// what the accessors say.
  [[nodiscard]] NarrowColumns columns() noexcept;

  /// All columns under `results`, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class NarrowPhase;
  /// Room for the columns that a level has, and no others. False if memory is refused.
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
