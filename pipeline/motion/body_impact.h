#pragma once

#include "pipeline/composites/parts.h"
#include "pipeline/motion/impact_search.h"
#include "pipeline/motion/resting_contacts.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace winnow::impact {

/// A body that moves, its shape convex or composite.
struct MovingBody {
  ShapeId shape;
  const RigidMotion& motion;
};

/// When two bodies meet, and with which of their parts.
struct BodyImpact {
  Impact impact;
  std::uint32_t part_a = kWholeShape;
  std::uint32_t part_b = kWholeShape;
};

/// True if the first is an impact, and the second none or one that is later; where times are the
/// same the nearer one is first, and then that of smaller parts.
[[nodiscard]] inline bool comes_before(const BodyImpact& first, const BodyImpact& second) noexcept {
  const auto order = [](const BodyImpact& found) {
    return std::tuple(found.impact.time, found.impact.gap, found.part_a, found.part_b);
  };
  return first.impact.hit && (!second.impact.hit || order(first) < order(second));
}

/// What of an interval is left before an impact.
[[nodiscard]] inline Interval before(const Interval& within, const BodyImpact& found) noexcept {
  return {within.first, found.impact.hit ? std::min(within.last, found.impact.time) : within.last};
}

/// What is looked for.
struct ImpactRequest {
  /// A share of the size of the smaller of the parts that meet.
  double tolerance;
  /// The bodies are apart before, but for touching at the start.
  Interval within{0.0, 1.0};
  /// An impact after it may be given as none; one that is not later is the same whatever it is.
  double until = 1.0;
  StartTouch touch = StartTouch::meets;
};

/// The first impact within an interval of shapes that are there and motions that are valid; of
/// bodies that share a point at the start, and meet then, that of the parts that overlap the
/// deepest. Parts of a composite shape that slide or part along a contact of the bodies at the
/// start do not meet: see RestingContacts.
[[nodiscard]] BodyImpact find_body_impact(const PartTraversal& parts, const MovingBody& a,
                                          const MovingBody& b, const ImpactRequest& request);
/// The same of an interval in which the balls around the two overlap.
[[nodiscard]] BodyImpact find_impact_of_balls(const PartTraversal& parts, const MovingBody& a,
                                              const MovingBody& b, const ImpactRequest& request);

}  // namespace winnow::impact
