// Contact regions (CompositePool::reduce_contacts, SceneOptions::part_manifolds) compared with
// the raw manifolds of all primitives, and with one large box.

#include "pipeline/composites/composites.h"
#include "pipeline/solver/manifold.h"
#include "pipeline/solver/problem.h"
#include "tests/pipeline/composite_world.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/pipeline/scene.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

using Vec = Eigen::Vector3d;

[[nodiscard]] Vec position(const ContactPoint& point) {
  return as_eigen(point.position).cast<double>();
}

/// A scene with one body and one floor.
struct Floor {
  Floor(const ShapePool& shapes, const CompositePool& pool, ShapeId floor, ShapeId body,
        double margin, bool reduced)
      : scene(shapes, {.execution = Execution::serial(),
                       .contact_margin = margin,
                       .part_manifolds = !reduced,
                       .composites = &pool}) {
    ground = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
    key = expect_ok(scene.add({.shape = body}));
  }

  void move_body(const Pose& pose) {
    ASSERT_EQ(scene.move(key, pose), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  }
  /// Returns the points of manifold m.
  [[nodiscard]] std::vector<ContactPoint> points(std::size_t m) const {
    std::vector<ContactPoint> all;
    for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
      all.push_back(contacts.contact(p));
    }
    return all;
  }
  [[nodiscard]] Vec normal(std::size_t m) const {
    return {contacts.normal(0)[m], contacts.normal(1)[m], contacts.normal(2)[m]};
  }

  Scene scene;
  Key ground;
  Key key;
  Contacts contacts;
};

/// Floors with the surface z = 0 over [-4, 4] x [-4, 4]. The first is one large box.
struct Floors {
  Floors() : pool(shapes) {
    body = add(shapes, BoxShape{{0.5, 0.4, 0.3}, 0.0});
    large = add(shapes, BoxShape{{4.0, 4.0, 4.0}, 0.0});
    const CompoundChild one[] = {{large, Pose::at(0, 0, -4)}};
    ids.emplace_back();
    ids.back() = expect_ok(pool.add_compound(one));
    Random random(3);
    Surface uneven = grid(16, 0.5F, Cut::random, [](float, float) { return 0.0F; });
    for (Point& v : uneven.vertices) {
      if (std::abs(v.x()) > 3.9F || std::abs(v.y()) > 3.9F) continue;
      for (int k = 0; k < 2; ++k) v[k] += static_cast<float>(random.uniform(-0.12, 0.12));
    }
    ids.push_back(add(pool, uneven));
    ids.push_back(add(pool, grid(3, 2.7F, Cut::alternating, [](float, float) { return 0.0F; })));
    add_field();
    add_tiles();
  }

  void add_field() {
    const std::vector<float> heights(41 * 41, 0.0F);
    ShapeId field = expect_ok(pool.add_height_field({heights, 41, 41, 0, {0.2, 0.2}}));
    // The origin of a height field is its corner; the origins of the other floors are their
    // centres.
    ids.push_back(field);
    field_at = ids.size() - 1;
  }

  void add_tiles() {
    const ShapeId tile = add(shapes, BoxShape{{0.4, 0.5, 0.2}, 0.0});
    std::vector<CompoundChild> tiles;
    for (int x = 0; x < 10; ++x) {
      for (int y = 0; y < 8; ++y) {
        tiles.push_back({tile, Pose::at(0.8 * x - 3.6, 1.0 * y - 3.5, -0.2)});
      }
    }
    ids.emplace_back();
    ids.back() = expect_ok(pool.add_compound(tiles));
  }

  /// Returns the pose on floor i that corresponds to `pose` on the other floors.
  [[nodiscard]] Pose on(std::size_t i, Pose pose) const {
    for (int k = 0; k < 2 && i == field_at; ++k) pose.position[k] += 4.0;
    return pose;
  }

