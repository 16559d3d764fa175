// The distance of two moving shapes is at least their gap along any direction n. That gap is the
// least, over pairs of points, of a line (they travel) and cosines (they turn); its second
// derivative nowhere exceeds M, the sum of |angle|^2 times the shapes' reach from their axes, as
// far as it is seen along n. So between two times it lies above its chord less M / 2 times the
// times to both ends, which is positive up to the root of a quadratic: a proof that they are apart
// until there. With n the direction of the closest points the gap is the distance, and so is its
// slope: looks at the times where Newton's method would find the gap closed converge as that does.

#include "pipeline/motion/impact_search.h"

#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/motion/moving_pair.h"
#include "pipeline/shapes/pair_order.h"
#include "pipeline/solver/gjk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace winnow::impact {
namespace {

using solver::GjkResult;
using solver::kEpsilon;
using solver::Simplex;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kMostLooks = 200'000;
/// Shapes that stay so long within the tolerance as they near each other have met.
constexpr std::uint32_t kMostWithin = 64;
/// Distances need to be no better than this share of them until the last one.
constexpr double kGoodEnough = 1e-3;

/// Of shapes that are there, at valid poses.
[[nodiscard]] PairAnswer distance_of(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                     ShapeId b, const Pose& pose_b) noexcept {
  PairAnswer answer;
  const NarrowOptions options{.level = ContactLevel::distance};
  static_cast<void>(collide(tables, a, pose_a, b, pose_b, options, answer));
  return answer;
}

/// The pair at one time.
struct Look {
  /// Surely apart along `axis`, by `gap` > 0; or along some axis, if it is zero.
  bool parted = false;
  Vec axis = Vec::Zero();
  double gap = 0.0;
  /// They are no farther apart.
  double most = 0.0;
  /// About how fast the gap grows.
  double slope = 0.0;
  /// The closest point of the core of a that was found, and from it to that of b.
  Vec on_a = Vec::Zero();
  Vec between = Vec::Zero();
};

/// The simplex of a look, in the axes of the cores. Where they are next, it is made of points of
/// theirs as well.
class Witness {
 public:
  [[nodiscard]] bool is_there() const noexcept { return count_ > 0 && age_ < kOldest; }
  void take(const solver::Core& a, const solver::Core& b, const Simplex& simplex) noexcept {
    age_ = is_there() ? age_ + 1 : 0;
    count_ = simplex.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      of_a_[i] = a.rotation.transpose() * (simplex.point[i].a - a.center);
      of_b_[i] = b.rotation.transpose() * (simplex.point[i].b - b.center);
    }
  }
  [[nodiscard]] Simplex placed(const solver::Core& a, const solver::Core& b) const noexcept {
    Simplex simplex;
    simplex.count = count_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      simplex.point[i].a = a.center + a.rotation * of_a_[i];
      simplex.point[i].b = b.center + b.rotation * of_b_[i];
      simplex.point[i].w = simplex.point[i].b - simplex.point[i].a;
    }
    return simplex;
  }

 private:
  /// Each turn there and back rounds: after so many it is found anew.
  static constexpr int kOldest = 16;

  int count_ = 0;
  int age_ = 0;
  std::array<Vec, 4> of_a_;
  std::array<Vec, 4> of_b_;
};

class ImpactSearch {
 public:
  ImpactSearch(const ShapeTables& tables, const MovingPart& a, const MovingPart& b,
               double tolerance, const Interval& within, double until) noexcept
      : tables_(tables),
        a_(a),
        b_(b),
        pair_(tables, a, b),
        tolerance_(tolerance * pair_.size()),
        span_(within),
        until_(until) {}

  [[nodiscard]] Impact run() noexcept;
  /// How often distances were computed.
  [[nodiscard]] std::uint32_t looks() const noexcept { return looks_; }

 private:
  [[nodiscard]] static Impact met(double time, const PairAnswer& answer,
                                  const double (&from)[3]) noexcept;
  [[nodiscard]] Impact meet_at(double time, Look& look) noexcept;
  [[nodiscard]] Impact near_at(double time, Look& look) noexcept;
  [[nodiscard]] Impact start() const noexcept;
  [[nodiscard]] PairAnswer answer_at(double time, Pose& pose_a) const noexcept;
  [[nodiscard]] Look look(double time) noexcept;
  void look_at_half_space(Look& result) const noexcept;
  [[nodiscard]] GjkResult closest_points(double share) const noexcept;
  void look_at_cores(double share, Look& result) noexcept;
  void look_closer(double time, Look& result) const noexcept;
  [[nodiscard]] double free_until(double time, double end, const Look& look) const noexcept;
  [[nodiscard]] double next(double from, double end, const Look& look) const noexcept;
  [[nodiscard]] double proved(double from, const Look& first, double to,
                              const Look& second) const noexcept;
  [[nodiscard]] bool has_met(double time, double end, const Look& look) noexcept;
  [[nodiscard]] double advance(double time, double end, Look& look, bool& known) noexcept;

