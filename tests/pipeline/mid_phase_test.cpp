// Compares CompositePool::find_primitive_pairs, visit and visit_near with loops over all primitives
// of one or two bodies.

#include "tests/pipeline/composite_world.h"

#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <tuple>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

using Touch = std::tuple<std::size_t, std::uint32_t, std::uint32_t>;

/// Pairs every primitive of a with every primitive of b, for all pairs of bodies.
void list_all_pairs(const CompositeWorld& world, PrimitivePairs& out,
                    std::vector<std::size_t>& owner) {
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    const BodyPair& pair = world.pairs[i];
    std::vector<std::uint32_t> side[2];
    for (int s = 0; s < 2; ++s) {
      const std::uint32_t body = s == 0 ? pair.a : pair.b;
      for (const Primitive& part : parts_of(world, world.body[body], world.pose[body])) {
        side[s].push_back(static_cast<std::uint32_t>(out.shapes.size()));
        ShapeId shape = part.shape;
        if (shape.kind() == ShapeKind::triangle) {
          shape =
              ShapeId::of(ShapeKind::triangle, static_cast<std::uint32_t>(out.triangles.size()));
          ASSERT_TRUE(out.triangles.push_back(part.triangle));
        }
        Pose pose = part.pose;
        for (int axis = 0; axis < 3; ++axis) {
          pose.position[axis] -= world.pose[pair.a].position[axis];
        }
        ASSERT_TRUE(out.shapes.push_back(shape) && out.poses.push_back(pose) &&
                    out.part.push_back(part.part));
      }
    }
    for (const std::uint32_t a : side[0]) {
      for (const std::uint32_t b : side[1]) {
        ASSERT_TRUE(out.pairs.push_back({a, b}));
        owner.push_back(i);
      }
    }
  }
}

/// Returns the pairs of primitives no farther apart than `near`.
std::set<Touch> touching(const CompositeWorld& world, const PrimitivePairs& pairs,
                         const std::vector<std::size_t>& owner, double near) {
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(
      narrow.collide(
          pairs.tables(world.shapes),
          {{pairs.shapes.data(), pairs.shapes.size()}, {pairs.poses.data(), pairs.poses.size()}},
          {pairs.pairs.data(), pairs.pairs.size()}, {.level = ContactLevel::distance}, result),
      Status::ok);
  std::set<Touch> found;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!(result.distance()[i] <= near)) continue;
    const std::uint32_t at = result.pair_of(i);
    const BodyPair& pair = pairs.pairs[at];
    found.emplace(owner[at], pairs.part[pair.a], pairs.part[pair.b]);
  }
  return found;
}

std::vector<std::size_t> owners(const PrimitivePairs& pairs) {
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i + 1 < pairs.first.size(); ++i) {
    owner.insert(owner.end(), pairs.first[i + 1] - pairs.first[i], i);
  }
  return owner;
}

template <typename T>
bool same(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(MidPhase, primitive_pairs_match_brute_force) {
  Random random(1);
  CompositeWorld world;
  world.add_shapes(random);
  world.add_pairs(random, scaled(150), 1.2, {0.0, 0.0, 0.0});
  world.add_pairs(random, scaled(60), 4.0, {1e5, -3e4, 2e5});
  PrimitivePairs all;
  std::vector<std::size_t> owner;
  list_all_pairs(world, all, owner);
  for (const double margin : {0.0, 0.25}) {
    PrimitivePairs pairs;
    ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                        margin, Execution::serial(), pairs),
              Status::ok);
    // Far from the origin poses are rounded differently.
    const double slack = 1e-9;
    const std::set<Touch> sure = touching(world, all, owner, margin - slack);
    const std::set<Touch> perhaps = touching(world, all, owner, margin + slack);
    const std::set<Touch> found = touching(world, pairs, owners(pairs), margin);
    EXPECT_GT(sure.size(), 20U);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), sure.begin(), sure.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), found.begin(), found.end()));
    EXPECT_LT(pairs.pairs.size(), all.pairs.size() / 2);
  }
}

TEST(MidPhase, pairs_match_on_any_threads_and_isa) {
  Random random(2);
  CompositeWorld world;
  world.add_shapes(random);
  world.add_pairs(random, scaled(300), 1.5, {0.0, 0.0, 0.0});
  PrimitivePairs one;
  ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                      0.1, Execution::serial(), one),
            Status::ok);
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const Workers& workers : all_workers()) {
      PrimitivePairs many;
      ASSERT_EQ(Threads(workers.threads).run([&] {
        return mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(),
                                         world.pairs, 0.1, workers.execution(), many);
      }),
                Status::ok);
      EXPECT_TRUE(same(one.shapes, many.shapes) && same(one.poses, many.poses) &&
                  same(one.part, many.part) && same(one.triangles, many.triangles) &&
                  same(one.active_edges, many.active_edges) && same(one.pairs, many.pairs) &&
                  same(one.first, many.first));
    }
  }
}

