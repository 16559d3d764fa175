// Conservative advancement. The distance g(t) of two convex shapes, one of which moves along a
// line, is a convex function of t. If a plane separates them at time t with gap s, and they
// approach along its normal at speed v > 0, it separates them until t + s / v and at all times
// before: a certificate, however the plane was found. If v <= 0 it separates them from then on, and
// since t - s / |v|. So every sample at which they are apart, before or after the impact, bounds
// the impact from one side or excludes it. Samples are taken where Newton's method would take them
// (planes through closest points are tangents of g), plus a little, so that the last sample is in
// contact and closes the bracket. The casts in linear_casts.cpp and composite_cast.cpp call this.

#include "pipeline/composites/shape_cast.h"

#include <winnow/core/volumes.h>
#include "core/numbers/rounding.h"
#include "pipeline/composites/parts.h"
#include "pipeline/shapes/frame.h"
#include "pipeline/solver/core_distance.h"
#include "pipeline/solver/gjk.h"
#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

using mid::kInfinity;
using solver::CoreDistance;
using solver::GjkResult;
using solver::kEpsilon;
using solver::Problem;
using solver::Vec;

/// Every other sample halves the bracket, so the bracket contains no further double before this
/// number of samples is reached.
constexpr std::uint32_t kMaxSeparationSamples = 256;

/// Position of the fixed shape relative to the moving one, accurate to the last bit on a path of
/// any length.
class Path {
 public:
  explicit Path(const CastPair& pair) noexcept {
    const Vec direction = as_eigen(pair.direction);
    std::frexp(direction.cwiseAbs().maxCoeff(), &exponent_);
    for (int i = 0; i < 3; ++i) {
      step_[i] = std::ldexp(direction[i], -exponent_);
    }
    const TwoDiff apart = difference(pair.pose.position.data(), pair.from.position.data());
    between_ = Vec::Map(apart.difference);
    lost_ = Vec::Map(apart.rest);
    speed_ = step_.norm();
    end_ = std::ldexp(pair.max_t, exponent_);
    begin_ = std::ldexp(pair.free_until, exponent_);
  }

  // The times below are in steps: `step` is the direction times a power of two, with a length near
  // 1.

  [[nodiscard]] const Vec& step() const noexcept { return step_; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] double begin() const noexcept { return begin_; }
  [[nodiscard]] double end() const noexcept { return end_; }

  [[nodiscard]] Vec offset(double t) const noexcept {
    Vec result;
    for (int i = 0; i < 3; ++i) {
      const double path = t * step_[i];
      const double path_error = std::fma(t, step_[i], -path);
      const double sum = between_[i] - path;
      const double back = sum - between_[i];
      const double sum_error = (between_[i] - (sum - back)) + (-path - back);
      const double errors = sum_error + (lost_[i] - path_error);
      result[i] = std::isfinite(errors) ? sum + errors : sum;
    }
    return mid::finite(result);
  }

  [[nodiscard]] double steps(double shown) const noexcept { return std::ldexp(shown, exponent_); }
  /// Converts to the caller's units, rounding down.
  [[nodiscard]] double shown(double t) const noexcept {
    const double result = std::ldexp(t, -exponent_);
    return std::ldexp(result, exponent_) > t ? std::nextafter(result, 0.0) : result;
  }

 private:
  Vec step_;
  Vec between_;
  Vec lost_;
  double speed_ = 1.0;
  double begin_ = 0.0;
  double end_ = 0.0;
  int exponent_ = 0;
};

/// The pair at one time.
struct SeparationSample {
  /// Certainly apart by `gap` > 0 along `normal`, which points from the moving to the fixed shape.
  bool parted = false;
  double gap = 0.0;
  Vec normal = Vec::Zero();
  /// Upper bound on the closing speed along `normal`.
  double closing = 0.0;
};

class Advancement {
 public:
  Advancement(const ShapeTables& tables, const CastPair& pair, double tolerance) noexcept
      : tables_(tables),
        pair_(pair),
        path_(pair),
        tolerance_(tolerance / path_.speed()),
        mirrored_(solver::is_prepared_mirrored(pair.moving.kind(), pair.stationary.kind())),
        largest_(solver::largest_length(tables, pair.moving, pair.stationary)) {}

  bool run(CastTouch& touch) noexcept {
    const bool hit = search();
    touch.steps = steps_;
    if (!hit) return false;
    touch.t = std::min(path_.shown(free_until_), pair_.max_t);
    as_eigen(touch.normal) = -normal_;
    touch.overlaps_at_start = overlap_at_start_;
    return true;
  }

  void describe(CastTouch& touch) noexcept;