  ShapePool shapes;
  CompositePool pool;
  ShapeId body;
  ShapeId large;
  /// The first floor is the large box.
  std::vector<ShapeId> ids;
  std::size_t field_at = 0;
};

/// Returns the pose of a box with half extents (0.5, 0.4, 0.3) that rests on one of its faces, in a
/// random direction, tilted by `tilt`, its deepest corner `depth` below z = 0.
[[nodiscard]] Pose resting(Random& random, double tilt, double depth) {
  const double angle = random.uniform(-4.0, 4.0);
  const double about = random.uniform(-4.0, 4.0);
  Eigen::Quaterniond q(Eigen::AngleAxisd(tilt, Vec(std::cos(about), std::sin(about), 0.0)) *
                       Eigen::AngleAxisd(angle, Vec::UnitZ()));
  const int face = static_cast<int>(random.below(3));
  if (face != 0) q = q * Eigen::AngleAxisd(1.5707963267948966, Vec::Unit(face - 1));
  const Eigen::Matrix3d axes = q.toRotationMatrix();
  const double reach = axes.row(2).cwiseAbs().dot(Vec(0.5, 0.4, 0.3).transpose());
  Pose pose = Pose::at(random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5), reach - depth);
  pose.orientation[0] = q.w();
  for (int k = 0; k < 3; ++k) pose.orientation[k + 1] = q.vec()[k];
  return pose;
}

/// Diagonal of the largest face of the box in `resting`. Depths count as tied if they differ by at
/// most kTiedDepth times this length.
constexpr double kFaceExtent = 1.3;

/// Checks that each point of `a` is, within the tolerance, exactly one point of `b` with the same
/// depth.
void expect_same_points(const std::vector<ContactPoint>& a, const std::vector<ContactPoint>& b,
                        double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (const ContactPoint& p : a) {
    const auto same = [&](const ContactPoint& q) {
      return (position(p) - position(q)).norm() <= tolerance &&
             std::abs(p.depth - q.depth) <= tolerance + kTiedDepth * kFaceExtent;
    };
    EXPECT_EQ(std::count_if(b.begin(), b.end(), same), 1)
        << position(p).transpose() << " depth " << p.depth;
  }
}

TEST(ContactReduction, box_on_any_flat_floor_matches_large_box) {
  const Floors floors;
  constexpr double kMargin = 0.05;
  std::vector<std::unique_ptr<Floor>> scenes;
  for (const ShapeId floor : floors.ids) {
    scenes.push_back(
        std::make_unique<Floor>(floors.shapes, floors.pool, floor, floors.body, kMargin, true));
  }
  const std::size_t tiles = floors.ids.size() - 1;
  Random random(5);
  for (std::size_t round = 0; round < scaled(1000); ++round) {
    const double tilt = random.chance(0.2) ? 0.0 : std::pow(10.0, random.uniform(-9.0, -1.8));
    const double depth = random.uniform(-0.02, 0.005);
    const Pose pose = resting(random, tilt, depth);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      scenes[i]->move_body(floors.on(i, pose));
      SCOPED_TRACE("round " + std::to_string(round) + ", floor " + std::to_string(i));
      ASSERT_EQ(scenes[i]->contacts.manifolds(), 1U);
      EXPECT_NEAR(scenes[i]->contacts.distance()[0], scenes[0]->contacts.distance()[0], 1e-6);
      EXPECT_LE((scenes[i]->normal(0) - Vec(0, 0, -1)).norm(), 10.0 * tilt + 1e-6);
      ASSERT_EQ(scenes[i]->points(0).size(), 4U);
      // The midpoint between two faces may be measured along the normal of either face, or, if the
      // faces are apart, along an edge normal.
      double tolerance = 3e-6 + kMargin * tilt + 0.1 * std::max(0.0, -depth);
      // Over a tile, a box that is nearer to the side of the tile than to its top has no contact.
      if (i == tiles) tolerance += std::max(0.0, depth);
      expect_same_points(scenes[0]->points(0), scenes[i]->points(0), tolerance);
    }
  }
}