TEST(MidPhase, second_call_allocates_nothing_and_footprint_is_exact) {
  CountingMemory memory;
  {
    Random random(3);
    CompositeWorld world(&memory);
    EXPECT_EQ(world.composites.footprint().total().reserved, 0U);
    EXPECT_EQ(memory.outstanding(), 0U);
    world.add_shapes(random);
    world.add_pairs(random, 200, 1.5, {0.0, 0.0, 0.0});
    EXPECT_EQ(
        world.composites.footprint().total().reserved + world.shapes.footprint().total().reserved,
        memory.outstanding());
    CountingMemory scratch;
    PrimitivePairs pairs(&scratch);
    for (const Execution execution : {Execution::serial(), Execution::parallel()}) {
      std::size_t before = scratch.requests();
      for (int call = 0; call < 2; ++call) {
        before = scratch.requests();
        ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(),
                                            world.pairs, 0.1, execution, pairs),
                  Status::ok);
      }
      EXPECT_EQ(scratch.requests(), before);
      EXPECT_EQ(scratch.outstanding(), pairs.footprint().total().reserved);
    }
    EXPECT_EQ(scratch.requests_from_elsewhere(), 0U);
    for (const ShapeId id : world.ids) {
      if (id.is_composite()) {
        EXPECT_EQ(world.composites.remove(id), Status::ok);
        EXPECT_EQ(world.composites.remove(id), Status::invalid_key);
      }
    }
    EXPECT_EQ(
        world.composites.footprint().total().reserved + world.shapes.footprint().total().reserved,
        memory.outstanding());
  }
}

TEST(MidPhase, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  Random random(4);
  CompositeWorld world;
  world.add_shapes(random);
  world.add_pairs(random, 40, 1.0, {0.0, 0.0, 0.0});
  for (std::size_t grants = 0;; ++grants) {
    CountingMemory memory;
    memory.refuse_after(grants);
    PrimitivePairs pairs(&memory);
    const Status status = mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(),
                                                    world.pairs, 0.1, Execution::serial(), pairs);
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    EXPECT_EQ(pairs.pairs.size(), 0U);
    memory.grant_all();
    EXPECT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                        0.1, Execution::serial(), pairs),
              Status::ok);
  }
  const Surface surface = soup(random, 40, 2.0, 0.5);
  std::vector<CompoundChild> children;
  for (int i = 0; i < 20; ++i) children.push_back({world.ids[0], random_pose(random, 3.0)});
  const std::vector<float> heights(12, 1.0F);
  for (int kind = 0; kind < 3; ++kind) {
    CountingMemory memory;
    for (std::size_t grants = 0;; ++grants) {
      CompositePool pool(world.shapes, &memory);
      memory.refuse_after(grants);
      ShapeId id;
      Status status = Status::ok;
      if (kind == 0) {
        status = pool.add_mesh(std::span<const Point>(surface.vertices),
                               std::span<const std::uint32_t>(surface.corners))
                     .get(id);
      } else if (kind == 1) {
        status = pool.add_compound(children).get(id);
      } else {
        status = pool.add_height_field({heights, 4, 3, 0, {1.0, 1.0}}).get(id);
      }
      EXPECT_EQ(memory.outstanding(), pool.footprint().total().reserved);
      memory.grant_all();
      if (status == Status::ok) break;
      ASSERT_EQ(status, Status::out_of_memory);
      EXPECT_FALSE(pool.contains(id));
      EXPECT_EQ(pool.size(CompositeKind::mesh) + pool.size(CompositeKind::compound) +
                    pool.size(CompositeKind::height_field),
                0U);
    }
  }
}

TEST(MidPhase, unknown_shapes_give_no_pairs) {
  Random random(13);
  CompositeWorld world;
  world.add_shapes(random);
  const ShapeId gone = world.ids[14];
  ASSERT_EQ(world.composites.remove(gone), Status::ok);
  const ShapeId bodies[] = {gone, {}, ShapeId::of(ShapeKind::hull, 77), world.ids[15]};
  const Pose poses[4];
  const BodyPair some[] = {{0, 3}, {3, 1}, {2, 3}, {3, 9}, {3, 3}};
  PrimitivePairs pairs;
  ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, {bodies, poses}, some, 0.0,
                                      Execution::serial(), pairs),
            Status::ok);
  ASSERT_EQ(pairs.first.size(), 6U);
  EXPECT_EQ(pairs.first[4], 0U);
  EXPECT_GT(pairs.first[5], 0U);
}

