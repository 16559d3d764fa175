// Reference computations of moving pairs in long double, and a proof by sampled distances that two
// shapes stay apart before a time. Used by tests of times of impact.

#include "tests/pipeline/motion_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/solver/solver.h"

namespace winnow::test {
namespace {

using Real = long double;

struct Span {
  double from;
  double to;
};

Real norm_of(const Vec3d& v) {
  return std::sqrt(static_cast<Real>(v[0]) * v[0] + static_cast<Real>(v[1]) * v[1] +
                   static_cast<Real>(v[2]) * v[2]);
}

/// Computes the orientation at a time in long double.
void turn_to(const RigidMotion& motion, double time, Quaternion& orientation) {
  const Real angle = norm_of(motion.turn);
  const Real half = angle * time / 2;
  const Real s = angle == 0 ? 0 : std::sin(half) / angle;
  const Real o[4] = {std::cos(half), s * motion.turn[0], s * motion.turn[1], s * motion.turn[2]};
  Real q[4];
  Real square = 0;
  for (int i = 0; i < 4; ++i)
    square += static_cast<Real>(motion.start.orientation[i]) * motion.start.orientation[i];
  for (int i = 0; i < 4; ++i) q[i] = motion.start.orientation[i] / std::sqrt(square);
  const Real p[4] = {o[0] * q[0] - o[1] * q[1] - o[2] * q[2] - o[3] * q[3],
                     o[0] * q[1] + o[1] * q[0] + o[2] * q[3] - o[3] * q[2],
                     o[0] * q[2] - o[1] * q[3] + o[2] * q[0] + o[3] * q[1],
                     o[0] * q[3] + o[1] * q[2] - o[2] * q[1] + o[3] * q[0]};
  for (int i = 0; i < 4; ++i) orientation[i] = static_cast<double>(p[i]);
}

/// Returns the largest distance of a point from the shape's position, or 0 for a half-space.
double reach_of(const ShapeTables& tables, ShapeId id) {
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      return tables.spheres[i].radius;
    case ShapeKind::capsule:
      return tables.capsules[i].radius + tables.capsules[i].half_length;
    case ShapeKind::box:
      return static_cast<double>(norm_of(tables.boxes[i].half)) + tables.boxes[i].rounding;
    case ShapeKind::cylinder:
      return std::hypot(tables.cylinders[i].radius, tables.cylinders[i].half_length) +
             tables.cylinders[i].rounding;
    case ShapeKind::cone:
      return std::hypot(tables.cones[i].radius, tables.cones[i].half_length) +
             tables.cones[i].rounding;
    case ShapeKind::hull:
      return static_cast<double>(norm_of(tables.hulls[i].center)) + tables.hulls[i].radius +
             tables.hulls[i].rounding;
    case ShapeKind::triangle: {
      Real most = 0;
      for (const auto& corner : tables.triangles[i].vertex) most = std::max(most, norm_of(corner));
      return static_cast<double>(most) + tables.triangles[i].rounding;
    }
    case ShapeKind::ellipsoid:
      return *std::ranges::max_element(tables.ellipsoids[i].radius) + tables.ellipsoids[i].rounding;
    case ShapeKind::tapered_capsule:
      return tables.tapered_capsules[i].half_length +
             std::max(tables.tapered_capsules[i].radius[0], tables.tapered_capsules[i].radius[1]);
    case ShapeKind::support:
      return tables.supports[i].radius + tables.supports[i].rounding;
    default:
      return 0.0;
  }
}

/// Returns half the size of a shape.
double extent_of(const ShapeTables& tables, ShapeId id) {
  const std::uint32_t i = id.index();
  if (id.kind() == ShapeKind::hull) return tables.hulls[i].radius + tables.hulls[i].rounding;
  if (id.kind() != ShapeKind::triangle) return reach_of(tables, id);
  const TriangleShape& t = tables.triangles[i];
  Real most = 0;
  for (int k = 0; k < 3; ++k) {
    double side[3];
    for (int x = 0; x < 3; ++x) side[x] = t.vertex[(k + 1) % 3][x] - t.vertex[k][x];
    most = std::max(most, norm_of(side));
  }
  return static_cast<double>(most) / 2 + t.rounding;
}

double relative_way(const MovingShapes& pair, double time) {
  Real square = 0;
  for (int i = 0; i < 3; ++i) {
    const Real d = static_cast<Real>(pair.motion[1].start.position[i]) -
                   pair.motion[0].start.position[i] +
                   time * (static_cast<Real>(pair.motion[1].travel[i]) - pair.motion[0].travel[i]);
    square += d * d;
  }
  return static_cast<double>(std::sqrt(square));
}

void set_direction(Random& random, double length, Vec3d& v) {
  for (;;) {
    double square = 0.0;
    for (double& x : v) {
      x = random.uniform(-1, 1);
      square += x * x;
    }
    if (square < 0.01 || square > 1.0) continue;
    for (double& x : v) x *= length / std::sqrt(square);
    // Often along an axis, so that faces and edges stay parallel.
    if (random.chance(0.3)) v[random.below(3)] = v[random.below(3)] = 0.0;
    return;
  }
}

/// Sets random velocities of the given style.
void set_motion(MotionStyle style, double size, Random& random, RigidMotion& motion) {
  constexpr double kHalfTurn = 3.14159265358979;
  double way = size * random.log_uniform(0.1, 10.0);
  double angle = random.uniform(0.0, kHalfTurn);
  switch (style) {
    case MotionStyle::travelling:
      angle = 0.0;
      break;
    case MotionStyle::turning:
      way = 0.0;
      break;
    case MotionStyle::whirling:
      angle = random.uniform(0.0, 40.0) * kHalfTurn;
      break;
    case MotionStyle::bullet:
      way = size * random.log_uniform(10.0, 1e6);
      break;
    case MotionStyle::grazing:
      way = size * random.log_uniform(1e-4, 1.0);
      angle *= random.log_uniform(1e-4, 1.0);
      break;
    default:
      break;
  }
  set_direction(random, way, motion.travel);
  set_direction(random, angle, motion.turn);
}

}  // namespace

