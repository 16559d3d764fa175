#pragma once

#include "pipeline/composites/parts.h"
#include "pipeline/motion/impact_search.h"
#include "pipeline/motion/resting_contacts.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace winnow::impact {

/// A body that moves; its shape is convex or composite.
struct MovingBody {
  ShapeId shape;
  const RigidMotion& motion;
};

/// The first impact of two bodies, and the parts that touch.
struct BodyImpact {
  Impact impact;
  std::uint32_t part_a = kWholeShape;
  std::uint32_t part_b = kWholeShape;
};

/// Returns whether `first` is a hit that comes before `second`: `second` is no hit or is later. At
/// equal times, the smaller gap comes first, then the smaller part numbers.
[[nodiscard]] inline bool comes_before(const BodyImpact& first, const BodyImpact& second) noexcept {
  const auto order = [](const BodyImpact& found) {
    return std::tuple(found.impact.time, found.impact.gap, found.part_a, found.part_b);
  };
  return first.impact.hit && (!second.impact.hit || order(first) < order(second));
}

/// Returns the part of an interval up to an impact; the whole interval if `found` is no hit.
[[nodiscard]] inline Interval before(const Interval& within, const BodyImpact& found) noexcept {
  return {within.first, found.impact.hit ? std::min(within.last, found.impact.time) : within.last};
}

/// Parameters of a search for an impact.
struct ImpactRequest {
  /// Relative to the size of the smaller of the two parts that touch.
  double tolerance;
  /// The interval to search. Before it the bodies must be disjoint, except for contact at time 0.
  Interval within{0.0, 1.0};
  /// An impact later than this may be reported as none; other results do not depend on it.
  double until = 1.0;
  StartTouch touch = StartTouch::impact;
};

/// Finds the first impact within an interval. Shapes must exist and motions must be valid. If
/// bodies overlap at the start and StartTouch makes this an impact, the parts that overlap most
/// deeply are reported. Unless both shapes are convex and `touch` is StartTouch::impact, no impact
/// is reported for parts that slide or separate along a contact of the bodies at the start: see
/// RestingContacts.
[[nodiscard]] BodyImpact find_body_impact(const SubShapeQuery& parts, const MovingBody& a,
                                          const MovingBody& b, const ImpactRequest& request);
/// As above, for callers that have limited the interval to the times at which the bounding balls of
/// the two bodies overlap.
[[nodiscard]] BodyImpact find_impact_of_balls(const SubShapeQuery& parts, const MovingBody& a,
                                              const MovingBody& b, const ImpactRequest& request);

}  // namespace winnow::impact
