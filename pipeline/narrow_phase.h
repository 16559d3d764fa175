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
  NarrowPhase(const NarrowPhase&) = delete;
  NarrowPhase& operator=(const NarrowPhase&) = delete;
  NarrowPhase& operator=(NarrowPhase&&) = delete;

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
