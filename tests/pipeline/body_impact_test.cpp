// Times of impact of composite bodies, compared with the least distance over all pairs of their
// primitives.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/impacts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/numbers/rotation.h"
#include "pipeline/motion/relative_motion_bounds.h"
#include "pipeline/solver/solver.h"
#include "tests/pipeline/motion_reference.h"
#include "tests/support/answers.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

constexpr double kTolerance = 1e-6;

/// A convex primitive in the frame of its body.
struct ReferencePart {
  ShapeId shape;
  Pose pose;
};

/// A shape of the library and the list of its convex primitives.
struct ReferenceShape {
  ShapeId shape;
  std::vector<ReferencePart> parts;
  double radius = 0.0;
};

/// Small shapes of all kinds with their primitives.
class ReferenceShapes {
 public:
  ReferenceShapes() {
    for (const MeshData& mesh : {torus(5, 4), gear(4), degenerate_soup(12, 3)}) {
      add_mesh(mesh, {1.0, 1.0, 1.0});
      add_mesh(mesh, {-0.5, 1.0, 2.0});
    }
    add_field();
    add_compound();
    add_compound_of_surfaces();
    composite_count = shapes.size();
    add_convex();
  }

  ShapePool pool;
  CompositePool composites{pool};
  std::vector<ReferenceShape> shapes;
  /// Number of composite shapes, which come first in `shapes`.
  std::size_t composite_count = 0;

 private:
  template <typename Shape>
  ShapeId added(const Shape& shape) {
    ShapeId id = expect_ok(pool.add(shape));
    return id;
  }
  void put(ShapeId id, std::vector<ReferencePart> parts) {
    const SubShapeQuery traversal(pool, &composites);
    shapes.push_back({id, std::move(parts), traversal.radius(id)});
  }
  void add_mesh(const MeshData& mesh, const Vec3d& scale) {
    ShapeId id;
    ShapeId scaled;
    id = expect_ok(composites.add_mesh(mesh.points(), mesh.indices()));
    scaled = expect_ok(composites.add_scaled(id, scale));
    std::vector<ReferencePart> parts;
    for (std::size_t i = 0; i < mesh.triangles(); ++i) {
      TriangleShape triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f& corner = mesh.vertices[mesh.corners[3 * i + k]];
        for (int x = 0; x < 3; ++x) {
          triangle.vertex[k][x] = scale[static_cast<std::size_t>(x)] * corner[x];
        }
      }
      parts.push_back({added(triangle), {}});
    }
    put(scaled, std::move(parts));
  }
  void add_field() {
    const float heights[] = {0, 0.5F, 0, 1, 0.2F, 0, 0.7F, 0, 0, 1, 0.1F, 0.4F, 0, 0, 0.3F, 0};
    ShapeId id;
    const HeightSamples samples{.heights = heights, .columns = 4, .rows = 4};
    id = expect_ok(composites.add_height_field(samples));
    const HeightField& field = *composites.height_field(id);
    std::vector<ReferencePart> parts;
    for (std::uint32_t i = 0; i < field.triangles(); ++i) {
      TriangleShape triangle;
      if (field.triangle(i, triangle)) parts.push_back({added(triangle), {}});
    }
    put(id, std::move(parts));
  }
  void add_compound() {
    const auto at = [](double x, double y, double z, double w) {
      Pose pose = Pose::at(x, y, z);
      pose.orientation[0] = w;
      pose.orientation[2] = 1.0;
      return pose;
    };
    const std::vector<CompoundChild> children{
        {added(BoxShape{{1, 0.1, 0.05}}), at(0, 0, 0, 3)},
        {added(SphereShape{0.3}), at(1.2, 0, 0, 1)},
        {added(CylinderShape{0.3, 0.2}), at(-1, 0.5, 0.3, -2)},
        {added(ConeShape{0.2, 0.4}), at(0, -0.7, 0.9, 0.5)},
        {added(TriangleShape{{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), at(0.5, 0.5, 0.5, 1)}};
    ShapeId id = expect_ok(composites.add_compound(children));
    std::vector<ReferencePart> parts;
    for (const CompoundChild& child : children) parts.push_back({child.shape, child.pose});
    put(id, std::move(parts));
  }
  /// Adds a compound of a mesh, a ball and the height field.
  void add_compound_of_surfaces() {
    const ReferenceShape& mesh = shapes[0];
    const ReferenceShape& field = shapes[shapes.size() - 2];
    Pose poses[3] = {Pose::at(0.3, -0.2, 0.1), Pose::at(-0.8, 0, 0), Pose::at(0, 0.5, -1)};
    poses[0].orientation[1] = 0.6;
    poses[2].orientation[3] = -0.4;
    const ShapeId ball = added(SphereShape{0.3});
    const CompoundChild children[] = {
        {mesh.shape, poses[0]}, {ball, poses[1]}, {field.shape, poses[2]}};
    ShapeId id = expect_ok(composites.add_compound(children));
    std::vector<ReferencePart> parts;
    for (const ReferencePart& part : mesh.parts) parts.push_back({part.shape, poses[0]});
    parts.push_back({ball, poses[1]});
    for (const ReferencePart& part : field.parts) parts.push_back({part.shape, poses[2]});
    put(id, std::move(parts));
  }
  void add_convex() {
    const ShapeId convex[] = {added(SphereShape{0.2}),
                              added(CapsuleShape{0.05, 0.6}),
                              added(BoxShape{{0.4, 0.01, 0.3}}),
                              added(CylinderShape{0.3, 0.2}),
                              added(ConeShape{0.2, 0.4}),
                              added(SphereShape{0.0}),
                              added(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}}}),
                              added(HalfSpaceShape{{0, 0.6, 0.8}, 0.1})};
    for (const ShapeId id : convex) put(id, {{id, {}}});
  }
};

