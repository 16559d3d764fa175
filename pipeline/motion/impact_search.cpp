// Scalar search for the first impact of two moving convex shapes: conservative advancement (Mirtich
// 1996) with a bound of second order. impact_batch.cpp calls it for pairs that the lanes cannot
// decide, body_impact.cpp for parts of composite shapes, face_impact.cpp for faces of deformable
// meshes.
//
// The distance of two shapes is at least their gap along any direction n. The gap is the minimum,
// over pairs of points, of a linear function of time (travel) plus cosines (rotation). Its second
// derivative nowhere exceeds M, the sum over both shapes of angle^2 times the largest distance of a
// point from the rotation axis times the sine of the angle between n and that axis. So at a time t
// between two times u and v, the gap is below its chord by at most M / 2 * (t - u) * (v - t). This
// lower bound is positive up to the root of a quadratic, which proves that the shapes are disjoint
// until then. If n is the direction between the closest points at a time, the gap at this time has
// the value and the slope of the distance. Samples at the times at which Newton's method would
// close the gap therefore converge as fast as Newton's method.

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
using solver::GjkSimplex;
using solver::kEpsilon;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kMaxSamples = 200'000;
/// A pair within the tolerance for more samples than this counts as an impact.
constexpr std::uint32_t kMaxSamplesWithin = 64;
/// Relative accuracy of distances. The closest points of two polytopes at an impact are computed to
/// rounding.
constexpr double kGoodEnough = 1e-3;

/// The shapes must exist and the poses be valid.
[[nodiscard]] PairAnswer distance_of(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                     ShapeId b, const Pose& pose_b) noexcept {
  PairAnswer answer;
  const NarrowOptions options{.level = ContactLevel::distance};
  static_cast<void>(collide(tables, a, pose_a, b, pose_b, options, answer));
  return answer;
}

/// A sample of the pair: bounds at one time.
struct PairSample {
  /// The shapes are certainly separated by `gap` > 0: along `axis`, or along an unknown axis if
  /// `axis` is zero.
  bool parted = false;
  Vec axis = Vec::Zero();
  double gap = 0.0;
  /// Upper bound on the distance.
  double most = 0.0;
  /// Estimated derivative of the gap.
  double slope = 0.0;
  /// The closest point found on the core of a, and the vector from it to the closest point of b's
  /// core.
  Vec on_a = Vec::Zero();
  Vec between = Vec::Zero();
};

/// The simplex of a sample, in the frames of the cores; it warm-starts GJK at the next sample.
class Witness {
 public:
  [[nodiscard]] bool is_there() const noexcept { return count_ > 0 && age_ < kOldest; }
  void take(const solver::Core& a, const solver::Core& b, const GjkSimplex& simplex) noexcept {
    age_ = is_there() ? age_ + 1 : 0;
    count_ = simplex.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      of_a_[i] = a.rotation.transpose() * (simplex.point[i].a - a.center);
      of_b_[i] = b.rotation.transpose() * (simplex.point[i].b - b.center);
    }
  }
  [[nodiscard]] GjkSimplex placed(const solver::Core& a, const solver::Core& b) const noexcept {
    GjkSimplex simplex;
    simplex.count = count_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      simplex.point[i].a = a.center + a.rotation * of_a_[i];
      simplex.point[i].b = b.center + b.rotation * of_b_[i];
      simplex.point[i].w = simplex.point[i].b - simplex.point[i].a;
    }
    return simplex;
  }

 private:
  /// The number of samples after which the simplex is discarded: each transformation to the frames
  /// of the cores and back adds rounding errors.
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
  /// Number of distance computations.
  [[nodiscard]] std::uint32_t samples() const noexcept { return samples_; }

 private:
  [[nodiscard]] static Impact impact_from(double time, const PairAnswer& answer,
                                          const Vec3d& from) noexcept;
  [[nodiscard]] Impact impact_at(double time, PairSample& sample) noexcept;
  [[nodiscard]] Impact impact_of_sample(double time, PairSample& sample) noexcept;
  [[nodiscard]] Impact start() const noexcept;
  [[nodiscard]] PairAnswer answer_at(double time, Pose& pose_a) const noexcept;
  [[nodiscard]] PairSample sample(double time) noexcept;
  void sample_half_space(PairSample& result) const noexcept;
  [[nodiscard]] GjkResult closest_points(double share) const noexcept;
  void sample_cores(double share, PairSample& result) noexcept;
  void sample_accurately(double time, PairSample& result) const noexcept;
  [[nodiscard]] double free_until(double time, double end, const PairSample& sample) const noexcept;
  [[nodiscard]] double next(double from, double end, const PairSample& sample) const noexcept;
  [[nodiscard]] double proved(double from, const PairSample& first, double to,
                              const PairSample& second) const noexcept;
  [[nodiscard]] bool is_impact(double time, double end, const PairSample& sample) noexcept;
  [[nodiscard]] double advance(double time, double end, PairSample& sample, bool& known) noexcept;

  const ShapeTables& tables_;
  const MovingPart& a_;
  const MovingPart& b_;
  MovingPair pair_;
  double tolerance_;
  Interval span_;
  double until_;
  Witness witness_;
  /// The pair seems to touch before this time; sampling later is useless.
  double touching_ = kUnbounded;
  /// The fraction of the gap that should remain at the next sample.
  double aim_ = 0.1;
  /// Number of samples within the tolerance at which no touch before the end was predicted.
  std::uint32_t within_ = 0;
  std::uint32_t samples_ = 0;
};

