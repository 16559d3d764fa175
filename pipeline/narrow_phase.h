#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/narrow_result.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// How exact an answer must be. All of them carry an error bound that holds.
enum class NarrowTier : std::uint8_t {
  /// Errors of at most 4e-7 x (sizes + |distance|), usually 1e-15; the sign is right, also where
  /// shapes touch. What the lanes cannot certify is solved again, one pair at a time.
  robust,
  /// Every pair by the solver.
  reference,
};

/// What is asked about pairs of bodies, and how exactly.
struct NarrowOptions {
  /// Any but `pairs`, which asks nothing of shapes.
  ContactLevel level = ContactLevel::manifold;
  NarrowTier tier = NarrowTier::robust;  ///< how exact answers have to be
  /// Speculative: pairs no farther apart than this get contacts, with depth <= 0. Finite, >= 0.
  double margin = 0.0;
  /// On whose threads; answers are the same on all.
  Execution execution = Execution::serial();
  /// A margin for each pair in place of `margin`; empty: the same for all. Finite, >= 0.
  std::span<const double> margins{};
};

/// What moves: body i has shape shapes[i] at poses[i].
struct Bodies {
  std::span<const ShapeId> shapes;  ///< by body
  std::span<const Pose> poses;      ///< by body; as many
};

/// What a call did; counters, never timings, so that they repeat exactly.
struct NarrowStatistics {
  std::uint64_t pairs = 0;  ///< answered
  /// Pairs that lanes could not certify and the solver answered.
  std::uint64_t recomputed = 0;
  /// Pairs that no lanes were tried on: of a kind without them, or of tier `reference`.
  std::uint64_t without_lanes = 0;
  /// Pairs whose sign double could not tell: decided in exact arithmetic.
  std::uint64_t exact = 0;
  /// Iterations of the solver that met their bound and fell back to enumeration.
  std::uint64_t bounded = 0;

  /// Adds those of another call.
  NarrowStatistics& operator+=(const NarrowStatistics& other) noexcept {
    pairs += other.pairs;
    recomputed += other.recomputed;
    without_lanes += other.without_lanes;
    exact += other.exact;
    bounded += other.bounded;
    return *this;
  }
};

/// Pairs of bodies to overlaps, distances or contacts. Sorts pairs by the kinds of their shapes and
/// computes those of one kind many at a time. Keeps scratch memory from call to call: one object
/// per thread of the caller. What was moved from is as if new.
class WINNOW_API NarrowPhase {
 public:
  /// Every allocation comes from `memory`, which must outlive the object; none before the first
  /// call.
  explicit NarrowPhase(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  ~NarrowPhase();
  /// `other` is as if new.
  NarrowPhase(NarrowPhase&& other) noexcept;
  NarrowPhase(const NarrowPhase&) = delete;
  NarrowPhase& operator=(const NarrowPhase&) = delete;
  NarrowPhase& operator=(NarrowPhase&&) = delete;

  /// Answers all pairs. `invalid_argument` for level `pairs`, a bad margin or a body that does not
  /// exist, `size_mismatch` for spans of different lengths (`margins` may be empty), `invalid_key`
  /// for an id that the pool does not know, `invalid_pose` if a body of a pair has one (an
  /// orientation counts where its shape is not a sphere), `out_of_memory`: then `result` is empty
  /// and `bad_body` tells.
  Status collide(const ShapePool& shapes, const Bodies& bodies, std::span<const BodyPair> pairs,
                 const NarrowOptions& options, NarrowResult& result);
  /// The same with shapes that lie elsewhere than in a pool.
  Status collide(const ShapeTables& tables, const Bodies& bodies, std::span<const BodyPair> pairs,
                 const NarrowOptions& options, NarrowResult& result);

  /// Of the last call.
  [[nodiscard]] const NarrowStatistics& statistics() const noexcept { return statistics_; }
  /// Index of the body that made the last call be refused; ~0U if it was for another reason or went
  /// well.
  [[nodiscard]] std::uint32_t bad_body() const noexcept { return bad_body_; }

  /// Scratch kept from call to call, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  struct State;

  std::pmr::memory_resource* memory_;
  State* state_ = nullptr;
  NarrowStatistics statistics_;
  std::uint32_t bad_body_ = 0;
};

/// What NarrowPhase answers about one pair, shape a at pose_a and b at pose_b, for who has no more
/// than one: keeps nothing and allocates nothing, so any number of threads may ask. Of many pairs
/// each takes several times as long as in a call of NarrowPhase. Of `answer` level `boolean` tells
/// `overlap` alone, `distance` all but contacts, `manifold` all but the point. Errors as of
/// NarrowPhase::collide; then `answer` is as it was.
/// @{
WINNOW_API Status collide(const ShapePool& shapes, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b, const NarrowOptions& options,
                          PairAnswer& answer) noexcept;
WINNOW_API Status collide(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                          const Pose& pose_b, const NarrowOptions& options,
                          PairAnswer& answer) noexcept;
/// @}

}  // namespace winnow