/// Two moving bodies.
struct MovingReference {
  const ReferenceShapes& all;
  const ReferenceShape* shape[2];
  RigidMotion motion[2];

  [[nodiscard]] DistanceAt distance(double time) const {
    Pose body[2];
    for (int k = 0; k < 2; ++k) body[k] = place_at(motion[k], time, motion[0].start.position);
    DistanceAt least{std::numeric_limits<double>::infinity(), 0.0};
    SolverCounts counts;
    for (const ReferencePart& a : shape[0]->parts) {
      for (const ReferencePart& b : shape[1]->parts) {
        const PairAnswer answer =
            solve_pair(all.pool.tables(), a.shape, placed(body[0], a.pose), b.shape,
                       placed(body[1], b.pose), ContactLevel::distance, 0.0, counts);
        if (answer.distance < least.distance) least = {answer.distance, answer.error_bound};
      }
    }
    return least;
  }
  [[nodiscard]] double speed() const {
    double square[2] = {0.0, 0.0};
    for (int i = 0; i < 3; ++i) {
      const double from = motion[1].start.position[i] - motion[0].start.position[i];
      const double travel = motion[1].travel[i] - motion[0].travel[i];
      square[0] += travel * travel;
      square[1] += from * from;
    }
    const double apart = std::sqrt(square[1]) + std::sqrt(square[0]);
    double sum = std::sqrt(square[0]);
    for (int k = 0; k < 2; ++k) {
      const double* const turn = motion[k].turn.data();
      const double own = shape[k]->radius;
      sum += std::hypot(turn[0], turn[1], turn[2]) *
             (std::isfinite(own) ? own : apart + shape[1 - k]->radius);
    }
    return sum * (1.0 + 1e-12);
  }
  [[nodiscard]] double size() const {
    return std::isfinite(shape[1]->radius) ? std::max(shape[0]->radius, shape[1]->radius)
                                           : shape[0]->radius;
  }

  [[nodiscard]] static Pose placed(const Pose& body, const Pose& part) {
    const Quaternion turn = normalized(scale_to_unit_max(body.orientation));
    const Eigen::Matrix3d axes = rotation_of_unit(turn);
    const Quaternion q = turn * normalized(scale_to_unit_max(part.orientation));
    const Eigen::Vector3d at = axes * as_eigen(part.position);
    Pose pose;
    for (int i = 0; i < 3; ++i) pose.position[i] = body.position[i] + at[i];
    pose.orientation = q;
    return pose;
  }
};