/// Pairs of bodies of all kinds, the answers for their primitives, and the regions made of them.
struct Reduced {
  Reduced(std::size_t count, double margin, std::uint64_t seed,
          std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : margin_(margin), pairs(memory), answers(memory), regions(memory) {
    Random random(seed);
    world.add_shapes(random);
    const double at[3] = {300.0, -20.0, 7.0};
    world.add_pairs(random, count, 0.8, at);
    solve(Execution::serial());
  }

  void solve(const Execution& execution) {
    ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                        margin_, execution, pairs),
              Status::ok);
    answer(world.shapes, pairs,
           {.level = ContactLevel::manifold, .contact_margin = margin_, .execution = execution},
           answers);
    EXPECT_EQ(
        mid::correct_surface_contacts({world.composites, world.shapes, world.bodies(), world.pairs},
                                      pairs, margin_, execution, answers),
        Status::ok);
    ASSERT_EQ(reduce_contacts(execution), Status::ok);
  }
  [[nodiscard]] Status reduce_contacts(const Execution& execution) {
    return mid::reduce_contacts(world.shapes, pairs, answers, margin_, execution, regions);
  }

  [[nodiscard]] Vec normal(std::size_t i) const {
    return {answers.normal(0)[i], answers.normal(1)[i], answers.normal(2)[i]};
  }
  /// Returns a contact in the frame that regions use.
  [[nodiscard]] ContactPoint moved(std::size_t i, ContactPoint contact) const {
    const Vec3d& from = pairs.poses[pairs.pairs[answers.pair_of(i)].a].position;
    for (int k = 0; k < 3; ++k) contact.position[k] += static_cast<float>(from[k]);
    return contact;
  }
  /// Returns all contacts of an answer, and all corners of the area that its two primitives share.
  [[nodiscard]] std::vector<ContactPoint> all_points(std::size_t i) const {
    std::vector<ContactPoint> points;
    const std::uint32_t first = answers.contact_first()[i];
    for (std::uint32_t k = 0; k < answers.contact_count()[i]; ++k) {
      points.push_back(moved(i, answers.contact(first + k)));
    }
    const BodyPair& of = pairs.pairs[answers.pair_of(i)];
    solver::Problem problem;
    solver::prepare(pairs.tables(world.shapes), pairs.shapes[of.a], pairs.poses[of.a],
                    pairs.shapes[of.b], pairs.poses[of.b], false, problem);
    ContactPoint corners[kMaxIntersectionCorners];
    const std::uint32_t count = solver::intersection_corners(problem, normal(i), 8.0, corners);
    const auto unit = static_cast<float>(std::ldexp(1.0, problem.exponent));
    for (ContactPoint& corner : std::span(corners, count)) {
      for (float& x : corner.position) x *= unit;
      corner.depth *= unit;
      points.push_back(moved(i, corner));
    }
    return points;
  }
  /// Returns for each pair of bodies its touching answers, in the order of primitive pairs.
  [[nodiscard]] std::vector<std::vector<std::size_t>> members() const {
    std::vector<std::size_t> slot(answers.size());
    for (std::size_t i = 0; i < answers.size(); ++i) slot[answers.pair_of(i)] = i;
    std::vector<std::vector<std::size_t>> all(world.pairs.size());
    for (std::size_t pair = 0; pair < all.size(); ++pair) {
      for (std::uint32_t p = pairs.first[pair]; p < pairs.first[pair + 1]; ++p) {
        if (answers.distance()[slot[p]] <= margin_) all[pair].push_back(slot[p]);
      }
    }
    return all;
  }

 private:
  double margin_;

 public:
  CompositeWorld world;
  PrimitivePairs pairs;
  NarrowResult answers;
  ContactRegions regions;
};

