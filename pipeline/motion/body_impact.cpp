// Impact search for bodies with composite shapes. A composite shape is traversed in its own frame,
// in which it is at rest and the other shape moves. RelativeMotionBounds computes a moving box that
// contains the other shape for an interval; the traversal visits parts roughly in the order in
// which the box touches them. After an impact is found, it skips parts that the box touches later.
// If the box touches more than kFewParts parts and is loose (see kLoose), the interval is halved,
// and the earlier half is searched first. The contacts at the start are computed only after an
// impact was found.

#include "pipeline/motion/body_impact.h"

#include "pipeline/motion/part_pair.h"
#include "pipeline/motion/relative_motion_bounds.h"

#include <algorithm>

namespace winnow::impact {
namespace {

constexpr int kMaxHalvings = 12;
/// An interval is halved if its moving box touches more parts than this and is loose (see kLoose).
constexpr int kFewParts = 8;
/// A moving box is loose if its growth for curved paths (RelativeMotionBounds::bend) exceeds this
/// fraction of the radius of the moving shape. If both shapes are composite, the length of the path
/// of the box is added to the growth.
constexpr double kLoose = 0.04;

void grow(double by, MovingBox& box) noexcept {
  for (int i = 0; i < 3; ++i) {
    box.min[i] -= by;
    box.max[i] += by;
  }
}

/// Returns whether two moving parts share a point at time 0.
[[nodiscard]] bool share_a_point(const ShapeTables& tables, const MovingPart& a,
                                 const MovingPart& b) noexcept {
  const Impact impact = find_impact(tables, a, b, 1e-9, {0.0, 0.0});
  return touches_at_start(impact);
}

class BodyImpactSearch {
 public:
  BodyImpactSearch(const SubShapeQuery& parts, const MovingShape& a, const MovingShape& b,
                   const ImpactRequest& request) noexcept
      : parts_(parts),
        a_(a),
        b_(b),
        request_(request),
        resting_(request.tolerance, 0.0, request.touch) {}

  [[nodiscard]] BodyImpact run();

 private:
  void search_parts(const MovingShape& a, const MovingShape& b, const Interval& within);
  void walk(const MovingShape& walked, const MovingShape& other, bool mirrored,
            const RelativeMotionBounds& passage, const Interval& given, int halvings);
  [[nodiscard]] bool overlaps_many(const MovingShape& walked, const MovingBox& way) const;
  void test(const MovingShape& a, const MovingShape& b, const Interval& within);
  [[nodiscard]] bool is_left_out(const ShapeTables& tables, const MovingPart& a,
                                 const MovingPart& b, const BodyImpact& found, double from);
  void record_contacts();