TEST(MidPhase, extreme_poses_and_scales_give_no_nan) {
  Random random(12);
  CompositeWorld world;
  world.add_shapes(random);
  for (const double factor : {1e-100, 1e100}) {
    world.ids.emplace_back();
    world.ids.back() =
        expect_ok(world.composites.add_scaled(world.ids[14], {factor, 1.0, -factor}));
  }
  world.add_pairs(random, scaled(400), 1.0, {0.0, 0.0, 0.0});
  for (Pose& pose : world.pose) {
    for (double& x : pose.position) {
      const double choices[] = {x, 0.0, 1e300, -1.7e308, 1.7e308, 1e-300, 1e15};
      x = choices[random.below(7)];
    }
    const double length = random.chance(0.5) ? 1.0 : (random.chance(0.5) ? 1e300 : 1e-300);
    for (double& q : pose.orientation) q *= length;
  }
  for (const double margin : {0.0, 1e300}) {
    PrimitivePairs pairs;
    ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                        margin, Execution::serial(), pairs),
              Status::ok);
    // With this margin every pair of primitives is returned. Tests a sample of them.
    const std::size_t count = std::min<std::size_t>(pairs.pairs.size(), 2000);
    pairs.pairs.set_size(count);
    NarrowResult result;
    answer(world.shapes, pairs, {.contact_margin = margin}, result);
    ASSERT_EQ(
        mid::correct_surface_contacts({world.composites, world.shapes, world.bodies(), world.pairs},
                                      pairs, margin, Execution::serial(), result),
        Status::ok);
    for (const double distance : result.distance()) EXPECT_FALSE(std::isnan(distance));
  }
}

TEST(Visits, visits_find_all_primitives_in_reach) {
  Random random(10);
  CompositeWorld world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    for (int i = 0; i < 12; ++i) {
      const Pose pose = random_pose(random, i < 6 ? 2.0 : 1e4);
      MovingBox box{};
      for (int axis = 0; axis < 3; ++axis) {
        const double middle = pose.position[axis] + random.uniform(-2.0, 2.0);
        const double half = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.5);
        box.min[axis] = middle - half;
        box.max[axis] = middle + half;
        box.direction[axis] = random.uniform(-1.0, 1.0);
      }
      box.max_t = random.uniform(0.0, 3.0);
      std::set<std::uint32_t> visited;
      std::set<std::uint32_t> near;
      const auto note = [](void* context, const Primitive& primitive, double limit) {
        static_cast<std::set<std::uint32_t>*>(context)->insert(primitive.part);
        return limit;
      };
      mid::visit(world.composites, id, pose, box, mid::Solids::hulls, {note, &visited});
      mid::visit_near(world.composites, id, pose, box, 0.7, {note, &near});
      // Compares with the narrow phase: a box against each primitive.
      CompositeWorld probe;
      ShapeId cube = add(probe.shapes,
                         BoxShape{{0.5 * (box.max[0] - box.min[0]), 0.5 * (box.max[1] - box.min[1]),
                                   0.5 * (box.max[2] - box.min[2])},
                                  0.0});
      SolverCounts counts;
      for (const Primitive& part : parts_of(world, id, pose)) {
        const bool is_triangle = part.shape.kind() == ShapeKind::triangle;
        const BoxShape& half = probe.shapes.tables().boxes[cube.index()];
        for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
          Pose at;
          for (int axis = 0; axis < 3; ++axis) {
            at.position[axis] =
                0.5 * (box.min[axis] + box.max[axis]) + t * box.max_t * box.direction[axis];
          }
          ShapeTables tables = world.shapes.tables();
          tables.boxes = &half;
          ShapeId shape = part.shape;
          if (is_triangle) {
            tables.triangles = &part.triangle;
            shape = ShapeId::of(ShapeKind::triangle, 0);
          } else if (shape.kind() == ShapeKind::box) {
            continue;
          }
          const double distance = solve_pair(tables, ShapeId::of(ShapeKind::box, 0), at, shape,
                                             part.pose, ContactLevel::distance, 0.0, counts)
                                      .distance;
          if (distance <= 0.0) {
            EXPECT_TRUE(visited.contains(part.part)) << id.kind_index();
          }
          if (t == 0.0 && distance <= 0.7) {
            EXPECT_TRUE(near.contains(part.part)) << id.kind_index();
          }
        }
      }
    }
  }
}

TEST(Visits, negative_limit_ends_visit) {
  Random random(11);
  CompositeWorld world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    int shown = 0;
    const auto once = [](void* context, const Primitive&, double) {
      ++*static_cast<int*>(context);
      return -1.0;
    };
    const MovingBox all{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
    mid::visit(world.composites, id, Pose{}, all, mid::Solids::hulls, {once, &shown});
    EXPECT_EQ(shown, 1);
    mid::visit_near(world.composites, id, Pose{}, all, 1.0, {once, &shown});
    EXPECT_EQ(shown, 2);
  }
}

}  // namespace
}  // namespace winnow::test