/// Checks that each point of a region is a point of one of `members` with nearly the same normal as
/// the region, and that the first point is the deepest. `members` are the touching primitive pairs
/// of the region's pair of bodies.
void expect_made_of(const Reduced& all, const ContactRegion& region,
                    const std::vector<std::size_t>& members) {
  const Vec normal = Eigen::Map<const Vec>(region.normal);
  std::vector<ContactPoint> points;
  for (const std::size_t i : members) {
    if (all.normal(i).dot(normal) < kRegionCosine) continue;
    const auto more = all.all_points(i);
    points.insert(points.end(), more.begin(), more.end());
  }
  ASSERT_GE(region.count, 1U);
  ASSERT_LE(region.count, kManifoldPoints);
  double extent = 0.0;
  for (const ContactPoint& p : points) {
    extent = std::max(extent, (position(p) - position(points[0])).norm());
  }
  for (const ContactPoint& kept : std::span(region.point, region.count)) {
    // The first point has the largest depth of all, possibly of a different tied point.
    const double tied = &kept == region.point ? kTiedDepth * 2.0 * extent : 0.0;
    const auto is_it = [&](const ContactPoint& p) {
      return (position(p) - position(kept)).norm() <= 2e-6 &&
             std::abs(p.depth - kept.depth) <= 2e-5 + tied;
    };
    EXPECT_TRUE(std::any_of(points.begin(), points.end(), is_it));
    EXPECT_LE(kept.depth, region.point[0].depth) << "the first point must be the deepest";
  }
}

TEST(ContactReduction, regions_merge_parallel_manifolds_and_keep_deepest) {
  for (const double margin : {0.0, 0.1}) {
    const Reduced all(scaled(400), margin, 11);
    const auto members = all.members();
    ASSERT_EQ(all.regions.size(), members.size());
    std::size_t merged = 0;
    for (std::size_t pair = 0; pair < members.size(); ++pair) {
      const auto regions = all.regions.of(pair);
      ASSERT_LE(regions.size(), members[pair].size());
      ASSERT_EQ(regions.empty(), members[pair].empty());
      merged += members[pair].size() - regions.size();
      double deepest = 1e9;
      for (const std::size_t i : members[pair]) {
        deepest = std::min(deepest, all.answers.distance()[i]);
        const auto leads = [&](const ContactRegion& r) {
          return Eigen::Map<const Vec>(r.normal).dot(all.normal(i)) >= kRegionCosine - 1e-9;
        };
        EXPECT_TRUE(std::any_of(regions.begin(), regions.end(), leads))
            << "no region has this normal";
      }
      double found = 1e9;
      for (const ContactRegion& region : regions) {
        expect_made_of(all, region, members[pair]);
        found = std::min(found, region.distance);
      }
      EXPECT_EQ(found, deepest);
    }
    EXPECT_GT(merged, members.size());
  }
}

TEST(ContactReduction, region_normals_are_never_nearly_parallel) {
  const Reduced all(scaled(400), 0.05, 17);
  for (std::size_t pair = 0; pair < all.regions.size(); ++pair) {
    const auto regions = all.regions.of(pair);
    for (std::size_t i = 0; i < regions.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_LT(
            Eigen::Map<const Vec>(regions[i].normal).dot(Eigen::Map<const Vec>(regions[k].normal)),
            kRegionCosine);
      }
    }
  }
}

/// Returns how far the origin is inside the convex hull of the points in the plane, negative
/// outside: the least support distance over directions in the plane.
[[nodiscard]] double depth_in_hull(const std::vector<ContactPoint>& points, const Vec& normal) {
  Vec u = normal.unitOrthogonal();
  const Vec v = normal.cross(u);
  double least = 1e9;
  for (int k = 0; k < 90; ++k) {
    const double angle = 6.283185307179586 * k / 90;
    const Vec along = std::cos(angle) * u + std::sin(angle) * v;
    double reach = -1e9;
    for (const ContactPoint& p : points) reach = std::max(reach, along.dot(position(p)));
    least = std::min(least, reach);
  }
  return least;
}