void ImpactSearch::sample_half_space(PairSample& result) const noexcept {
  const solver::Core& a = pair_.a();
  const solver::Core& b = pair_.b();
  result.axis = -b.normal;
  result.gap = pair_.gap(result.axis);
  result.most = result.gap + 2.0 * pair_.noise();
  const Vec y =
      a.kind == ShapeKind::half_space ? Vec(a.normal * a.offset) : support(a, result.axis);
  result.on_a = y;
  result.between = result.axis * (result.gap + pair_.noise() + pair_.roundings());
  result.slope = pair_.parting(result.axis, y, y + result.between - b.center);
}

/// GJK, started from the simplex of the last sample if there is one.
GjkResult ImpactSearch::closest_points(double share) const noexcept {
  const solver::GjkLimits limits{.noise = solver::kConvergence * pair_.problem().noise(),
                                 .share = share,
                                 .roundings = pair_.roundings()};
  const solver::Core& b = pair_.b();
  if (witness_.is_there()) return gjk(pair_.a(), b, witness_.placed(pair_.a(), b), limits);
  const Vec start = b.center.isZero(0.0) ? Vec::UnitX() : b.center;
  return gjk(pair_.a(), b, start, limits);
}

/// Samples by GJK, which ends once the gap has the relative accuracy `share`.
void ImpactSearch::sample_cores(double share, PairSample& result) noexcept {
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

/// Returns the narrow phase's distance of the shapes at a time, and writes the pose of a at this
/// time. Triangles that deform are moved in a copy of the table.
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
      as_eigen(bent[part->shape.index()].vertex[i]) += time * part->drift[i];
    }
  }
  ShapeTables tables = tables_;
  tables.triangles = bent;
  return distance_of(tables, a_.shape, pose_a, b_.shape, pose_b);
}

/// Computes a sample by the narrow phase. `sample` calls this if the bounds by GJK are too wide to
/// show whether the shapes are apart.
void ImpactSearch::sample_accurately(double time, PairSample& result) const noexcept {
  Pose pose_a;
  const PairAnswer found = answer_at(time, pose_a);
  const solver::Scale scaled(pair_.problem().exponent);
  const double distance = scaled(found.distance);
  const double error = scaled(found.error_bound) + pair_.noise();
  const Vec axis = as_eigen(found.normal);
  result.most = distance + error;
  result.axis = axis;
  result.gap = pair_.gap(axis);
  if (!(result.gap > 0.0) && distance - error > 0.0) {
    result.axis.setZero();
    result.gap = distance - error;
  }
  result.on_a = as_eigen(found.point).unaryExpr(scaled) - axis * pair_.a().rounding;
  result.between = axis * (distance + pair_.roundings());
  result.slope = pair_.parting(axis, result.on_a, result.on_a + result.between - pair_.b().center);
}

