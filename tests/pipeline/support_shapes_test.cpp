// Shapes given by support functions: ellipsoids, tapered capsules and user shapes, compared with
// equal shapes of other kinds and with closed forms in long double.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "tests/pipeline/floor_contacts.h"
#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Real = long double;
using RealVec = Eigen::Matrix<Real, 3, 1>;
constexpr double kEndless = std::numeric_limits<double>::infinity();

// --- support functions of user shapes -----------------------------------------------------------

void farthest_of_block(const void* context, const double direction[3], double point[3]) {
  const auto& box = *static_cast<const BoxShape*>(context);
  for (int i = 0; i < 3; ++i) point[i] = direction[i] < 0.0 ? -box.half[i] : box.half[i];
}

void farthest_of_drum(const void* context, const double direction[3], double point[3]) {
  const auto& drum = *static_cast<const CylinderShape*>(context);
  const double across = std::hypot(direction[0], direction[1]);
  for (int i = 0; i < 2; ++i) {
    point[i] = across > 0.0 ? drum.radius * (direction[i] / across) : 0.0;
  }
  point[2] = direction[2] < 0.0 ? -drum.half_length : drum.half_length;
}

/// A shape whose support function can be made invalid after it was added.
struct FaultyShape {
  enum Fault { good, not_a_number, endless, zero, far_away, contradictory };
  Fault fault = good;
};

void farthest_of_faulty(const void* context, const double direction[3], double point[3]) {
  const BoxShape cube{{1.0, 1.0, 1.0}};
  farthest_of_block(&cube, direction, point);
  switch (static_cast<const FaultyShape*>(context)->fault) {
    case FaultyShape::good:
      return;
    case FaultyShape::not_a_number:
      point[1] = std::numeric_limits<double>::quiet_NaN();
      return;
    case FaultyShape::endless:
      point[2] = -kEndless;
      return;
    case FaultyShape::zero:
      std::fill_n(point, 3, 0.0);
      return;
    case FaultyShape::far_away:
      for (int i = 0; i < 3; ++i) point[i] *= 1e300;
      return;
    case FaultyShape::contradictory:
      // Neither the farthest point nor continuous.
      for (int i = 0; i < 3; ++i) point[i] = std::sin(1e4 * direction[i] + i) - point[i] * 0.5;
  }
}

// --- equal shapes of two kinds ------------------------------------------------------------------

/// Adds a shape of a new kind and an equal shape of an old kind.
struct Same {
  const char* name;
  std::function<void(Random&, ShapePool&, ShapeId&, ShapeId&)> add;
};

BoxShape the_block;
CylinderShape the_drum;

std::vector<Same> same_shapes() {
  return {{"block",
           [](Random& random, ShapePool& pool, ShapeId& id, ShapeId& known) {
             the_block = {{random.uniform(0.2, 1.0), random.uniform(0.2, 1.0), 0.5}, 0.1};
             const SupportShape own{farthest_of_block, &the_block, 2.0, 0.1};
             id = expect_ok(pool.add(own));
             known = expect_ok(pool.add(the_block));
           }},
          {"drum",
           [](Random& random, ShapePool& pool, ShapeId& id, ShapeId& known) {
             the_drum = {random.uniform(0.2, 1.0), random.uniform(0.2, 1.0), 0.0};
             const SupportShape own{farthest_of_drum, &the_drum, 2.0, 0.0};
             id = expect_ok(pool.add(own));
             known = expect_ok(pool.add(the_drum));
           }},
          {"ball",
           [](Random& random, ShapePool& pool, ShapeId& id, ShapeId& known) {
             const double r = random.uniform(0.2, 1.0);
             id = expect_ok(pool.add(EllipsoidShape{{r, r, r}, 0.125}));
             known = expect_ok(pool.add(SphereShape{r + 0.125}));
           }},
          {"capsule",
           [](Random& random, ShapePool& pool, ShapeId& id, ShapeId& known) {
             const double r = random.uniform(0.2, 1.0);
             id = expect_ok(pool.add(TaperedCapsuleShape{{r, r}, 0.7}));
             known = expect_ok(pool.add(CapsuleShape{r, 0.7}));
           }},
          {"ball in a ball", [](Random& random, ShapePool& pool, ShapeId& id, ShapeId& known) {
             const double r = random.uniform(1.0, 2.0);
             const double less = random.uniform(0.0, 0.9);
             id = expect_ok(pool.add(TaperedCapsuleShape{{r, less}, 0.0}));
             known = expect_ok(pool.add(SphereShape{r}));
           }}};
}