void make_motion(Random& random, double size, double most_turn, RigidMotion& motion) {
  for (int i = 0; i < 3; ++i) {
    motion.start.position[i] = random.uniform(-size, size);
    motion.travel[i] = size * random.uniform(-2, 2);
    motion.turn[i] = random.uniform(-1, 1) * most_turn;
  }
  for (double& q : motion.start.orientation) q = random.uniform(-1, 1);
  if (random.chance(0.2)) motion.travel = {};
  if (random.chance(0.3)) motion.turn = {};
  if (random.chance(0.2)) motion.turn[random.below(3)] *= 20.0;
}

/// Returns motions that bring the bodies near each other at some time.
MovingReference moving_reference(const ReferenceShapes& all, const ReferenceShape& a,
                                 const ReferenceShape& b, Random& random) {
  MovingReference reference{all, {&a, &b}, {}};
  for (RigidMotion& motion : reference.motion) {
    make_motion(random, std::min(reference.size(), 5.0), 3.0, motion);
  }
  if (random.chance(0.4)) std::swap(reference.shape[0], reference.shape[1]);
  if (random.chance(0.1)) {
    for (RigidMotion& motion : reference.motion) motion.start.position[0] += 1e7;
  }
  return reference;
}

struct SingleImpact {
  ImpactResult result;

  explicit SingleImpact(const MovingReference& reference) {
    const ShapeId shapes[2] = {reference.shape[0]->shape, reference.shape[1]->shape};
    constexpr BodyPair kPair[1] = {{0, 1}};
    const ImpactOptions options{.tolerance = kTolerance, .composites = &reference.all.composites};
    EXPECT_EQ(
        time_of_impact(reference.all.pool, {shapes, reference.motion}, kPair, options, result),
        Status::ok);
    EXPECT_EQ(result.status(0), Status::ok);
  }
};

void check(const MovingReference& reference, std::size_t max_samples, std::size_t& unproved,
           std::size_t& hits) {
  const SingleImpact single(reference);
  const ImpactResult& found = single.result;
  const double time = found.time()[0];
  const double doubt = 1e-8 * std::min(reference.size(), 10.0);
  const Before then = before([&](double at) { return reference.distance(at); }, reference.speed(),
                             doubt, time, max_samples);
  EXPECT_NE(then, Before::overlapping);
  unproved += then == Before::apart ? 0 : 1;
  if (!found.hits(0)) return;
  ++hits;
  const DistanceAt at = reference.distance(time);
  EXPECT_NEAR(at.distance, found.gap()[0], at.error + found.error_bound()[0] + doubt);
  EXPECT_LE(at.distance, kTolerance * reference.size() + doubt);
  const auto& of_a = reference.shape[0]->parts;
  const auto& of_b = reference.shape[1]->parts;
  EXPECT_EQ(found.part_a()[0] == kWholeShape, of_a.size() == 1);
  EXPECT_EQ(found.part_b()[0] == kWholeShape, of_b.size() == 1);
}

TEST(BodyImpact, composite_with_convex_is_never_late) {
  const ReferenceShapes all;
  Random random(81);
  std::size_t unproved = 0;
  std::size_t hits = 0;
  const std::size_t count = scaled(240);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t composite = random.below(all.composite_count);
    const std::size_t other =
        all.composite_count + random.below(all.shapes.size() - all.composite_count);
    SCOPED_TRACE(testing::Message() << n << ": " << composite << " " << other);
    const MovingReference reference =
        moving_reference(all, all.shapes[composite], all.shapes[other], random);
    check(reference, 200, unproved, hits);
  }
  EXPECT_LE(unproved, count / 4);
  EXPECT_GE(hits, count / 12);
}

TEST(BodyImpact, composite_with_composite_is_never_late) {
  const ReferenceShapes all;
  Random random(82);
  std::size_t unproved = 0;
  std::size_t hits = 0;
  const std::size_t count = scaled(40);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t a = random.below(all.composite_count);
    const std::size_t b = random.below(all.composite_count);
    SCOPED_TRACE(testing::Message() << n << ": " << a << " " << b);
    check(moving_reference(all, all.shapes[a], all.shapes[b], random), 30, unproved, hits);
  }
  EXPECT_GE(hits, count / 12);
}