TEST(ContactReduction, stable_raw_contacts_stay_stable_when_reduced) {
  const Floors floors;
  ShapePool& shapes = const_cast<ShapePool&>(floors.shapes);
  const ShapeId bodies[] = {add(shapes, CylinderShape{0.5, 0.3, 0.0}),
                            add(shapes, BoxShape{{0.6, 0.2, 0.3}, 0.0}),
                            add(shapes, ConeShape{0.6, 0.3, 0.0})};
  Random random(19);
  std::size_t tested = 0;
  for (const ShapeId body : bodies) {
    for (std::size_t i = 1; i + 1 < floors.ids.size(); ++i) {
      Floor raw(floors.shapes, floors.pool, floors.ids[i], body, 0.02, false);
      Floor reduced(floors.shapes, floors.pool, floors.ids[i], body, 0.02, true);
      for (std::size_t round = 0; round < scaled(300); ++round) {
        const double tilt = random.uniform(0.0, 0.03);
        const double turn = random.uniform(-4.0, 4.0);
        Pose pose = Pose::at(random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5),
                             random.uniform(0.285, 0.3));
        const Eigen::Quaterniond q(
            Eigen::AngleAxisd(tilt, Vec(std::cos(turn), std::sin(turn), 0.0)));
        pose.orientation[0] = q.w();
        for (int k = 0; k < 3; ++k) pose.orientation[k + 1] = q.vec()[k];
        raw.move_body(floors.on(i, pose));
        reduced.move_body(floors.on(i, pose));
        std::vector<ContactPoint> all;
        for (std::size_t m = 0; m < raw.contacts.manifolds(); ++m) {
          for (const ContactPoint& p : raw.points(m)) {
            if (p.depth >= 0.0F) all.push_back(p);
          }
        }
        ASSERT_EQ(reduced.contacts.manifolds(), 1U);
        // Skips poses in which the origin is less than 0.3 inside: reduction keeps four points of a
        // round face, and their hull is smaller than the face.
        if (all.empty() || depth_in_hull(all, Vec::UnitZ()) < 0.3) continue;
        ++tested;
        EXPECT_GT(depth_in_hull(reduced.points(0), Vec::UnitZ()), 0.0);
      }
    }
  }
  EXPECT_GT(tested, scaled(300));
}