/// Pairs in which one shape is given both as a new and as an old kind.
struct SamePairs {
  SamePairs(const Same& same, ShapeKind kind, std::size_t count, Random& random) {
    add_pairs(scene, kind, kind, PairStyle::ordinary, count, random);
    ShapeId id;
    ShapeId old;
    same.add(random, scene.pool, id, old);
    known = scene.shapes;
    for (std::size_t i = 0; i < known.size(); i += 2) {
      scene.shapes[i] = id;
      known[i] = old;
    }
  }
  [[nodiscard]] std::vector<PairResults> truth(const NarrowOptions& options) const {
    NarrowPhase narrow;
    NarrowResult result;
    EXPECT_EQ(narrow.collide(scene.pool, {known, scene.poses}, scene.pairs, options, result),
              Status::ok);
    return answers_of(result, scene.pairs.size());
  }

  PairScene scene;
  std::vector<ShapeId> known;
};

void expect_alike(const PairResults& one, const PairResults& known) {
  const double bound = one.error_bound + known.error_bound;
  EXPECT_LE(std::abs(one.distance - known.distance), bound);
  EXPECT_LT(one.error_bound, 1e-4);
  EXPECT_NEAR(one.normal.norm(), 1.0, 1e-12);
  if (std::abs(known.distance) > bound) {
    EXPECT_EQ(one.overlap, known.overlap);
  }
}

void expect_deepest_point(const PairResults& answer) {
  ASSERT_FALSE(answer.contacts.empty());
  double deepest = -kEndless;
  for (const ContactPoint& point : answer.contacts) {
    deepest = std::max(deepest, static_cast<double>(point.depth));
  }
  EXPECT_NEAR(deepest, -answer.distance, 1e-5);
}