  const ShapeTables& tables_;
  const MovingPart& a_;
  const MovingPart& b_;
  MovingPair pair_;
  double tolerance_;
  Interval span_;
  double until_;
  Witness witness_;
  /// Nothing is gained by looking as late as this.
  double touching_ = kUnbounded;
  /// The share of a gap that is to be left of it where is looked next.
  double aim_ = 0.1;
  /// Looks within the tolerance so far.
  std::uint32_t within_ = 0;
  std::uint32_t looks_ = 0;
};

void ImpactSearch::look_at_half_space(Look& result) const noexcept {
  const solver::Core& a = pair_.a();
  const solver::Core& b = pair_.b();
  result.axis = -b.normal;
  result.gap = pair_.gap(result.axis);
  result.most = result.gap + 2.0 * pair_.noise();
  const Vec y =
      a.kind == solver::CoreKind::half_space ? Vec(a.normal * a.offset) : support(a, result.axis);
  result.on_a = y;
  result.between = result.axis * (result.gap + pair_.noise() + pair_.roundings());
  result.slope = pair_.parting(result.axis, y, y + result.between - b.center);
}

/// From what was closest when last looked at, which moves with the cores.
GjkResult ImpactSearch::closest_points(double share) const noexcept {
  const double noise = solver::kEnough * pair_.problem().noise();
  const solver::Core& b = pair_.b();
  if (witness_.is_there()) {
    return gjk(pair_.a(), b, witness_.placed(pair_.a(), b), noise, kUnbounded, share,
               pair_.roundings());
  }
  const Vec start = b.center.isZero(0.0) ? Vec::UnitX() : b.center;
  return gjk(pair_.a(), b, start, noise, kUnbounded, share, pair_.roundings());
}

/// By the iteration for closest points, which ends where the gap is known to a share of it.
void ImpactSearch::look_at_cores(double share, Look& result) noexcept {
  const solver::Core& b = pair_.b();
  const double noise = pair_.noise();
  const GjkResult found = closest_points(share);
  if (found.contact) return;
  if (!pair_.bends()) witness_.take(pair_.a(), b, found.simplex);
  result.axis = found.axis;
  result.gap = found.lower - pair_.roundings() - noise;
  result.most = found.upper - pair_.roundings() + noise;
  result.on_a = found.simplex.on_a();
  result.between = found.between;
  result.slope = pair_.parting(found.axis, result.on_a, found.simplex.on_b() - b.center);
}

/// What the solver says of the shapes at a time, and where it puts a. Triangles that bend are put
/// in a table of their own.
PairAnswer ImpactSearch::answer_at(double time, Pose& pose_a) const noexcept {
  Pose pose_b;
  pair_.poses(time, pose_a, pose_b);
  if (a_.drift == nullptr && b_.drift == nullptr) {
    return distance_of(tables_, a_.shape, pose_a, b_.shape, pose_b);
  }
  TriangleShape bent[2] = {tables_.triangles[0], tables_.triangles[1]};
  for (const MovingPart* const part : {&a_, &b_}) {
    if (part->drift == nullptr) continue;
    for (int i = 0; i < 3; ++i) {
      Vec::Map(bent[part->shape.index()].vertex[i]) += time * part->drift[i];
    }
  }
  ShapeTables tables = tables_;
  tables.triangles = bent;
  return distance_of(tables, a_.shape, pose_a, b_.shape, pose_b);
}

/// For cores whose closest points iteration does not find.
void ImpactSearch::look_closer(double time, Look& result) const noexcept {
  Pose pose_a;
  const PairAnswer found = answer_at(time, pose_a);
  const solver::Scale scaled(pair_.problem().exponent);
  const double distance = scaled(found.distance);
  const double doubt = scaled(found.error_bound) + pair_.noise();
  const Vec axis = Vec::Map(found.normal);
  result.most = distance + doubt;
  result.axis = axis;
  result.gap = pair_.gap(axis);
  if (!(result.gap > 0.0) && distance - doubt > 0.0) {
    result.axis.setZero();
    result.gap = distance - doubt;
  }
  result.on_a = Vec::Map(found.point).unaryExpr(scaled) - axis * pair_.a().rounding;
  result.between = axis * (distance + pair_.roundings());
  result.slope = pair_.parting(axis, result.on_a, result.on_a + result.between - pair_.b().center);
}

Look ImpactSearch::look(double time) noexcept {
  ++looks_;
  pair_.place(time);
  Look result;
  if (pair_.has_half_space()) {
    look_at_half_space(result);
  } else {
    look_at_cores(kGoodEnough, result);
    const bool vague = !(result.gap > 0.0) && result.most > 4.0 * pair_.noise();
    if (vague) look_closer(time, result);
  }
  result.parted = result.gap > 0.0;
  return result;
}