const char* to_string(MotionStyle style) {
  constexpr const char* kNames[] = {"travelling", "turning",  "moving",   "whirling",
                                    "bullet",     "far_away", "touching", "grazing"};
  return kNames[static_cast<int>(style)];
}

std::vector<ShapeKind> moving_kinds() {
  std::vector<ShapeKind> kinds = all_kinds();
  kinds.push_back(ShapeKind::ellipsoid);
  kinds.push_back(ShapeKind::tapered_capsule);
  kinds.push_back(ShapeKind::support);
  return kinds;
}

MovingShapes moving_pair(const PairScene& scene, BodyPair pair, MotionStyle style, Random& random) {
  MovingShapes result;
  const std::uint32_t body[2] = {pair.a, pair.b};
  const double contact_time = style == MotionStyle::touching ? 0.0 : random.unit();
  const bool one_is_stationary = random.chance(0.5);
  for (int k = 0; k < 2; ++k) {
    result.shape[k] = scene.shapes[body[k]];
    RigidMotion& motion = result.motion[k];
    motion = RigidMotion::stationary(scene.poses[body[k]]);
    if (k == 0 && one_is_stationary) continue;
    set_motion(style, extent(scene, pair), random, motion);
    RigidMotion back = motion;
    for (double& x : back.travel) x = -x;
    for (double& x : back.turn) x = -x;
    motion.start = back.at(contact_time);
  }
  if (style == MotionStyle::far_away) {
    const double offset = 1e9 * extent(scene, pair);
    for (RigidMotion& motion : result.motion) motion.start.position[0] += offset;
  }
  return result;
}

DistanceAt distance_at(const ShapePool& pool, const MovingShapes& pair, double time) {
  Pose pose[2];
  for (int k = 0; k < 2; ++k) turn_to(pair.motion[k], time, pose[k].orientation);
  for (int i = 0; i < 3; ++i) {
    const Real start =
        static_cast<Real>(pair.motion[1].start.position[i]) - pair.motion[0].start.position[i];
    const Real way = static_cast<Real>(pair.motion[1].travel[i]) - pair.motion[0].travel[i];
    pose[1].position[i] = static_cast<double>(start + time * way);
  }
  SolverCounts counts;
  const PairAnswer answer = solve_pair(pool.tables(), pair.shape[0], pose[0], pair.shape[1],
                                       pose[1], ContactLevel::distance, 0.0, counts);
  return {answer.distance, answer.error_bound};
}

