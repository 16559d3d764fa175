// Composite shapes are traversed where they stand still: in their own frame, through which the
// other shape passes. A box around it that sweeps through the frame for a while contains it
// (Passage), and meets first what is met first, so that a time found bounds what is looked at
// after it. Where the way bends so much that the box meets many parts, the time is halved, the
// earlier half first.

#include "pipeline/motion/body_impact.h"

#include "pipeline/motion/part_pair.h"
#include "pipeline/motion/passage.h"

#include <algorithm>

namespace winnow::impact {
namespace {

/// No interval is shorter than this share of the motion for being bent.
constexpr int kMostHalvings = 12;
/// An interval is halved where the box meets more parts,
constexpr int kFewParts = 8;
/// and is grown, or goes on, by more than this share of the radius.
constexpr double kLoose = 0.04;

class BodyImpactSearch {
 public:
  BodyImpactSearch(const PartTraversal& parts, double tolerance) noexcept
      : parts_(parts), tolerance_(tolerance) {}

  [[nodiscard]] BodyImpact run(const MovingShape& a, const MovingShape& b, const Interval& within) {
    meet(a, b, within);
    return found_;
  }

 private:
  void meet(const MovingShape& a, const MovingShape& b, const Interval& within);
  void walk(const MovingShape& walked, const MovingShape& other, bool mirrored,
            const Passage& passage, const Interval& given, int halvings);
  [[nodiscard]] bool meets_many(const MovingShape& walked, const BoxSweep& way) const;
  void test(const MovingShape& a, const MovingShape& b, const Interval& within) noexcept;

  const PartTraversal& parts_;
  const double tolerance_;
  BodyImpact found_;
};

void BodyImpactSearch::test(const MovingShape& a, const MovingShape& b,
                            const Interval& within) noexcept {
  PartPair pair(parts_.shapes());
  const MovingPart moving_a = pair.put(0, a);
  const MovingPart moving_b = pair.put(1, b);
  const BodyImpact found{find_impact(pair.tables(), moving_a, moving_b, tolerance_, within),
                         a.shape.part, b.shape.part};
  const std::uint32_t samples = found_.impact.samples + found.impact.samples;
  if (comes_before(found, found_)) found_ = found;
  found_.impact.samples = samples;
}

/// Of two composite shapes the larger one is traversed first, by the way of the other, and that by
/// the ways of the parts that were found.
void BodyImpactSearch::meet(const MovingShape& a, const MovingShape& b, const Interval& within) {
  const bool of_a = a.shape.shape.is_composite();
  const bool of_b = b.shape.shape.is_composite();
  if (!of_a && !of_b) {
    test(a, b, within);
    return;
  }
  const bool mirrored = !of_a || (of_b && b.radius > a.radius);
  const MovingShape& walked = mirrored ? b : a;
  const MovingShape& other = mirrored ? a : b;
  walk(walked, other, mirrored, Passage(parts_, walked.motion, other), within, 0);
}

bool BodyImpactSearch::meets_many(const MovingShape& walked, const BoxSweep& way) const {
  int count = 0;
  parts_.met(PlacedShape{walked.shape.shape, Pose{}}, way,
             [&](const ConvexPart&, double limit) { return ++count > kFewParts ? -1.0 : limit; });
  return count > kFewParts;
}

void BodyImpactSearch::walk(const MovingShape& walked, const MovingShape& other, bool mirrored,
                            const Passage& passage, const Interval& given, int halvings) {
  const Interval within = before(given, found_);
  if (within.first > within.last) return;
  const BoxSweep way = passage.sweep(within);
  // Of two composite shapes a long way brings many parts near each other, too.
  const double length = other.shape.shape.is_composite() ? Vec::Map(way.direction).norm() : 0.0;
  if (halvings < kMostHalvings && passage.bend(within) + length > kLoose * other.own_radius &&
      meets_many(walked, way)) {
    const double middle = 0.5 * (within.first + within.last);
    walk(walked, other, mirrored, passage, {within.first, middle}, halvings + 1);
    walk(walked, other, mirrored, passage, {middle, within.last}, halvings + 1);
    return;
  }
  const double width = within.last - within.first;
  parts_.met(PlacedShape{walked.shape.shape, Pose{}}, way,
             [&](const ConvexPart& part, double limit) {
               const MovingShape own = moving_part(parts_, part, walked.motion);
               meet(mirrored ? other : own, mirrored ? own : other, before(within, found_));
               const double left = before(within, found_).last - within.first;
               return left < width ? std::min(limit, left / width * (1.0 + 4.0 * solver::kEpsilon))
                                   : limit;
             });
}

}  // namespace

BodyImpact find_body_impact(const PartTraversal& parts, const MovingBody& a, const MovingBody& b,
                            double tolerance, const Interval& within, double until) {
  const MovingShape shape = whole_shape(parts, b.shape, b.motion);
  const Interval window = Passage(parts, a.motion, shape).window(parts.radius(a.shape));
  const Interval both{std::max(window.first, within.first), std::min(window.last, within.last)};
  if (both.first > std::min(both.last, until)) return {};
  return find_impact_of_balls(parts, a, b, tolerance, both, until);
}

BodyImpact find_impact_of_balls(const PartTraversal& parts, const MovingBody& a,
                                const MovingBody& b, double tolerance, const Interval& within,
                                double until) {
  if (!a.shape.is_composite() && !b.shape.is_composite()) {
    return {find_impact(parts.shapes().tables(), {a.shape, a.motion}, {b.shape, b.motion},
                        tolerance, within, until)};
  }
  const MovingShape first = whole_shape(parts, a.shape, a.motion);
  const MovingShape second = whole_shape(parts, b.shape, b.motion);
  return BodyImpactSearch(parts, tolerance).run(first, second, within);
}

}  // namespace winnow::impact