/// The share of an interval in which a gap that is `above` a target at its start, and `then` above
/// it at the end, surely stays above: it is above its chord less 4 `sag` times the shares to both
/// ends.
double share_above(double above, double then, double sag) noexcept {
  const double square = 4.0 * sag;
  if (!std::isfinite(square)) return 0.0;
  const double linear = then - above - square;
  const double discriminant = linear * linear - 4.0 * square * above;
  const bool stays =
      then >= 0.0 && (linear >= 0.0 || discriminant < 0.0 || -linear >= 2.0 * square);
  if (stays) return 1.0;
  const double root = 2.0 * above / (-linear + std::sqrt(std::max(discriminant, 0.0)));
  return std::min(root * (1.0 - 1e-12), 1.0);
}

/// Where to look after `from`: where the gap seems to fall to a share of what it is, but no farther
/// than a proof may reach.
double ImpactSearch::next(double from, double end, const Look& look) const noexcept {
  double step = end - from;
  if (look.slope < 0.0) {
    const double aim = std::max(0.5 * tolerance_, aim_ * look.gap);
    step = std::min(step, std::max(look.gap - aim, 0.25 * look.gap) / -look.slope);
  }
  const double curvature = pair_.curvature(look.axis);
  if (curvature > 0.0) {
    // A gap whose slope is constant has a proof if half of the curvature times the square of the
    // step is below the square of the sum of the roots of the gaps at both ends.
    const double flat = std::sqrt(2.0 * look.gap / curvature);
    const double left = 1.0 + look.slope * flat / look.gap;
    step = std::min(step, 0.95 * flat * (1.0 + std::sqrt(std::clamp(left, 0.0, 1.0))));
  }
  return std::min(from + step, end);
}

/// How far from one time to a later one, where the pair is placed, they are surely apart: along the
/// axis of the first look, or along one that turns from it to that of the second.
double ImpactSearch::proved(double from, const Look& first, double to,
                            const Look& second) const noexcept {
  const double width = (to - from) * (1.0 + 4.0 * kEpsilon);
  const double least = second.parted ? std::min(first.gap, second.gap) : first.gap;
  const double target = std::min(0.25 * tolerance_, 0.5 * least);
  const bool plane = pair_.has_half_space();
  const double sag = 0.125 * pair_.curvature(first.axis) * width * width;
  const double then = plane ? second.gap : pair_.gap(first.axis);
  double share = share_above(first.gap - target, then - target, sag);
  if (share < 1.0 && second.parted && !second.axis.isZero(0.0) && !plane) {
    const double curvature = pair_.curvature_between(first.axis, second.axis, width);
    const double turning_sag = 0.125 * curvature * width * width;
    share = std::max(share, share_above(first.gap - target, second.gap - target, turning_sag));
  }
  return share >= 1.0 ? to : std::min(from + share * (to - from), to);
}

/// They are apart until then by what they sweep, or by their speed alone.
double ImpactSearch::free_until(double time, double end, const Look& look) const noexcept {
  if (look.axis.isZero(0.0)) {
    return std::min(end, time + 0.5 * look.gap / pair_.most_closing());
  }
  const double swept = pair_.swept_gap(look.axis) - std::min(0.25 * tolerance_, 0.5 * look.gap);
  if (!(swept > 0.0)) return time;
  const double closing = pair_.swept_closing(look.axis);
  return closing > 0.0 ? std::min(end, time + swept / closing * (1.0 - 8.0 * kEpsilon)) : end;
}

/// As answered at a time, of a shape a that is at `from` from the position of its body.
Impact ImpactSearch::met(double time, const PairAnswer& answer, const double (&from)[3]) noexcept {
  Impact impact;
  impact.hit = true;
  impact.time = time;
  impact.gap = answer.distance;
  impact.error_bound = answer.error_bound;
  std::copy_n(answer.normal, 3, impact.normal);
  for (int i = 0; i < 3; ++i) {
    impact.point[i] = answer.point[i] + from[i];
  }
  return impact;
}

/// They are apart before and within the tolerance here, where the pair is placed, or too near for
/// double to tell.
Impact ImpactSearch::meet_at(double time, Look& look) noexcept {
  if (look.parted) return near_at(time, look);
  if (time == 0.0) return start();
  Pose pose_a;
  const PairAnswer answer = answer_at(time, pose_a);
  Impact impact = met(time, answer, pose_a.position);
  impact.gap = std::max(impact.gap, 0.0);
  impact.error_bound += unscaled(pair_.problem(), pair_.noise());
  return impact;
}