/// Returns the sorted feature ids of all contact points.
[[nodiscard]] std::vector<std::uint64_t> features(const Floor& floor) {
  std::vector<std::uint64_t> all;
  for (std::size_t p = 0; p < floor.contacts.points(); ++p) {
    all.push_back(floor.contacts.contact(p).feature);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(ContactReduction, corners_keep_features_while_box_trembles_and_slides) {
  const Floors floors;
  Random random(23);
  for (std::size_t i = 1; i + 1 < floors.ids.size(); ++i) {
    Floor floor(floors.shapes, floors.pool, floors.ids[i], floors.body, 0.02, true);
    const Pose start = resting(random, 0.0, 0.004);
    std::vector<std::uint64_t> first;
    for (int frame = 0; frame < 100; ++frame) {
      Pose pose = start;
      // The box first trembles, then slides over many triangles.
      for (double& p : pose.position) p += random.uniform(-1e-7, 1e-7);
      if (frame > 50) pose.position[0] += 0.011 * (frame - 50);
      floor.move_body(floors.on(i, pose));
      ASSERT_EQ(floor.contacts.manifolds(), 1U);
      const auto now = features(floor);
      ASSERT_EQ(std::adjacent_find(now.begin(), now.end()), now.end()) << "duplicate feature";
      if (first.empty()) first = now;
      EXPECT_EQ(now, first) << "floor " << i << ", frame " << frame;
    }
  }
}

[[nodiscard]] std::vector<std::uint64_t> bits_of(const ContactRegions& regions) {
  std::vector<std::uint64_t> bits;
  for (std::size_t pair = 0; pair < regions.size(); ++pair) {
    for (const ContactRegion& r : regions.of(pair)) {
      for (const double x : {r.normal[0], r.normal[1], r.normal[2], r.distance, r.error_bound}) {
        bits.push_back(std::bit_cast<std::uint64_t>(x));
      }
      bits.push_back(std::uint64_t{r.part[0]} << 32U | r.part[1]);
      for (const ContactPoint& p : std::span(r.point, r.count)) {
        for (const float x : p.position) bits.push_back(std::bit_cast<std::uint32_t>(x));
        bits.push_back(std::bit_cast<std::uint32_t>(p.depth));
        bits.push_back(p.feature);
      }
    }
  }
  return bits;
}

TEST(ContactReduction, regions_match_on_any_threads_and_isa) {
  std::vector<std::uint64_t> first;
  for (const Isa isa : {available_isas().front(), available_isas().back()}) {
    const IsaScope scope(isa);
    for (const int threads : {1, 2, 8}) {
      Threads arena(threads);
      const std::vector<std::uint64_t> now = arena.run([&] {
        Reduced all(scaled(300), 0.05, 29);
        all.solve(threads == 1 ? Execution::serial() : Execution::parallel());
        return bits_of(all.regions);
      });
      if (first.empty()) first = now;
      EXPECT_TRUE(now == first) << isa_name() << ", " << threads << " threads";
    }
  }
}

TEST(ContactReduction, second_call_allocates_nothing_and_footprint_is_exact) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  {
    Reduced all(scaled(200), 0.05, 31);
    ContactRegions regions(&memory);
    const auto reduce_contacts = [&] {
      return mid::reduce_contacts(all.world.shapes, all.pairs, all.answers, 0.05,
                                  Execution::serial(), regions);
    };
    for (std::size_t granted = 0;; ++granted) {
      memory.refuse_after(granted);
      const Status status = reduce_contacts();
      memory.grant_all();
      if (status == Status::ok) break;
      ASSERT_EQ(status, Status::out_of_memory);
      EXPECT_EQ(regions.size(), 0U);
    }
    EXPECT_EQ(bits_of(regions), bits_of(all.regions));
    const std::size_t requests = memory.requests();
    ASSERT_EQ(reduce_contacts(), Status::ok);
    EXPECT_EQ(memory.requests(), requests);
    EXPECT_EQ(regions.footprint().total().reserved, memory.outstanding());
  }
  EXPECT_EQ(memory.outstanding(), 0U);
}

TEST(ContactReduction, steady_scene_with_meshes_allocates_nothing) {
  CountingMemory memory;
  CountingMemory results;
  {
    const Floors floors;
    Scene scene(floors.shapes,
                {.memory = &memory, .contact_margin = 0.02, .composites = &floors.pool});
    Contacts contacts(&results);
    expect_ok(scene.add({.shape = floors.ids[1], .state = BodyState::fixed}));
    Random random(37);
    std::vector<Key> keys(20);
    for (Key& body : keys) {
      body = expect_ok(scene.add({.shape = floors.body, .pose = resting(random, 0.01, 0.004)}));
    }
    for (int frame = 0; frame < 12; ++frame) {
      const std::size_t requests = memory.requests() + results.requests();
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      if (frame >= 4) {
        EXPECT_EQ(memory.requests() + results.requests(), requests);
      }
      EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
      EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
      EXPECT_LE(contacts.points(), kManifoldPoints * contacts.manifolds());
    }
  }
  EXPECT_EQ(memory.outstanding(), 0U);
}

TEST(ContactReduction, answers_without_contacts_are_refused) {
  Reduced all(10, 0.0, 41);
  answer(all.world.shapes, all.pairs, {.level = ContactLevel::distance}, all.answers);
  EXPECT_EQ(all.reduce_contacts(Execution::serial()), Status::invalid_argument);
  EXPECT_EQ(all.regions.size(), 0U);
}

}  // namespace
}  // namespace winnow::test