double size_of(const ShapePool& pool, const MovingShapes& pair) {
  const double a = extent_of(pool.tables(), pair.shape[0]);
  const double b = extent_of(pool.tables(), pair.shape[1]);
  return std::min(a, b) > 0.0 ? std::min(a, b) : std::max(a, b);
}

double doubt_of(const ShapePool& pool, const MovingShapes& pair) {
  double sizes = 0.0;
  bool curved = false;
  for (const ShapeId shape : pair.shape) {
    sizes += reach_of(pool.tables(), shape);
    curved = curved || shape.kind() == ShapeKind::cylinder || shape.kind() == ShapeKind::cone ||
             shape.kind() == ShapeKind::ellipsoid || shape.kind() == ShapeKind::tapered_capsule ||
             shape.kind() == ShapeKind::support;
  }
  return curved ? 1e-8 * sizes : 0.0;
}

double resolution_of(const ShapePool& pool, const MovingShapes& pair) {
  double sizes = 0.0;
  for (const ShapeId shape : pair.shape) sizes += reach_of(pool.tables(), shape);
  return 1e-13 * (speed_bound(pool, pair) + relative_way(pair, 0.0) + sizes) + doubt_of(pool, pair);
}

double speed_bound(const ShapePool& pool, const MovingShapes& pair) {
  double travel[3];
  for (int i = 0; i < 3; ++i) travel[i] = pair.motion[1].travel[i] - pair.motion[0].travel[i];
  double speed = static_cast<double>(norm_of(travel));
  const double apart = std::max(relative_way(pair, 0.0), relative_way(pair, 1.0));
  for (int k = 0; k < 2; ++k) {
    const bool plane = pair.shape[k].kind() == ShapeKind::half_space;
    const double reach = plane ? apart + reach_of(pool.tables(), pair.shape[1 - k])
                               : reach_of(pool.tables(), pair.shape[k]);
    speed += static_cast<double>(norm_of(pair.motion[k].turn)) * reach;
  }
  return speed * (1.0 + 1e-12);
}

Before before(const ShapePool& pool, const MovingShapes& pair, double time,
              std::size_t max_samples) {
  return before([&](double at) { return distance_at(pool, pair, at); }, speed_bound(pool, pair),
                doubt_of(pool, pair), time, max_samples);
}

Pose place_at(const RigidMotion& motion, double time, const Vec3d& origin) {
  Pose pose;
  turn_to(motion, time, pose.orientation);
  for (int i = 0; i < 3; ++i) {
    const Real from = static_cast<Real>(motion.start.position[i]) - origin[i];
    pose.position[i] = static_cast<double>(from + time * static_cast<Real>(motion.travel[i]));
  }
  return pose;
}

Before before(const std::function<DistanceAt(double)>& distance, double speed, double doubt,
              double time, std::size_t max_samples) {
  if (time == 0.0) return Before::apart;
  std::vector<Span> open{{0.0, time}};
  bool proved = true;
  for (std::size_t samples = 0; !open.empty(); ++samples) {
    // Take the last, shortest interval first, so that every depth is reached within the limit of
    // samples.
    const Span span = open.back();
    open.pop_back();
    const double middle = 0.5 * (span.from + span.to);
    const DistanceAt at = distance(middle);
    if (at.distance < -at.error - doubt) return Before::overlapping;
    if (at.distance - at.error > 0.5 * speed * (span.to - span.from)) continue;
    if (samples >= max_samples || middle <= span.from || middle >= span.to) {
      proved = false;
      continue;
    }
    open.push_back({span.from, middle});
    open.push_back({middle, span.to});
  }
  return proved ? Before::apart : Before::likely_apart;
}

}  // namespace winnow::test