TEST(BodyImpact, overlapping_parts_hit_at_zero_with_deepest_part) {
  ShapePool pool;
  CompositePool composites(pool);
  ShapeId ball;
  ShapeId compound;
  ball = expect_ok(pool.add(SphereShape{1.0}));
  const CompoundChild children[3] = {
      {ball, Pose::at(-3, 0, 0)}, {ball, Pose::at(0, 0, 0)}, {ball, Pose::at(1, 0, 0)}};
  compound = expect_ok(composites.add_compound(children));
  const ShapeId shapes[2] = {compound, ball};
  const RigidMotion motions[2] = {RigidMotion::stationary(Pose::at(0, 0, 0)),
                                  {Pose::at(2.5, 0, 0), {1, 0, 0}, {0, 0, 3}}};
  constexpr BodyPair kPairs[2] = {{0, 1}, {1, 0}};
  ImpactResult found;
  ASSERT_EQ(time_of_impact(pool, {shapes, motions}, kPairs, {.composites = &composites}, found),
            Status::ok);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(found.hits(i));
    EXPECT_EQ(found.time()[i], 0.0);
    EXPECT_NEAR(found.gap()[i], -0.5, 1e-12);
    EXPECT_NEAR(found.normal(0)[i], i == 0 ? 1.0 : -1.0, 1e-12);
    EXPECT_NEAR(found.point(0)[i], i == 0 ? 2.0 : -1.0, 1e-12);
  }
  EXPECT_EQ(found.part_a()[0], 2U);
  EXPECT_EQ(found.part_b()[1], 2U);
}

// Aims a point at a vertex that six triangles share, and at points of an edge.
TEST(BodyImpact, point_at_shared_edge_or_vertex_hits_mesh) {
  ShapePool pool;
  CompositePool composites(pool);
  const MeshData hills = terrain(6);
  ShapeId mesh;
  ShapeId point;
  mesh = expect_ok(composites.add_mesh(hills.points(), hills.indices()));
  point = expect_ok(pool.add(SphereShape{0.0}));
  const ShapeId shapes[2] = {mesh, point};
  constexpr BodyPair kPair[1] = {{0, 1}};
  Random random(83);
  for (std::size_t n = scaled(300); n-- != 0;) {
    RigidMotion of_mesh;
    make_motion(random, 1.0, 1.0, of_mesh);
    const Eigen::Vector3f corner[2] = {hills.vertices[3 * 7 + 3], hills.vertices[3 * 7 + 4]};
    const double share = random.chance(0.5) ? 0.0 : random.unit();
    const Eigen::Vector3d target =
        corner[0].cast<double>() * (1.0 - share) + corner[1].cast<double>() * share;
    const Pose there =
        MovingReference::placed(of_mesh.at(0.5), Pose::at(target[0], target[1], target[2]));
    RigidMotion of_point;
    for (int i = 0; i < 3; ++i) {
      of_point.travel[i] = random.uniform(-5, 5);
      of_point.start.position[i] = there.position[i] - 0.5 * of_point.travel[i];
    }
    const RigidMotion motions[2] = {of_mesh, of_point};
    ImpactResult found;
    ASSERT_EQ(time_of_impact(pool, {shapes, motions}, kPair, {.composites = &composites}, found),
              Status::ok);
    EXPECT_TRUE(found.hits(0));
    EXPECT_LE(found.time()[0], 0.5 + 1e-12);
  }
}