 private:
  [[nodiscard]] bool search() noexcept;
  [[nodiscard]] bool touches_at_start() noexcept;
  [[nodiscard]] double next(std::uint32_t step) const noexcept;
  [[nodiscard]] SeparationSample sample(double t, bool any_plane) noexcept;
  [[nodiscard]] bool is_free_to_end() noexcept;
  void face(const Vec& axis, SeparationSample& sample) const noexcept;
  [[nodiscard]] double surely_apart(const Problem& problem, SeparationSample& sample) noexcept;
  void prepare_at(double t) noexcept;

  const ShapeTables& tables_;
  const CastPair& pair_;
  const Path path_;
  const double tolerance_;
  const bool mirrored_;
  const double largest_;
  /// The problem of the last sample.
  Problem problem_;
  bool is_prepared_ = false;
  SolverCounts counts_;
  std::uint32_t steps_ = 0;

  /// The shapes do not touch before free_until_, nor from free_from_ on.
  double free_until_ = 0.0;
  double free_from_ = kInfinity;
  /// Earliest sample at which they touch.
  double touching_ = kInfinity;
  /// The last two advances of `free_until_`.
  double advance_ = 0.0;
  double advance_before_ = 0.0;
  /// Normal of the last plane along which they approached.
  Vec normal_ = Vec::Zero();
  bool overlap_at_start_ = false;
};

void Advancement::prepare_at(double t) noexcept {
  const Vec offset = path_.offset(t);
  if (is_prepared_ && solver::move(mirrored_ ? Vec(-offset) : offset, largest_, problem_)) return;
  is_prepared_ = true;
  Pose moving;
  Pose stationary;
  moving.orientation = pair_.from.orientation;
  stationary.orientation = pair_.pose.orientation;
  as_eigen(stationary.position) = offset;
  if (mirrored_) {
    prepare(tables_, pair_.stationary, stationary, pair_.moving, moving, true, problem_);
  } else {
    prepare(tables_, pair_.moving, moving, pair_.stationary, stationary, false, problem_);
  }
}

/// Returns the gap along a plane that separates the pair, less all rounding; none if the shapes
/// touch as far as double precision can decide. The gap is verified for the plane itself and does
/// not rely on the solver's distance. The plane has about the widest gap, unless `any_plane` is
/// set.
SeparationSample Advancement::sample(double t, bool any_plane) noexcept {
  ++steps_;
  prepare_at(t);
  const Problem& problem = problem_;
  const double roundings = problem.a.rounding + problem.b.rounding;
  const double noise = problem.noise();
  SeparationSample result;
  double gap = 0.0;
  if (problem.b.kind == ShapeKind::half_space) {
    const CoreDistance found = core_distance(problem, ContactLevel::boolean, kInfinity, counts_);
    gap = found.distance - roundings - noise;
    face(found.axis, result);
  } else {
    const bool is_known = !normal_.isZero(0.0);
    const Vec start = is_known ? Vec(mirrored_ ? -normal_ : normal_) : problem.b.center;
    const GjkResult found = gjk(problem.a, problem.b, start,
                                {.noise = solver::kConvergence * noise,
                                 .enough = any_plane ? roundings + 2.0 * noise : kInfinity});
    if (found.contact || found.upper + noise <= roundings) return result;
    gap = found.lower - roundings - noise;
    face(found.axis, result);
    if (!(gap > 0.0) && found.upper - roundings > 2.0 * noise) {
      gap = surely_apart(problem, result) - roundings;
    }
  }
  if (gap > 0.0) result.gap = unscaled(problem, gap);
  result.parted = result.gap > 0.0;
  return result;
}

void Advancement::face(const Vec& axis, SeparationSample& sample) const noexcept {
  sample.normal = mirrored_ ? Vec(-axis) : axis;
  sample.closing = sample.normal.dot(path_.step()) + 4.0 * kEpsilon * path_.speed();
}

/// Proves the separation of pairs for which GJK cannot. If no plane separates the pair by more than
/// rounding, the closing speed is set to the full speed.
double Advancement::surely_apart(const Problem& problem, SeparationSample& sample) noexcept {
  const CoreDistance found = core_distance(problem, ContactLevel::boolean, kInfinity, counts_);
  if (found.overlaps) return 0.0;
  face(found.axis, sample);
  const double roundings = problem.a.rounding + problem.b.rounding;
  const double cores = separation(problem.a, problem.b, found.axis) - problem.noise();
  if (cores > roundings) return cores;
  sample.closing = path_.speed();
  return found.distance - found.doubt;
}