PairSample ImpactSearch::sample(double time) noexcept {
  ++samples_;
  pair_.place(time);
  PairSample result;
  if (pair_.has_half_space()) {
    sample_half_space(result);
  } else {
    sample_cores(kGoodEnough, result);
    const bool vague = !(result.gap > 0.0) && result.most > 4.0 * pair_.noise();
    if (vague) sample_accurately(time, result);
  }
  result.parted = result.gap > 0.0;
  return result;
}

/// Returns the fraction of an interval, from its start, in which a gap certainly stays above a
/// target. The gap exceeds the target by `above` at the start and by `then` at the end; at fraction
/// s it is at most 4 `sag` s (1 - s) below its chord.
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

/// Returns the time of the sample after `from`: the time at which the gap is expected to have
/// fallen to a fraction of its value, but at most the last time up to which a proof of separation
/// is expected to succeed.
double ImpactSearch::next(double from, double end, const PairSample& sample) const noexcept {
  double step = end - from;
  if (sample.slope < 0.0) {
    const double aim = std::max(0.5 * tolerance_, aim_ * sample.gap);
    step = std::min(step, std::max(sample.gap - aim, 0.25 * sample.gap) / -sample.slope);
  }
  const double curvature = pair_.curvature(sample.axis);
  if (curvature > 0.0) {
    // If the slope is constant, a proof succeeds if half of the curvature times the square of the
    // step is less than the square of the sum of the roots of the gaps at both ends.
    const double flat = std::sqrt(2.0 * sample.gap / curvature);
    const double left = 1.0 + sample.slope * flat / sample.gap;
    step = std::min(step, 0.95 * flat * (1.0 + std::sqrt(std::clamp(left, 0.0, 1.0))));
  }
  return std::min(from + step, end);
}

