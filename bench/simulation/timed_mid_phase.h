#pragma once

#include <winnow/pipeline/mid_phase.h>
#include "bench/common/sample.h"

namespace winnow::bench {

/// Forwards all calls to another mid phase and measures the time of the contact calls.
class TimedMidPhase final : public MidPhase {
 public:
  explicit TimedMidPhase(const MidPhase& inner) noexcept : inner_(inner) {}

  /// Returns the milliseconds since the last call of this function.
  double take_ms() noexcept {
    const double ms = ms_;
    ms_ = 0.0;
    return ms;
  }

  [[nodiscard]] bool contains(ShapeId id) const noexcept override { return inner_.contains(id); }
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept override {
    return inner_.bounds(id, pose);
  }
  [[nodiscard]] double radius(ShapeId id) const noexcept override { return inner_.radius(id); }
  [[nodiscard]] std::uint64_t revision() const noexcept override { return inner_.revision(); }
  Status find_primitive_pairs(const ShapePool& shapes, const Bodies& bodies,
                              std::span<const BodyPair> pairs, const PairMargins& margins,
                              const Execution& execution, PrimitivePairs& out) const override {
    const Stopwatch clock;
    const Status status =
        inner_.find_primitive_pairs(shapes, bodies, pairs, margins, execution, out);
    ms_ += clock.ms();
    return status;
  }
  void correct_internal_edges(const ShapePool& shapes, const PrimitivePairs& pairs,
                              const PairMargins& margins, const Execution& execution,
                              NarrowResult& result) const override {
    const Stopwatch clock;
    inner_.correct_internal_edges(shapes, pairs, margins, execution, result);
    ms_ += clock.ms();
  }
  Status reduce_contacts(const ShapePool& shapes, const PrimitivePairs& pairs,
                         const NarrowResult& answers, const PairMargins& margins,
                         const Execution& execution, ContactRegions& out) const override {
    const Stopwatch clock;
    const Status status = inner_.reduce_contacts(shapes, pairs, answers, margins, execution, out);
    ms_ += clock.ms();
    return status;
  }
  void visit(ShapeId id, const Pose& pose, const MovingBox& moving_box,
             const PrimitiveVisitor& visitor) const override {
    inner_.visit(id, pose, moving_box, visitor);
  }
  void visit_rays(ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                  const double* limits, const RayVisitor& visitor) const override {
    inner_.visit_rays(id, pose, rays, limits, visitor);
  }
  void visit_near(ShapeId id, const Pose& pose, const MovingBox& from, double limit,
                  const PrimitiveVisitor& visitor) const override {
    inner_.visit_near(id, pose, from, limit, visitor);
  }
  bool visit_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                   const PrimitivePairVisitor& visitor) const override {
    return inner_.visit_pairs(a, pose_a, b, pose_b, visitor);
  }
  bool visit_near_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b, double limit,
                        const NearPairVisitor& visitor) const override {
    return inner_.visit_near_pairs(a, pose_a, b, pose_b, limit, visitor);
  }
  [[nodiscard]] Footprint footprint() const noexcept override { return inner_.footprint(); }

 private:
  const MidPhase& inner_;
  mutable double ms_ = 0.0;
};

}  // namespace winnow::bench