/// Uses exact arithmetic if double precision cannot decide.
bool Advancement::touches_at_start() noexcept {
  const auto solve = [this](ContactLevel level) {
    return solve_pair(tables_, pair_.moving, pair_.from, pair_.stationary, pair_.pose, level, 0.0,
                      counts_);
  };
  overlap_at_start_ = solve(ContactLevel::boolean).overlap;
  if (overlap_at_start_) return true;
  const PairAnswer apart = solve(ContactLevel::distance);
  return as_eigen(apart.normal).dot(path_.step()) > 4.0 * kEpsilon * path_.speed();
}

/// Returns the next sample time: slightly beyond the time that is known to be free; beyond it by
/// the last advance if Newton's method converges as slowly as at double roots (shapes that graze
/// each other). In a bracket, every other sample is the midpoint, so that the search ends for all
/// shapes.
double Advancement::next(std::uint32_t step) const noexcept {
  const bool slow = advance_ > 0.25 * advance_before_ && advance_before_ > 0.0;
  double t = free_until_ + std::max(0.5 * tolerance_, slow ? advance_ : 0.0);
  const double last = std::min(touching_, free_from_);
  if (last < kInfinity && (step % 2 == 0 || t >= last)) {
    t = free_until_ + 0.5 * (last - free_until_);
  }
  return std::min(std::max(t, std::nextafter(free_until_, kInfinity)), path_.end());
}

/// True if a plane with the normal `separating_direction` separates the pair at the end, while they
/// approach along it.
bool Advancement::is_free_to_end() noexcept {
  const Vec separating_direction = as_eigen(pair_.separating_direction);
  if (separating_direction.isZero(0.0) || !(path_.end() < kInfinity)) return false;
  normal_ = -separating_direction;
  const SeparationSample found = sample(path_.end(), true);
  normal_.setZero();
  return found.parted && found.closing > 8.0 * kEpsilon * path_.speed();
}

bool Advancement::search() noexcept {
  if (is_free_to_end()) return false;
  double t = path_.begin();
  free_until_ = t;
  for (std::uint32_t step = 0; step < kMaxSeparationSamples; ++step) {
    const SeparationSample found = sample(t, false);
    if (!found.parted) {
      if (t == 0.0) return touches_at_start();
      touching_ = std::min(touching_, t);
    } else if (found.closing <= 8.0 * kEpsilon * path_.speed()) {
      // The shapes do not approach, up to rounding, so they do not touch from t - gap / leaving on.
      const double leaving = std::max(-found.closing, 0.0);
      free_from_ = std::min(free_from_, add_up(t, -found.gap / leaving));
    } else {
      if (t >= path_.end()) return false;
      const double free = add_down(t, found.gap / found.closing * (1.0 - 4.0 * kEpsilon));
      if (!std::isfinite(free)) return false;
      advance_before_ = advance_;
      advance_ = std::max(free - free_until_, 0.0);
      free_until_ = std::max(free_until_, free);
      normal_ = found.normal;
    }
    if (free_until_ > path_.end() || free_until_ >= free_from_) return false;
    if (touching_ - free_until_ <= tolerance_) return true;
    const double before = t;
    t = next(step);
    // No double is between the two samples.
    if (t == before || t >= touching_ || t >= free_from_) return true;
  }
  return true;
}

void Advancement::describe(CastTouch& touch) noexcept {
  prepare_at(path_.steps(touch.t));
  const Problem& problem = problem_;
  const CoreDistance found = core_distance(problem, ContactLevel::distance, kInfinity, counts_);
  const double apart = found.distance - problem.a.rounding - problem.b.rounding;
  const Vec on_a = found.on_a + found.axis * problem.a.rounding;
  const Vec point = mirrored_ ? on_a : Vec(on_a + found.axis * apart - problem.b.center);
  for (int i = 0; i < 3; ++i) touch.point[i] = unscaled(problem, point[i]);
  const Vec normal = mirrored_ ? found.axis : Vec(-found.axis);
  // For shapes that almost touch, another axis may be as good; keep the known one if this one is
  // not opposed to the motion.
  const bool is_known = !as_eigen(touch.normal).isZero(0.0);
  if (!touch.overlaps_at_start && normal.dot(path_.step()) >= 0.0 && is_known) return;
  as_eigen(touch.normal) = normal;
}

}  // namespace

bool cast_shape(const ShapeTables& tables, const CastPair& pair, double tolerance,
                CastTouch& touch) noexcept {
  return Advancement(tables, pair, tolerance).run(touch);
}

void describe_touch(const ShapeTables& tables, const CastPair& pair, CastTouch& touch) noexcept {
  Advancement(tables, pair, 0.0).describe(touch);
}

}  // namespace winnow