/// Returns the time, between `from` and `to`, until which the pair is certainly disjoint. The proof
/// uses the axis of `first` or, if `second` is separated too, an axis that rotates from the axis of
/// `first` to the axis of `second`. The pair must be placed at `to`.
double ImpactSearch::proved(double from, const PairSample& first, double to,
                            const PairSample& second) const noexcept {
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

/// Returns the time until which the volumes that the shapes sweep by their rotation are disjoint
/// along the axis of the sample. If the sample has no axis, the time follows from a bound on the
/// speed.
double ImpactSearch::free_until(double time, double end, const PairSample& sample) const noexcept {
  if (sample.axis.isZero(0.0)) {
    return std::min(end, time + 0.5 * sample.gap / pair_.most_closing());
  }
  const double swept = pair_.swept_gap(sample.axis) - std::min(0.25 * tolerance_, 0.5 * sample.gap);
  if (!(swept > 0.0)) return time;
  const double closing = pair_.swept_closing(sample.axis);
  return closing > 0.0 ? std::min(end, time + swept / closing * (1.0 - 8.0 * kEpsilon)) : end;
}

/// Converts an answer at a time. `from` is the vector from the position of body a to the position
/// of shape a, which the points of the answer are relative to.
Impact ImpactSearch::impact_from(double time, const PairAnswer& answer,
                                 const Vec3d& from) noexcept {
  Impact impact;
  impact.hit = true;
  impact.time = time;
  impact.gap = answer.distance;
  impact.error_bound = answer.error_bound;
  impact.normal = answer.normal;
  for (int i = 0; i < 3; ++i) {
    impact.point[i] = answer.point[i] + from[i];
  }
  return impact;
}

/// Returns the impact at a time at which the pair is placed. The pair is disjoint before; at this
/// time it is within the tolerance, or too close for double precision to decide, or the search
/// ended.
Impact ImpactSearch::impact_at(double time, PairSample& sample) noexcept {
  if (sample.parted) return impact_of_sample(time, sample);
  if (time == 0.0) return start();
  Pose pose_a;
  const PairAnswer answer = answer_at(time, pose_a);
  Impact impact = impact_from(time, answer, pose_a.position);
  impact.gap = std::max(impact.gap, 0.0);
  impact.error_bound += unscaled(pair_.problem(), pair_.noise());
  return impact;
}

/// Returns the impact of a sample that separates the shapes. If both are polytopes and the closest
/// points are not accurate yet, samples again.
Impact ImpactSearch::impact_of_sample(double time, PairSample& sample) noexcept {
  const bool polytopes = is_polytope(pair_.a()) && is_polytope(pair_.b());
  if (polytopes && sample.most - sample.gap > 4.0 * pair_.noise()) sample_cores(0.0, sample);
  const solver::Problem& problem = pair_.problem();
  const double gap = sample.between.norm() - pair_.roundings();
  const Vec normal = solver::unit(sample.between);
  const Vec point = sample.on_a + normal * pair_.a().rounding + pair_.arm();
  Impact impact;
  impact.hit = true;
  impact.time = time;
  impact.gap = unscaled(problem, std::max(gap, 0.0));
  impact.error_bound = unscaled(problem, std::max(sample.most - gap, gap - sample.gap));
  as_eigen(impact.normal) = normal;
  for (int i = 0; i < 3; ++i) impact.point[i] = unscaled(problem, point[i]);
  return impact;
}

/// Returns the impact at time 0, at which the poses are exact and the shapes may overlap.
Impact ImpactSearch::start() const noexcept {
  constexpr double kHere[3] = {0.0, 0.0, 0.0};
  const Pose& start_a = a_.motion.start;
  const Pose& start_b = b_.motion.start;
  if (a_.arm.isZero(0.0) && b_.arm.isZero(0.0)) {
    return impact_from(0.0, distance_of(tables_, a_.shape, start_a, b_.shape, start_b), kHere);
  }
  Pose pose_a;
  const PairAnswer answer = answer_at(0.0, pose_a);
  return impact_from(0.0, answer, pose_a.position);
}

/// Returns whether the pair is within the tolerance and is expected to touch before the end, or has
/// been within the tolerance for more than kMaxSamplesWithin samples without such an expectation.
bool ImpactSearch::is_impact(double time, double end, const PairSample& sample) noexcept {
  if (sample.most > std::max(tolerance_, 8.0 * pair_.noise())) return false;
  return sample.gap + sample.slope * (end - time) <= 0.0 || ++within_ > kMaxSamplesWithin;
}

/// One step from `time`, at which the pair is placed. Returns the time until which the pair is
/// certainly disjoint. If the pair was sampled at the returned time, writes the sample to `sample`,
/// and sets `known` if the sample separates the shapes.
double ImpactSearch::advance(double time, double end, PairSample& sample, bool& known) noexcept {
  known = false;
  const double free = free_until(time, end, sample);
  if (free >= end || sample.axis.isZero(0.0)) return free;
  const double to = next(time, std::min(end, touching_), sample);
  if (to <= free) return free;
  const PairSample there = this->sample(to);
  const double apart = proved(time, sample, to, there);
  if (!there.parted) touching_ = std::min(touching_, time + 0.75 * (to - time));
  if (apart < to) return std::max(apart, free);
  // The error of a linear prediction is proportional to the square of the step, and the step to the
  // gap at its start. So relative to the gap, the next error is expected to be this one times the
  // ratio of the gaps; `aim_` is four times as large.
  const double expected = sample.gap + sample.slope * (to - time);
  aim_ = std::clamp(4.0 * std::abs(there.gap - expected) / sample.gap * there.gap / sample.gap,
                    1e-9, 0.25);
  sample = there;
  known = there.parted;
  return to;
}

Impact ImpactSearch::run() noexcept {
  const Interval window = pair_.window();
  const double first = std::max(window.first, span_.first);
  const double last = std::min(window.last, span_.last);
  if (first > std::min(last, until_)) return {};
  if (pair_.a().kind == ShapeKind::half_space) {
    const Impact at_start = start();
    if (at_start.gap <= 0.0 || pair_.touches_soon()) return at_start;
  }
  double time = first;
  PairSample now;
  bool known = false;
  while (true) {
    if (!known) now = sample(time);
    if (!now.parted || is_impact(time, last, now)) return impact_at(time, now);
    const double free = advance(time, last, now, known);
    if (free >= last || free > until_) return {};
    // There is no double between `time` and `free`, or too many samples were taken.
    if (free <= time || samples_ >= kMaxSamples) {
      now = sample(time);
      return impact_at(time, now);
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
    found.samples = impacts.samples();
    return found;
  };
  if (!solver::is_prepared_mirrored(a.shape.kind(), b.shape.kind())) return search(a, b);
  Impact impact = search(b, a);
  if (impact.hit) mirror_impact(a.motion, b.motion, impact);
  return impact;
}

}  // namespace winnow::impact