  const SubShapeQuery& parts_;
  const MovingShape& a_;
  const MovingShape& b_;
  const ImpactRequest& request_;
  BodyImpact found_;
  RestingContacts resting_;
  bool has_recorded_ = false;
  /// If true, `test` records the contacts of parts at the start instead of searching for impacts.
  bool records_ = false;
};

void BodyImpactSearch::test(const MovingShape& a, const MovingShape& b, const Interval& within) {
  PartPair pair(parts_.shapes());
  const MovingPart moving_a = pair.put(0, a);
  const MovingPart moving_b = pair.put(1, b);
  if (records_) {
    resting_.record(pair.tables(), moving_a, moving_b);
    return;
  }
  // A recorded contact plane is cheaper to test than an impact search.
  if (resting_.part(pair.tables(), moving_a, moving_b)) return;
  const BodyImpact found{find_impact(pair.tables(), moving_a, moving_b, request_.tolerance, within),
                         a.shape.part, b.shape.part};
  const std::uint32_t samples = found_.impact.samples + found.impact.samples;
  if (comes_before(found, found_) &&
      !is_left_out(pair.tables(), moving_a, moving_b, found, within.first)) {
    found_ = found;
  }
  found_.impact.samples = samples;
}

/// Returns whether an impact, from a search that began at `from`, is dropped because of a contact
/// at the start. Always false for StartTouch::impact.
bool BodyImpactSearch::is_left_out(const ShapeTables& tables, const MovingPart& a,
                                   const MovingPart& b, const BodyImpact& found, double from) {
  if (request_.touch == StartTouch::impact) return false;
  if (request_.touch == StartTouch::ignored) {
    if (touches_at_start(found.impact)) return true;
    if (from > 0.0 && share_a_point(tables, a, b)) return true;
  }
  // If contacts were recorded, `test` skipped parts that separate along them.
  if (has_recorded_) return false;
  record_contacts();
  return resting_.part(tables, a, b);
}

void BodyImpactSearch::record_contacts() {
  has_recorded_ = records_ = true;
  search_parts(a_, b_, {0.0, 0.0});
  records_ = false;
}

/// With StartTouch::impact, an impact at the start is final. A later impact may be of parts that
/// slide along a contact at the start: then the contacts are recorded, and the search is repeated.
BodyImpact BodyImpactSearch::run() {
  search_parts(a_, b_, request_.within);
  const bool may_slide =
      request_.touch == StartTouch::impact && found_.impact.hit && !touches_at_start(found_.impact);
  if (!may_slide) return found_;
  record_contacts();
  if (resting_.is_empty()) return found_;
  const std::uint32_t samples = found_.impact.samples;
  found_ = {};
  found_.impact.samples = samples;
  search_parts(a_, b_, request_.within);
  return found_;
}

/// Traverses a composite shape against the moving box of the other shape. If both are composite,
/// the shape with the larger radius is traversed first, and the other shape against the moving box
/// of each part found.
void BodyImpactSearch::search_parts(const MovingShape& a, const MovingShape& b,
                                    const Interval& within) {
  const bool of_a = a.shape.shape.is_composite();
  const bool of_b = b.shape.shape.is_composite();
  if (!of_a && !of_b) {
    test(a, b, within);
    return;
  }
  const bool mirrored = !of_a || (of_b && b.radius > a.radius);
  const MovingShape& walked = mirrored ? b : a;
  const MovingShape& other = mirrored ? a : b;
  walk(walked, other, mirrored, RelativeMotionBounds(parts_, walked.motion, other), within, 0);
}

bool BodyImpactSearch::overlaps_many(const MovingShape& walked, const MovingBox& way) const {
  int count = 0;
  parts_.visit_parts(
      PlacedShape{walked.shape.shape, Pose{}}, way,
      [&](const SubShape&, double limit) { return ++count > kFewParts ? -1.0 : limit; });
  return count > kFewParts;
}

void BodyImpactSearch::walk(const MovingShape& walked, const MovingShape& other, bool mirrored,
                            const RelativeMotionBounds& passage, const Interval& given,
                            int halvings) {
  const Interval within = records_ ? given : before(given, found_);
  if (within.first > within.last) return;
  MovingBox way = passage.moving_box(within);
  if (records_) grow(request_.tolerance * other.own_radius, way);
  // If both shapes are composite, a long path also makes many pairs of parts overlap.
  const double length = other.shape.shape.is_composite() ? as_eigen(way.direction).norm() : 0.0;
  if (halvings < kMaxHalvings && passage.bend(within) + length > kLoose * other.own_radius &&
      overlaps_many(walked, way)) {
    const double middle = 0.5 * (within.first + within.last);
    walk(walked, other, mirrored, passage, {within.first, middle}, halvings + 1);
    walk(walked, other, mirrored, passage, {middle, within.last}, halvings + 1);
    return;
  }
  const double width = within.last - within.first;
  parts_.visit_parts(
      PlacedShape{walked.shape.shape, Pose{}}, way, [&](const SubShape& part, double limit) {
        const MovingShape own = moving_part(parts_, part, walked.motion);
        const Interval left_of = records_ ? within : before(within, found_);
        search_parts(mirrored ? other : own, mirrored ? own : other, left_of);
        if (records_) return limit;
        const double left = before(within, found_).last - within.first;
        return left < width ? std::min(limit, left / width * (1.0 + 4.0 * solver::kEpsilon))
                            : limit;
      });
}

}  // namespace

BodyImpact find_body_impact(const SubShapeQuery& parts, const MovingBody& a, const MovingBody& b,
                            const ImpactRequest& request) {
  const MovingShape shape = whole_shape(parts, b.shape, b.motion);
  const Interval window =
      RelativeMotionBounds(parts, a.motion, shape).window(parts.radius(a.shape));
  ImpactRequest inside = request;
  inside.within = {std::max(window.first, request.within.first),
                   std::min(window.last, request.within.last)};
  if (inside.within.first > std::min(inside.within.last, request.until)) return {};
  return find_impact_of_balls(parts, a, b, inside);
}

BodyImpact find_impact_of_balls(const SubShapeQuery& parts, const MovingBody& a,
                                const MovingBody& b, const ImpactRequest& request) {
  const MovingShape first = whole_shape(parts, a.shape, a.motion);
  const MovingShape second = whole_shape(parts, b.shape, b.motion);
  if (request.touch != StartTouch::impact || a.shape.is_composite() || b.shape.is_composite()) {
    return BodyImpactSearch(parts, first, second, request).run();
  }
  return {find_impact(parts.shapes().tables(), {a.shape, a.motion}, {b.shape, b.motion},
                      request.tolerance, request.within, request.until)};
}

}  // namespace winnow::impact
