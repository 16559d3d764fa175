#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/footprint.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/narrow/narrow_job.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/solver/solver.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// How exact an answer must be. All of them carry an error bound that holds.
enum class NarrowTier : std::uint8_t {
  /// Float lanes. Errors of about 1e-6 of the sizes; the sign may be wrong within the bound.
  fast,
  /// Errors of at most 4e-7 x (sizes + |distance|), usually 1e-15; the sign is right, also where
  /// shapes touch. What the lanes cannot certify is solved again, one pair at a time.
  robust,
  /// Every pair by the solver.
  reference,
};

struct NarrowOptions {
  NarrowLevel level = NarrowLevel::manifold;
  NarrowTier tier = NarrowTier::robust;
  /// Speculative: pairs no farther apart than this get contacts, with depth <= 0. Finite, >= 0.
  double margin = 0.0;
  Execution execution = Execution::serial();
};

/// What moves: body i has shape shapes[i] at poses[i].
struct Bodies {
  std::span<const ShapeId> shapes;
  std::span<const Pose> poses;
};

/// Pairs of one kind, next to each other in a NarrowResult.
struct NarrowRun {
  ShapeKind a{};
  ShapeKind b{};
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

struct NarrowStatistics {
  std::uint64_t pairs = 0;
  /// Pairs that lanes could not certify, or that have no lanes: answered by the solver.
  std::uint64_t recomputed = 0;
  std::uint64_t without_lanes = 0;
  SolverCounts solver;
};

/// Answers as columns, grouped by pair kind; within a kind in the order of the input. The caller's,
/// reused from frame to frame.
class NarrowResult {
 public:
  explicit NarrowResult(
      std::pmr::memory_resource* memory = std::pmr::get_default_resource()) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] NarrowLevel level() const noexcept { return level_; }
  /// Which pair of the input answer i is about. Points, normals and features are in its order, not
  /// that of the kinds.
  [[nodiscard]] std::uint32_t pair_of(std::size_t i) const noexcept { return order_[i]; }
  [[nodiscard]] std::span<const NarrowRun> runs() const noexcept {
    return {runs_.data(), runs_.size()};
  }

  /// At every level.
  [[nodiscard]] bool overlaps(std::size_t i) const noexcept {
    return level_ == NarrowLevel::boolean ? overlap_[i] != 0 : distance_[i] <= 0.0;
  }
  /// Levels distance and manifold; see NarrowJob for what each column says.
  [[nodiscard]] std::span<const double> distance() const noexcept { return span(distance_); }
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return span(error_bound_); }
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept {
    return span(normal_[axis]);
  }
  /// Level distance.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept {
    return span(point_[axis]);
  }
  /// Level manifold: points of pair i are [contact_first()[i], + contact_count()[i]) of the columns
  /// of contacts.
  [[nodiscard]] std::span<const std::uint32_t> contact_first() const noexcept {
    return {contact_first_.data(), contact_first_.size()};
  }
  [[nodiscard]] std::span<const std::uint32_t> contact_count() const noexcept {
    return {contact_count_.data(), contact_count_.size()};
  }
  [[nodiscard]] std::size_t contacts() const noexcept { return depth_.size(); }
  [[nodiscard]] ContactPoint contact(std::size_t point) const noexcept {
    return {{position_[0][point], position_[1][point], position_[2][point]},
            depth_[point],
            feature_[point]};
  }

  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class NarrowPhase;
  [[nodiscard]] static std::span<const double> span(const Column<double>& c) noexcept {
    return {c.data(), c.size()};
  }

  std::size_t size_ = 0;
  NarrowLevel level_ = NarrowLevel::boolean;
  Column<std::uint32_t> order_;
  Column<NarrowRun> runs_;
  Column<std::uint8_t> overlap_;
  Column<double> distance_;
  Column<double> error_bound_;
  Column<double> normal_[3];
  Column<double> point_[3];
  Column<std::uint32_t> contact_first_;
  Column<std::uint32_t> contact_count_;
  Column<float> position_[3];
  Column<float> depth_;
  Column<std::uint64_t> feature_;
};

/// Pairs of bodies to overlaps, distances or contacts. Sorts pairs by the kinds of their shapes and
/// computes those of one kind many at a time. Keeps scratch memory from call to call: one object a
/// thread of the caller.
class NarrowPhase {
 public:
  explicit NarrowPhase(
      std::pmr::memory_resource* memory = std::pmr::get_default_resource()) noexcept;

  /// Answers all pairs. `invalid_argument` for a bad margin or a body that does not exist,
  /// `size_mismatch` for spans of different lengths, `invalid_key` for an id that the pool does not
  /// know, `invalid_pose` if a body of a pair has one: then `result` is empty and `bad_body` tells.
  Status collide(const ShapePool& shapes, const Bodies& bodies, std::span<const BodyPair> pairs,
                 const NarrowOptions& options, NarrowResult& result);

  /// Of the last call.
  [[nodiscard]] const NarrowStatistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] std::uint32_t bad_body() const noexcept { return bad_body_; }

  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  struct Call;

  std::pmr::memory_resource* memory_;
  NarrowStatistics statistics_;
  std::uint32_t bad_body_ = 0;
  Column<BodyPair> sorted_;
  Column<std::uint8_t> kinds_;
  Column<std::uint32_t> uncertified_;
};

}  // namespace winnow