/// What a look says of shapes that it shows apart; a closer one where there are closest corners.
Impact ImpactSearch::near_at(double time, Look& look) noexcept {
  const bool polytopes = pair_.a().is_polytope() && pair_.b().is_polytope();
  if (polytopes && look.most - look.gap > 4.0 * pair_.noise()) look_at_cores(0.0, look);
  const solver::Problem& problem = pair_.problem();
  const double gap = look.between.norm() - pair_.roundings();
  const Vec normal = solver::unit(look.between);
  const Vec point = look.on_a + normal * pair_.a().rounding + pair_.arm();
  Impact impact;
  impact.hit = true;
  impact.time = time;
  impact.gap = unscaled(problem, std::max(gap, 0.0));
  impact.error_bound = unscaled(problem, std::max(look.most - gap, gap - look.gap));
  Vec::Map(impact.normal) = normal;
  for (int i = 0; i < 3; ++i) impact.point[i] = unscaled(problem, point[i]);
  return impact;
}

/// They may share a point at the start, which is known to the last bit of where they are.
Impact ImpactSearch::start() const noexcept {
  constexpr double kHere[3] = {0.0, 0.0, 0.0};
  const Pose& start_a = a_.motion.start;
  const Pose& start_b = b_.motion.start;
  if (a_.arm.isZero(0.0) && b_.arm.isZero(0.0)) {
    return met(0.0, distance_of(tables_, a_.shape, start_a, b_.shape, start_b), kHere);
  }
  Pose pose_a;
  const PairAnswer answer = answer_at(0.0, pose_a);
  return met(0.0, answer, pose_a.position);
}

/// True if they are within the tolerance and seem to meet before the end, or stay so for long.
bool ImpactSearch::has_met(double time, double end, const Look& look) noexcept {
  if (look.most > std::max(tolerance_, 8.0 * pair_.noise())) return false;
  return look.gap + look.slope * (end - time) <= 0.0 || ++within_ > kMostWithin;
}

/// One step on from `time`, where the pair is placed: the time until which they are surely apart.
/// `look` becomes that at this time, if there is one.
double ImpactSearch::advance(double time, double end, Look& look, bool& known) noexcept {
  known = false;
  const double free = free_until(time, end, look);
  if (free >= end || look.axis.isZero(0.0)) return free;
  const double to = next(time, std::min(end, touching_), look);
  if (to <= free) return free;
  const Look there = this->look(to);
  const double apart = proved(time, look, to, there);
  if (!there.parted) touching_ = std::min(touching_, time + 0.75 * (to - time));
  if (apart < to) return std::max(apart, free);
  // The error of a prediction falls with the square of the step, and so by the gap as a share of
  // it.
  const double expected = look.gap + look.slope * (to - time);
  aim_ = std::clamp(4.0 * std::abs(there.gap - expected) / look.gap * there.gap / look.gap, 1e-9,
                    0.25);
  look = there;
  known = there.parted;
  return to;
}

Impact ImpactSearch::run() noexcept {
  const Interval window = pair_.window();
  const double first = std::max(window.first, span_.first);
  const double last = std::min(window.last, span_.last);
  if (first > std::min(last, until_)) return {};
  if (pair_.a().kind == solver::CoreKind::half_space) {
    const Impact at_start = start();
    if (at_start.gap <= 0.0 || pair_.touches_soon()) return at_start;
  }
  double time = first;
  Look now;
  bool known = false;
  while (true) {
    if (!known) now = look(time);
    if (!now.parted || has_met(time, last, now)) return meet_at(time, now);
    const double free = advance(time, last, now, known);
    if (free >= last || free > until_) return {};
    // No number left between, or none that looks would ever reach.
    if (free <= time || looks_ >= kMostLooks) {
      now = look(time);
      return meet_at(time, now);
    }
    time = free;
    if (time >= touching_) touching_ = kUnbounded;
  }
}

}  // namespace

void mirror_impact(const RigidMotion& of_a, const RigidMotion& of_b, Impact& impact) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double apart = (of_b.start.position[i] - of_a.start.position[i]) +
                         impact.time * (of_b.travel[i] - of_a.travel[i]);
    impact.point[i] += impact.gap * impact.normal[i] + apart;
    impact.normal[i] = 0.0 - impact.normal[i];
  }
}

Impact find_impact(const ShapeTables& tables, const MovingPart& a, const MovingPart& b,
                   double tolerance, const Interval& within, double until) noexcept {
  const auto search = [&](const MovingPart& first, const MovingPart& second) {
    ImpactSearch impacts(tables, first, second, tolerance, within, until);
    Impact found = impacts.run();
    found.samples = impacts.looks();
    return found;
  };
  if (!solver::is_prepared_mirrored(a.shape.kind(), b.shape.kind())) return search(a, b);
  Impact impact = search(b, a);
  if (impact.hit) mirror_impact(a.motion, b.motion, impact);
  return impact;
}

}  // namespace winnow::impact
