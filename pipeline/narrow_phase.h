#pragma once

// Contacts of pairs of shapes: NarrowPhase computes many pairs and writes a NarrowResult, `collide`
// computes one pair.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shape_pool.h>
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
  [[nodiscard]] std::span<const std::uint32_t> order() const noexcept { return order_; }
  /// Returns the runs of answers with the same two kinds of shapes; together they are all answers.
  [[nodiscard]] std::span<const NarrowRun> runs() const noexcept { return runs_; }

  /// True if the shapes share a point. Available at every level.
  [[nodiscard]] bool overlaps(std::size_t i) const noexcept {
    return level_ == ContactLevel::boolean ? overlap_[i] != 0 : distance_[i] <= 0.0;
  }
  /// Returns, at level boolean, for each answer whether the shapes share a point; nonzero if they
  /// do.
  [[nodiscard]] std::span<const std::uint8_t> overlap() const noexcept { return overlap_; }
  /// Returns the signed distances, minus the penetration depth if the shapes overlap; <= 0 exactly
  /// if they share a point. At level manifold, for a pair whose gap exceeds the margin, it may be
  /// any lower bound of the distance above the margin. Levels distance and manifold.
  [[nodiscard]] std::span<const double> distance() const noexcept { return distance_; }
  /// Returns the error bounds: the true distance is within distance +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return error_bound_; }
  /// Returns the unit normals from a to b, in world axes.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept { return normal_[axis]; }
  /// Returns, at level distance, the closest (or deepest) point of a, relative to the position of
  /// body a, in world axes. The point of b is point + distance * normal.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept { return point_[axis]; }
  /// Returns, at level manifold, the first point of each answer: its points are elements
  /// [contact_first()[i], contact_first()[i] + contact_count()[i]) of the contact columns.
  [[nodiscard]] std::span<const std::uint32_t> contact_first() const noexcept {
    return contact_first_;
  }
  /// Returns the number of points of each answer, 0 to kManifoldPoints.
  [[nodiscard]] std::span<const std::uint32_t> contact_count() const noexcept {
    return contact_count_;
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

  /// Returns the memory of all columns. `results.reserved` is exactly the number of bytes that are
  /// allocated from the resource; all other purposes are 0.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class NarrowPhase;
  friend struct NarrowColumns;

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

/// Precision of results. Every result has a valid error bound.
enum class NarrowTier : std::uint8_t {
  /// Errors of at most 4e-7 x (sizes + |distance|), usually 1e-15. The sign of the distance is
  /// exact, even if shapes just touch. Pairs that the SIMD lanes cannot certify are computed again,
  /// one at a time.
  robust,
  /// Computes every pair with the solver, the scalar reference implementation.
  reference,
};

/// Options of a narrow-phase call.
struct NarrowOptions {
  /// Any level but `pairs`, which uses no shapes.
  ContactLevel level = ContactLevel::manifold;
  NarrowTier tier = NarrowTier::robust;  ///< how exact results must be
  /// Contact margin: pairs whose gap is at most this get contact points (speculative contacts),
  /// with depth <= 0. Finite, >= 0.
  double contact_margin = 0.0;
  /// How work is run in parallel; results do not depend on it.
  Execution execution = Execution::serial();
  /// A contact margin for each pair, used instead of `contact_margin` if not empty. Finite, >= 0.
  std::span<const double> contact_margins{};
};

/// Bodies: body i has shape shapes[i] at poses[i].
struct Bodies {
  std::span<const ShapeId> shapes;  ///< one per body
  std::span<const Pose> poses;      ///< one per body
};

/// Counters of a call. They contain no timings, so that values repeat exactly.
struct NarrowStatistics {
  std::uint64_t pairs = 0;  ///< pairs computed
  /// Pairs that the lanes could not certify and the solver computed.
  std::uint64_t recomputed = 0;
  /// Pairs that were not tried in lanes: their kinds have no SIMD kernel, or the tier is
  /// `reference`.
  std::uint64_t without_lanes = 0;
  /// Pairs whose sign double precision could not decide; computed in exact arithmetic.
  std::uint64_t exact = 0;
  /// Searches of the solver that did not close their bounds; several may be of one pair.
  std::uint64_t bounded = 0;
};

/// Computes overlaps, distances or contacts of pairs of bodies. It sorts the pairs by the kinds of
/// their shapes and computes pairs of the same kinds together in SIMD lanes. It keeps scratch
/// memory between calls: use one object per calling thread. A moved-from object is as new.
class WINNOW_API NarrowPhase {
 public:
  /// Creates a narrow phase. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first call.
  explicit NarrowPhase(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  ~NarrowPhase();
  /// Takes the memory of `other`, which is then as new.
  NarrowPhase(NarrowPhase&& other) noexcept;

  /// Computes all pairs. `invalid_argument` for level `pairs`, an invalid contact margin or a body
  /// index out of range; `size_mismatch` for spans of different lengths (`contact_margins` may be
  /// empty); `invalid_key` for an id that the pool does not contain; `invalid_pose` if a body of a
  /// pair has an invalid pose (the orientation of a sphere is ignored); `out_of_memory`. After an
  /// error `result` is empty and `bad_body` returns the cause.
  Status collide(const ShapePool& shapes, const Bodies& bodies, std::span<const BodyPair> pairs,
                 const NarrowOptions& options, NarrowResult& result);
  /// As above, for shapes that are not stored in a pool.
  Status collide(const ShapeTables& tables, const Bodies& bodies, std::span<const BodyPair> pairs,
                 const NarrowOptions& options, NarrowResult& result);

  /// Returns the counters of the last call.
  [[nodiscard]] const NarrowStatistics& statistics() const noexcept { return statistics_; }
  /// Returns the index of the body that made the last call fail; ~0U if the call succeeded or
  /// failed for another reason.
  [[nodiscard]] std::uint32_t bad_body() const noexcept { return bad_body_; }

  /// Returns the bytes of scratch memory: exactly what is allocated from the resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  struct State;

  std::pmr::memory_resource* memory_;
  State* state_ = nullptr;
  NarrowStatistics statistics_;
  std::uint32_t bad_body_ = ~0U;
};

/// Computes one pair, shape a at pose_a and shape b at pose_b, like NarrowPhase::collide. It stores
/// and allocates nothing, so any number of threads may call it. For many pairs use NarrowPhase,
/// which fills the SIMD lanes. At level `boolean` only `overlap` of the answer is set; at
/// `distance` all but the contact points; at `manifold` all but `point`. Errors as for
/// NarrowPhase::collide; they leave `answer` unchanged.
/// @{
WINNOW_API Status collide(const ShapePool& shapes, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b, const NarrowOptions& options,
                          PairAnswer& answer) noexcept;
WINNOW_API Status collide(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b, const NarrowOptions& options,
                          PairAnswer& answer) noexcept;
/// @}

}  // namespace winnow