TEST(SupportShapes, support_shapes_match_equal_shapes) {
  constexpr double kMargin = 0.1;
  Random random(1);
  for (const Same& same : same_shapes()) {
    for (const ShapeKind kind : all_kinds()) {
      const SamePairs pairs(same, kind, scaled(60), random);
      for (const ContactLevel level :
           {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
        const NarrowOptions options{.level = level, .contact_margin = kMargin};
        const auto answers = compute_results(pairs.scene, options);
        const auto truth = pairs.truth(options);
        for (std::size_t i = 0; i < answers.size(); ++i) {
          SCOPED_TRACE(std::string(same.name) + " " + to_string(kind) + " " + std::to_string(i));
          if (level == ContactLevel::boolean) {
            EXPECT_EQ(answers[i].overlap, truth[i].overlap);
            continue;
          }
          const bool is_near = truth[i].distance <= kMargin - 1e-6;
          if (level == ContactLevel::distance || is_near) expect_alike(answers[i], truth[i]);
          if (level == ContactLevel::manifold && is_near) expect_deepest_point(answers[i]);
        }
      }
    }
  }
}

// --- closed forms in long double ----------------------------------------------------------------

/// Returns the distance of a point from the surface of an ellipsoid, negative inside, by bisection
/// (Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", 2013). No
/// coordinate may be 0.
Real from_ellipsoid(const EllipsoidShape& shape, const RealVec& point) {
  const RealVec r = as_eigen(shape.radius).cast<Real>();
  const Real least = r.minCoeff();
  const auto level = [&](Real t) {
    Real sum = -1.0L;
    for (int i = 0; i < 3; ++i) {
      const Real q = r[i] * point[i] / (t + r[i] * r[i]);
      sum += q * q;
    }
    return sum;
  };
  Real low = -least * least;
  Real high = r.maxCoeff() * (point.norm() + r.maxCoeff());
  for (int step = 0; step < 200; ++step) {
    const Real t = 0.5L * (low + high);
    (level(t) > 0.0L ? low : high) = t;
  }
  RealVec foot;
  for (int i = 0; i < 3; ++i) foot[i] = r[i] * r[i] * point[i] / (low + r[i] * r[i]);
  const Real distance = (point - foot).norm();
  return level(0.0L) > 0.0L ? distance : -distance;
}

/// Returns the minimum of a convex function on [0, 1].
Real least_of(const std::function<Real(Real)>& f) {
  Real low = 0.0L;
  Real high = 1.0L;
  for (int step = 0; step < 160; ++step) {
    const Real a = low + (high - low) / 3.0L;
    const Real b = high - (high - low) / 3.0L;
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  return f(0.5L * (low + high));
}

/// Centre and radius of the ball at parameter t of a tapered capsule.
RealVec centre_at(const TaperedCapsuleShape& taper, Real t) {
  return {0.0L, 0.0L, (2.0L * t - 1.0L) * taper.half_length};
}
Real radius_at(const TaperedCapsuleShape& taper, Real t) {
  return (1.0L - t) * taper.radius[0] + t * taper.radius[1];
}

Eigen::Matrix<Real, 3, 3> turn_of(const Pose& pose) {
  const double* q = pose.orientation.data();
  return Eigen::Quaternion<Real>(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

/// Maps a point of b's frame to a's frame.
RealVec seen_from(const Pose& a, const Pose& b, const RealVec& point) {
  const RealVec at = as_eigen(b.position).cast<Real>() - as_eigen(a.position).cast<Real>();
  return turn_of(a).transpose() * (turn_of(b) * point + at);
}

Pose random_pose(Random& random, double reach) {
  Pose pose;
  for (double& x : pose.position) x = random.uniform(-reach, reach);
  for (double& x : pose.orientation) x = random.uniform(-1.0, 1.0);
  return pose;
}

/// Returns a thin or an ordinary length.
double length(Random& random) {
  return random.chance(0.2) ? random.log_uniform(1e-3, 1.0) : random.uniform(0.2, 1.5);
}

template <typename A, typename B>
PairResults answer_to(const A& a, const Pose& pose_a, const B& b, const Pose& pose_b) {
  PairScene scene;
  scene.shapes.resize(2);
  scene.shapes[0] = expect_ok(scene.pool.add(a));
  scene.shapes[1] = expect_ok(scene.pool.add(b));
  scene.poses = {pose_a, pose_b};
  scene.pairs = {{0, 1}};
  const auto answers = compute_results(scene, {.level = ContactLevel::distance});
  return answers.empty() ? PairResults{} : answers[0];
}

void expect_truth(const PairResults& answer, Real truth) {
  EXPECT_LE(std::abs(static_cast<Real>(answer.distance) - truth),
            static_cast<Real>(answer.error_bound));
  EXPECT_EQ(answer.overlap, truth <= 0.0L);
}

TEST(Ellipsoids, ellipsoid_distances_match_closed_forms) {
  Random random(2);
  for (std::size_t n = scaled(200); n-- != 0;) {
    SCOPED_TRACE(n);
    const EllipsoidShape shape{{length(random), length(random), length(random)}};
    const Pose at = random_pose(random, 1.0);
    const Pose other = random_pose(random, 2.0);
    const Real of_point = from_ellipsoid(shape, seen_from(at, other, RealVec::Zero()));
    expect_truth(answer_to(shape, at, SphereShape{0.25}, other), of_point - 0.25L);
    expect_truth(answer_to(SphereShape{}, other, shape, at), of_point);
    const TaperedCapsuleShape taper{{length(random), length(random)}, length(random)};
    const auto gap = [&](Real t) {
      return from_ellipsoid(shape, seen_from(at, other, centre_at(taper, t))) - radius_at(taper, t);
    };
    // Distance along the capsule's axis. Valid only while the axis is outside the ellipsoid.
    const Real apart = least_of(gap);
    if (apart > 0.0L) expect_truth(answer_to(taper, other, shape, at), apart);
    const HalfSpaceShape plane{{0.0, 0.0, 1.0}, 0.5};
    const RealVec normal = turn_of(at).transpose() * turn_of(other).col(2);
    const RealVec r = as_eigen(shape.radius).cast<Real>();
    const Real height = -normal.dot(seen_from(at, other, RealVec::Zero())) - 0.5L;
    expect_truth(answer_to(plane, other, shape, at), height - r.cwiseProduct(normal).norm());
  }
}

TEST(Ellipsoids, shallow_ellipsoid_depths_are_accurate) {
  Random random(12);
  for (std::size_t n = scaled(200); n-- != 0;) {
    SCOPED_TRACE(n);
    // Two equal ellipsoids in the same orientation: their Minkowski difference is an ellipsoid with
    // twice the radii.
    EllipsoidShape shape;
    for (double& r : shape.radius) r = random.uniform(0.6, 1.0);
    EllipsoidShape difference = shape;
    for (double& r : difference.radius) r *= 2.0;
    const Eigen::Vector3d r = as_eigen(shape.radius);
    const Eigen::Vector3d out =
        Eigen::Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                        random.uniform(-1.0, 1.0))
            .normalized();
    const Eigen::Vector3d top = r.cwiseProduct(r.cwiseProduct(out)) / r.cwiseProduct(out).norm();
    const Eigen::Vector3d at = 2.0 * top - random.uniform(1e-6, 0.2) * out;
    const PairResults answer = answer_to(shape, Pose{}, shape, Pose::at(at.x(), at.y(), at.z()));
    expect_truth(answer, from_ellipsoid(difference, at.cast<Real>()));
    EXPECT_LT(answer.error_bound, 1e-13);
  }
}

TEST(TaperedCapsules, tapered_capsule_distances_match_closed_form) {
  Random random(3);
  for (std::size_t n = scaled(200); n-- != 0;) {
    SCOPED_TRACE(n);
    const TaperedCapsuleShape taper{{length(random), length(random)}, length(random)};
    const Pose at = random_pose(random, 1.0);
    const Pose other = random_pose(random, 2.0);
    const RealVec point = seen_from(at, other, RealVec::Zero());
    const Real truth = least_of(
        [&](Real t) { return (point - centre_at(taper, t)).norm() - radius_at(taper, t); });
    expect_truth(answer_to(taper, at, SphereShape{}, other), truth);
    expect_truth(answer_to(SphereShape{0.5}, other, taper, at), truth - 0.5L);
  }
}

TEST(SupportShapes, coincident_centres_stay_within_error_bounds) {
  Random random(4);
  for (std::size_t n = scaled(60); n-- != 0;) {
    SCOPED_TRACE(n);
    const EllipsoidShape shape{{length(random), length(random), length(random)}};
    const Pose at = random_pose(random, 0.0);
    const Pose other = random_pose(random, 0.0);
    const double least = std::min({shape.radius[0], shape.radius[1], shape.radius[2]});
    expect_truth(answer_to(shape, at, SphereShape{0.5}, other), -0.5L - least);
    const TaperedCapsuleShape taper{{length(random), length(random)}, length(random)};
    const Real truth =
        least_of([&](Real t) { return centre_at(taper, t).norm() - radius_at(taper, t); });
    expect_truth(answer_to(taper, at, SphereShape{0.5}, other), truth - 0.5L);
    EXPECT_LT(answer_to(taper, at, SphereShape{0.5}, other).error_bound, 1e-13);
    EXPECT_LT(answer_to(shape, at, SphereShape{0.5}, other).error_bound, 1e-13);
  }
}

TEST(Ellipsoids, vanishing_radii_give_finite_results) {
  Random random(10);
  for (std::size_t n = scaled(300); n-- != 0;) {
    const double size = random.chance(0.5) ? 1e150 : 1e-150;
    const auto any = [&] { return random.chance(0.5) ? size : size * 1e-160 * random.unit(); };
    Pose at;
    for (double& x : at.position) x = any();
    const EllipsoidShape shape{{any(), any(), any()}};
    const PairResults answer = answer_to(SphereShape{any()}, Pose{}, shape, at);
    EXPECT_TRUE(std::isfinite(answer.distance) && std::isfinite(answer.error_bound));
    EXPECT_NEAR(answer.normal.norm(), 1.0, 1e-12);
  }
}

// --- bounds, rays, manifolds --------------------------------------------------------------------

/// A drum that counts calls of its support function.
struct CountingDrum {
  CylinderShape drum;
  std::size_t calls = 0;
};

void farthest_of_counting_drum(const void* context, const double direction[3], double point[3]) {
  auto& drum = *static_cast<CountingDrum*>(const_cast<void*>(context));
  ++drum.calls;
  farthest_of_drum(&drum.drum, direction, point);
}

TEST(SupportShapes, overlapping_roundings_need_few_support_calls) {
  CountingDrum drum{{0.5, 1.0}};
  PairScene scene;
  scene.shapes.resize(2);
  scene.shapes[0] =
      expect_ok(scene.pool.add(SupportShape{farthest_of_counting_drum, &drum, 2.0, 1.0}));
  scene.shapes[1] = expect_ok(scene.pool.add(CapsuleShape{1.0, 1.0}));
  scene.poses = {Pose{}, Pose::at(1.2, 0.4, 0.3)};
  scene.poses[1].orientation[1] = 0.4;
  scene.pairs = {{0, 1}};
  const auto calls_at = [&](ContactLevel level) {
    const std::size_t before = drum.calls;
    EXPECT_TRUE(compute_results(scene, {.level = level})[0].overlap);
    return drum.calls - before;
  };
  const std::size_t for_verdict = calls_at(ContactLevel::boolean);
  EXPECT_LE(for_verdict, 3U);
  EXPECT_GT(calls_at(ContactLevel::distance), 2 * for_verdict);
}

TEST(SupportShapes, bounds_contain_shapes_and_are_tight) {
  Random random(5);
  for (std::size_t n = scaled(200); n-- != 0;) {
    ShapePool pool;
    ShapeId id[3];
    const EllipsoidShape ball{{length(random), length(random), length(random)}, 0.1};
    const TaperedCapsuleShape taper{{length(random), length(random)}, length(random)};
    const BoxShape box{{length(random), length(random), length(random)}, 0.1};
    id[0] = expect_ok(pool.add(ball));
    id[1] = expect_ok(pool.add(taper));
    id[2] = expect_ok(pool.add(SupportShape{farthest_of_block, &box, 3.0, 0.1}));
    const Pose pose = random_pose(random, 3.0);
    for (int axis = 0; axis < 3; ++axis) {
      const RealVec row = turn_of(pose).row(axis);
      const RealVec r = as_eigen(ball.radius).cast<Real>();
      const RealVec h = as_eigen(box.half).cast<Real>();
      const Real up = row.z() * taper.half_length;
      const Real high[3] = {r.cwiseProduct(row).norm() + 0.1L,
                            std::max(taper.radius[0] - up, taper.radius[1] + up),
                            h.dot(row.cwiseAbs()) + 0.1L};
      for (int i = 0; i < 3; ++i) {
        const auto top = static_cast<Real>(pool.bounds(id[i], pose).max[axis]);
        EXPECT_GE(top, pose.position[axis] + high[i] - 1e-12L);
        EXPECT_LE(top, pose.position[axis] + high[i] + 2e-6L);
      }
    }
  }
}

/// Checks that a ray hits two shapes of a pool alike.
void expect_same_hit(const ShapePool& pool, ShapeId one, ShapeId other, const Pose& pose,
                     const ShapeRay& ray, double doubt) {
  ShapeHit hit;
  ShapeHit known;
  hit = expect_ok(cast_ray(pool.tables(), one, pose, ray));
  known = expect_ok(cast_ray(pool.tables(), other, pose, ray));
  ASSERT_EQ(hit.hit, known.hit);
  if (!hit.hit) return;
  EXPECT_NEAR(hit.t, known.t, doubt);
  const double along = as_eigen(hit.normal).dot(as_eigen(known.normal));
  // At an edge either face normal is valid.
  EXPECT_GT(along, known.t == 0.0 ? 0.999 : -1e-6);
}

TEST(SupportShapes, rays_hit_at_the_surface) {
  Random random(6);
  for (std::size_t n = scaled(1000); n-- != 0;) {
    SCOPED_TRACE(n);
    ShapePool pool;
    const EllipsoidShape ball{{length(random), length(random), length(random)}};
    const TaperedCapsuleShape taper{{length(random), length(random)}, length(random)};
    const BoxShape box{{length(random), length(random), length(random)}};
    ShapeId id[4];
    id[0] = expect_ok(pool.add(ball));
    id[1] = expect_ok(pool.add(taper));
    id[2] = expect_ok(pool.add(SupportShape{farthest_of_block, &box, 3.0, 0.0}));
    id[3] = expect_ok(pool.add(box));
    const Pose pose = random_pose(random, 1.0);
    ShapeRay ray;
    for (double& x : ray.origin) x = random.uniform(-3.0, 3.0);
    for (int i = 0; i < 3; ++i) {
      ray.direction[i] = pose.position[i] + random.uniform(-1.2, 1.2) - ray.origin[i];
    }
    expect_same_hit(pool, id[2], id[3], pose, ray, 1e-12);
    const auto height = [&](std::size_t which, Real t) {
      const RealVec at =
          as_eigen(ray.origin).cast<Real>() + t * as_eigen(ray.direction).cast<Real>();
      const RealVec point = turn_of(pose).transpose() * (at - as_eigen(pose.position).cast<Real>());
      if (which == 0) return from_ellipsoid(ball, point);
      return least_of([&](Real share) {
        return (point - centre_at(taper, share)).norm() - radius_at(taper, share);
      });
    };
    for (std::size_t which = 0; which < 2; ++which) {
      ShapeHit hit = expect_ok(cast_ray(pool.tables(), id[which], pose, ray));
      const bool begins_inside = height(which, 0.0L) <= 0.0L;
      if (begins_inside) {
        EXPECT_TRUE(hit.hit);
        EXPECT_EQ(hit.t, 0.0);
        continue;
      }
      const Real last = hit.hit ? static_cast<Real>(hit.t) : 3.0L;
      if (hit.hit) {
        EXPECT_NEAR(static_cast<double>(height(which, hit.t)), 0.0, 1e-13);
      }
      for (int i = 1; i < 16; ++i) EXPECT_GT(height(which, last * i / 16.0L), -1e-13L);
    }
  }
}

Pose tilted(double height, double tilt) {
  Pose pose = Pose::at(0, 0, height);
  pose.orientation[0] = std::cos(0.5 * tilt);
  pose.orientation[1] = std::sin(0.5 * tilt);
  return pose;
}

TEST(SupportShapes, resting_shapes_have_expected_contact_counts) {
  constexpr double kMargin = 0.02;
  ShapePool pool;
  const BoxShape box{{0.5, 0.4, 0.3}};
  ShapeId block;
  ShapeId ball;
  ShapeId taper;
  block = expect_ok(pool.add(SupportShape{farthest_of_block, &box, 1.0, 0.0}));
  ball = expect_ok(pool.add(EllipsoidShape{{1.0, 1.0, 0.3}}));
  taper = expect_ok(pool.add(TaperedCapsuleShape{{0.3, 0.2}, 1.0}));
  for (const double tilt : {0.0, 1e-6, 1e-4, 1e-2}) {
    EXPECT_EQ(contacts_on_floor(pool, block, tilted(0.3, tilt), kMargin).size(), 4U) << tilt;
    EXPECT_EQ(contacts_on_floor(pool, ball, tilted(0.3, tilt), kMargin).size(), 1U) << tilt;
  }
  // Lying on its side, which slopes by asin(0.05).
  const double slope = std::asin(0.05);
  const Pose on_side = tilted(0.25, 0.5 * 3.14159265358979 + slope);
  EXPECT_EQ(contacts_on_floor(pool, taper, on_side, kMargin).size(), 2U);
}

TEST(SupportShapes, ellipsoid_rests_on_point_below) {
  ShapePool pool;
  ShapeId ball = expect_ok(pool.add(EllipsoidShape{{1.0, 0.8, 0.3}}));
  const std::vector<ContactPoint> points = contacts_on_floor(pool, ball, Pose::at(0, 0, 0.3), 0.02);
  ASSERT_EQ(points.size(), 1U);
  for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(points[0].position[axis], 0.0F, 1e-6F);
}

// --- invalid shapes -----------------------------------------------------------------------------

TEST(SupportShapes, invalid_support_functions_are_refused) {
  ShapePool pool;
  ShapeId id;
  FaultyShape faulty;
  id = expect_ok(pool.add(SupportShape{farthest_of_faulty, &faulty, 2.0, 0.0}));
  expect_error(pool.add(SupportShape{nullptr, nullptr, 2.0, 0.0}), Status::invalid_shape);
  expect_error(pool.add(SupportShape{farthest_of_faulty, &faulty, -2.0, 0.0}),
               Status::invalid_shape);
  expect_error(pool.add(SupportShape{farthest_of_faulty, &faulty, 2.0, kEndless}),
               Status::invalid_shape);
  expect_error(pool.add(SupportShape{farthest_of_faulty, &faulty, 1.0, 0.0}),
               Status::invalid_shape);
  for (const auto fault : {FaultyShape::not_a_number, FaultyShape::endless, FaultyShape::far_away,
                           FaultyShape::contradictory}) {
    faulty.fault = fault;
    expect_error(pool.add(SupportShape{farthest_of_faulty, &faulty, 2.0, 0.0}),
                 Status::invalid_shape);
  }
  EXPECT_EQ(pool.size(ShapeKind::support), 1U);
  expect_error(pool.add(EllipsoidShape{{1.0, -1.0, 1.0}}), Status::invalid_shape);
  expect_error(pool.add(EllipsoidShape{{1.0, 1.0, kEndless}}), Status::invalid_shape);
  expect_error(pool.add(TaperedCapsuleShape{{1.0, -0.5}, 1.0}), Status::invalid_shape);
  expect_error(pool.add(TaperedCapsuleShape{{1.0, 0.5}, std::nan("")}), Status::invalid_shape);
}

TEST(SupportShapes, functions_that_become_invalid_give_finite_results) {
  Random random(8);
  FaultyShape faulty;
  for (const ShapeKind kind : all_kinds()) {
    PairScene scene;
    add_pairs(scene, kind, kind, PairStyle::ordinary, scaled(40), random);
    faulty.fault = FaultyShape::good;
    ShapeId id = expect_ok(scene.pool.add(SupportShape{farthest_of_faulty, &faulty, 2.0, 0.1}));
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) scene.shapes[2 * i] = id;
    for (const auto fault : {FaultyShape::not_a_number, FaultyShape::endless, FaultyShape::zero,
                             FaultyShape::far_away, FaultyShape::contradictory}) {
      faulty.fault = fault;
      for (const ContactLevel level :
           {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
        for (const PairResults& answer :
             compute_results(scene, {.level = level, .contact_margin = 0.1})) {
          EXPECT_TRUE(std::isfinite(answer.distance) && answer.normal.allFinite() &&
                      answer.point.allFinite() && !(answer.error_bound < 0.0));
        }
      }
      ShapeHit hit;
      const ShapeRay ray{{3, 0.1, 0.2}, {-1, 0, 0}};
      hit = expect_ok(cast_ray(scene.pool.tables(), id, Pose{}, ray));
      EXPECT_TRUE(std::isfinite(hit.t));
      std::vector<RigidMotion> motions;
      for (const Pose& pose : scene.poses) {
        motions.push_back(RigidMotion::between(pose, Pose::at(0.1, 0.2, 0.3)));
      }
      ImpactResult impacts;
      ASSERT_EQ(
          time_of_impact(scene.pool, {scene.shapes, motions},
                         std::span(scene.pairs).first(std::min<std::size_t>(scene.pairs.size(), 4)),
                         {}, impacts),
          Status::ok);
      for (std::size_t i = 0; i < impacts.size(); ++i) {
        EXPECT_TRUE(!impacts.hits(i) || (impacts.time()[i] >= 0.0 && impacts.time()[i] <= 1.0));
      }
    }
  }
}

// --- motions and scenes -------------------------------------------------------------------------

TEST(SupportShapes, times_of_impact_match_equal_shapes) {
  Random random(9);
  for (const Same& same : same_shapes()) {
    for (const ShapeKind kind : all_kinds()) {
      const SamePairs pairs(same, kind, scaled(8), random);
      const PairScene& scene = pairs.scene;
      std::vector<RigidMotion> motions;
      for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        Pose start = random_pose(random, 1.0);
        if (i % 2 == 0) start.position[0] += 9.0;
        motions.push_back(RigidMotion::between(start, random_pose(random, 0.5)));
      }
      ImpactResult one;
      ImpactResult two;
      ASSERT_EQ(time_of_impact(scene.pool, {scene.shapes, motions}, scene.pairs, {}, one),
                Status::ok);
      ASSERT_EQ(time_of_impact(scene.pool, {pairs.known, motions}, scene.pairs, {}, two),
                Status::ok);
      for (std::size_t i = 0; i < one.size(); ++i) {
        SCOPED_TRACE(std::string(same.name) + " " + to_string(kind) + " " + std::to_string(i));
        ASSERT_EQ(one.hits(i), two.hits(i));
        if (one.hits(i)) {
          EXPECT_NEAR(one.time()[i], two.time()[i], 2e-5);
        }
      }
    }
  }
}

/// Adds a floor that is a mesh, a height field or a compound.
ShapeId add_floor(CompositePool& pool, ShapePool& shapes, int which) {
  ShapeId id;
  if (which == 0) {
    const std::vector<Vec3d> corners{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0.2}, {-4, 4, 0}};
    const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};
    id = expect_ok(pool.add_mesh(std::span(corners), std::span(triangles)));
  } else if (which == 1) {
    const std::vector<float> heights{0, 0.1F, 0, 0.2F, 0, 0, 0, 0, 0.1F};
    id = expect_ok(pool.add_height_field({heights, 3, 3, 0, {4.0, 4.0}}));
  } else {
    ShapeId box = expect_ok(shapes.add(BoxShape{{4, 4, 0.5}}));
    const CompoundChild children[1] = {{box, Pose::at(0, 0, -0.5)}};
    id = expect_ok(pool.add_compound(children));
  }
  return id;
}