TEST(BodyImpact, moving_boxes_contain_whole_motion) {
  const ReferenceShapes all;
  const SubShapeQuery parts(all.pool, &all.composites);
  Random random(84);
  for (std::size_t n = scaled(400); n-- != 0;) {
    const ReferenceShape& shape = all.shapes[random.below(all.shapes.size() - 1)];
    RigidMotion frame;
    RigidMotion motion;
    make_motion(random, 3.0, 3.0, frame);
    make_motion(random, 3.0, 3.0, motion);
    // Either the whole shape, or one primitive far from the position of its body.
    std::vector<ReferencePart> shown = shape.parts;
    if (shown.size() > 1 && random.chance(0.5)) {
      shown = {shape.parts[random.below(shape.parts.size())]};
      for (double& x : shown[0].pose.position) x = random.uniform(-20, 20);
    }
    const impact::MovingShape moving =
        shown.size() == shape.parts.size()
            ? impact::whole_shape(parts, shape.shape, motion)
            : impact::moving_part(parts, {shown[0].shape, shown[0].pose, 0}, motion);
    const impact::RelativeMotionBounds passage(parts, frame, moving);
    const double first = random.unit();
    const double last = random.uniform(first, 1.0);
    const mid::Box3 all_time = passage.box({first, last});
    const MovingBox moving_box = passage.moving_box({first, last});
    for (double t = 0.0; t <= 1.0; t += 0.125) {
      const double time = first + t * (last - first);
      const Pose at = frame.at(time);
      Pose inverse;
      for (std::size_t i = 1; i < 4; ++i) inverse.orientation[i] = -at.orientation[i];
      inverse.orientation[0] = at.orientation[0];
      Pose seen = motion.at(time);
      for (int i = 0; i < 3; ++i) seen.position[i] -= at.position[i];
      const Pose there = MovingReference::placed(inverse, seen);
      const double share = moving_box.max_t * t;
      for (const ReferencePart& part : shown) {
        const Pose placed = MovingReference::placed(there, part.pose);
        const mid::Box3 box = parts.box(PlacedShape{part.shape, placed});
        for (int i = 0; i < 3; ++i) {
          // The pool stores bounds of shapes as floats.
          const double slack = 1e-6 * (1.0 + std::abs(box.max[i] - box.min[i]));
          EXPECT_LE(all_time.min[i], box.min[i] + slack);
          EXPECT_GE(all_time.max[i], box.max[i] - slack);
          EXPECT_LE(moving_box.min[i] + share * moving_box.direction[i], box.min[i] + slack);
          EXPECT_GE(moving_box.max[i] + share * moving_box.direction[i], box.max[i] - slack);
        }
      }
    }
  }
}

TEST(BodyImpact, results_match_on_threads_and_bad_pairs_fail) {
  const ReferenceShapes all;
  Random random(85);
  std::vector<ShapeId> shapes;
  std::vector<RigidMotion> motions;
  std::vector<BodyPair> pairs;
  for (std::size_t n = 0; n < 200; ++n) {
    const ReferenceShape& a = all.shapes[random.below(all.composite_count)];
    const ReferenceShape& b = all.shapes[random.below(all.shapes.size() - 1)];
    const MovingReference reference = moving_reference(all, a, b, random);
    for (int k = 0; k < 2; ++k) {
      shapes.push_back(reference.shape[k]->shape);
      motions.push_back(reference.motion[k]);
    }
    const auto first = static_cast<std::uint32_t>(2 * n);
    pairs.push_back({first, first + 1});
  }
  ImpactResult serial;
  ImpactResult parallel;
  ImpactOptions options{.composites = &all.composites};
  ASSERT_EQ(time_of_impact(all.pool, {shapes, motions}, pairs, options, serial), Status::ok);
  options.execution = Execution::parallel();
  ASSERT_EQ(time_of_impact(all.pool, {shapes, motions}, pairs, options, parallel), Status::ok);
  EXPECT_TRUE(std::ranges::equal(serial.time(), parallel.time()));
  EXPECT_TRUE(std::ranges::equal(serial.gap(), parallel.gap()));
  EXPECT_TRUE(std::ranges::equal(serial.part_a(), parallel.part_a()));
  EXPECT_TRUE(std::ranges::equal(serial.part_b(), parallel.part_b()));
  shapes[0] = ShapeId::of(CompositeKind::mesh, 1000);
  motions[3].travel[0] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(time_of_impact(all.pool, {shapes, motions}, pairs, options, serial), Status::ok);
  EXPECT_EQ(serial.status(0), Status::invalid_key);
  EXPECT_EQ(serial.status(1), Status::invalid_pose);
  EXPECT_EQ(serial.status(2), Status::ok);
}

}  // namespace
}  // namespace winnow::test