/// Returns the least distance of each body from the floor, whose data is 0.
std::map<ClientData, double> depths_of(const Contacts& contacts) {
  std::map<ClientData, double> least;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    // The kinds of the two shapes decide which body is a.
    if (contacts.data_a()[i] != 0 && contacts.data_b()[i] != 0) continue;
    const ClientData body = contacts.data_a()[i] + contacts.data_b()[i];
    for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
      const double distance = contacts.distance()[m];
      least[body] = least.contains(body) ? std::min(least[body], distance) : distance;
    }
  }
  return least;
}

TEST(SupportShapes, contacts_with_composites_match_equal_shapes) {
  for (int which = 0; which < 3; ++which) {
    ShapePool shapes;
    CompositePool composites(shapes);
    const ShapeId floor = add_floor(composites, shapes, which);
    const BoxShape block{{0.5, 0.4, 0.3}};
    ShapeId ids[2][3];
    ids[0][0] = expect_ok(shapes.add(EllipsoidShape{{0.3, 0.3, 0.3}}));
    ids[1][0] = expect_ok(shapes.add(SphereShape{0.3}));
    ids[0][1] = expect_ok(shapes.add(TaperedCapsuleShape{{0.3, 0.3}, 0.5}));
    ids[1][1] = expect_ok(shapes.add(CapsuleShape{0.3, 0.5}));
    ids[0][2] = expect_ok(shapes.add(SupportShape{farthest_of_block, &block, 1.0, 0.0}));
    ids[1][2] = expect_ok(shapes.add(block));
    Contacts contacts[2];
    for (std::size_t way = 0; way < 2; ++way) {
      Scene scene(shapes, {.contact_margin = 0.05, .composites = &composites});
      Key key = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
      for (std::size_t i = 0; i < 12; ++i) {
        const double x = 0.3 * static_cast<double>(i);
        const Pose pose = Pose::at(x - 1.0, 1.3 * static_cast<double>(i % 3) + 0.11, 0.28);
        key = expect_ok(scene.add({.shape = ids[way][i % 3], .pose = pose, .data = i + 1}));
      }
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts[way]), Status::ok);
    }
    const auto one = depths_of(contacts[0]);
    const auto two = depths_of(contacts[1]);
    ASSERT_EQ(one.size(), two.size());
    for (const auto& [body, distance] : one) {
      ASSERT_TRUE(two.contains(body)) << which << " " << body;
      EXPECT_NEAR(distance, two.at(body), 1e-9) << which << " " << body;
    }
  }
}

TEST(SupportShapes, user_shape_ends_recording) {
  std::vector<std::byte> bytes;
  const RecordingSink sink{[](void* context, std::span<const std::byte> more) {
                             auto& all = *static_cast<std::vector<std::byte>*>(context);
                             all.insert(all.end(), more.begin(), more.end());
                             return true;
                           },
                           &bytes};
  Recorder recorder(sink);
  ShapePool shapes;
  FaultyShape faulty;
  ShapeId id = expect_ok(shapes.add(SupportShape{farthest_of_faulty, &faulty, 2.0, 0.0}));
  Scene scene(shapes, {.recorder = &recorder});
  expect_ok(scene.add({.shape = id}));
  EXPECT_EQ(recorder.status(), Status::unsupported);
}

}  // namespace
}  // namespace winnow::test
