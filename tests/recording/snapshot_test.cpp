// Loaded snapshots continue exactly as the saved objects would have: equal keys, equal pairs in
// equal order, bit-identical results. Invalid snapshots are rejected and change nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/mesh/mesh_tree.h"
#include "tests/recording/mutations.h"
#include "tests/recording/programs.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

std::span<const std::byte> bytes_of(const Column<std::byte>& column) {
  return {column.data(), column.size()};
}

/// Returns the ids of live objects, ascending.
std::vector<ObjectId> live_ids(const Partition& partition) {
  std::vector<ObjectId> ids;
  for (ObjectId id = 0; ids.size() < partition.size(); ++id) {
    if (partition.key_of(id) != Key{}) ids.push_back(id);
  }
  return ids;
}

/// Runs some frames of moves, removals, insertions and queries; returns everything that callers can
/// read.
std::vector<std::uint64_t> go_on(Partition& partition) {
  Random random(5);
  PairBuffer pairs;
  HitBuffer hits;
  std::vector<std::uint64_t> seen;
  for (int frame = 0; frame < 5; ++frame) {
    for (const ObjectId id : live_ids(partition)) {
      Aabb box;
      const Key key = partition.key_of(id);
      box = expect_ok(partition.bounds(key));
      if (random.below(3) != 0) continue;
      const auto by = static_cast<float>(random.uniform(-0.5, 0.5));
      for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] += by;
        box.max[axis] += by;
      }
      EXPECT_EQ(partition.update(key, box), Status::ok);
    }
    if (frame == 1) {
      EXPECT_EQ(partition.remove(partition.key_of(live_ids(partition)[3])), Status::ok);
    }
    for (int i = 0; i < 4; ++i) {
      Key key = expect_ok(partition.insert({{1, 1, 1}, {3, 3, 3}}, 9));
      seen.push_back(key.id);
    }
    EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
    for (const Pair& pair : pairs) seen.push_back(std::uint64_t{pair.first} << 32U | pair.second);
    EXPECT_EQ(partition.all(Ray{{1, 2, -9}, {0, 0.1F, 1}}, hits), Status::ok);
    for (const Hit& hit : hits) seen.push_back(hit.data << 32U | hit.key.id);
    for (const ObjectId id : live_ids(partition)) {
      Aabb box;
      ObjectFilter filter;
      box = expect_ok(partition.bounds(partition.key_of(id)));
      filter = expect_ok(partition.filter(partition.key_of(id)));
      float floats[6];
      std::memcpy(floats, &box, sizeof floats);
      for (const float x : floats) seen.push_back(std::bit_cast<std::uint32_t>(x));
      seen.push_back(std::uint64_t{filter.layers} << 32U | filter.environment);
    }
  }
  return seen;
}

/// Returns a partition with a history of inserted, removed and filtered objects.
Partition with_past(StructureKind structure, Volume volume, std::vector<Key>& keys) {
  Partition partition(structure, {.volume = volume, .fat_margin = {0.01F, 0.02F}});
  const std::vector<Aabb> boxes = uniform_boxes(structure.name() == "NSquared" ? 60 : scaled(800));
  keys.resize(boxes.size());
  EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  PairBuffer pairs;
  for (std::size_t i = 1; i < 12; ++i) {
    EXPECT_EQ(partition.remove(keys[4 * i]), Status::ok);
    if (i % 3 == 0) {
      keys[4 * i] = expect_ok(partition.insert(boxes[i], i));
    }
    EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
  }
  EXPECT_EQ(partition.set_filter(keys[5], {.layers = 2, .environment = 3}), Status::ok);
  EXPECT_EQ(partition.set_filter(keys[6], {.layers = 2, .environment = 3}), Status::ok);
  return partition;
}

TEST(Snapshots, loaded_partition_continues_bit_identical) {
  for (const StructureKind& structure : all_structures()) {
    for (const Volume volume : {Volume::aabb, Volume::sphere, Volume::kdop14}) {
      SCOPED_TRACE(structure.name());
      std::vector<Key> keys;
      Partition saved = with_past(structure, volume, keys);
      Column<std::byte> bytes(std::pmr::get_default_resource());
      ASSERT_EQ(saved.save(bytes), Status::ok);
      // Changes the partition, which the load must undo.
      (void)go_on(saved);
      ASSERT_EQ(saved.load(bytes_of(bytes)), Status::ok);
      EXPECT_TRUE(saved.contains(keys[0]) && saved.contains(keys[5]) && saved.contains(keys[12]));
      EXPECT_FALSE(saved.contains(keys[4]));
      // The next stamps are not restored.
      Column<std::byte> again(std::pmr::get_default_resource());
      ASSERT_EQ(saved.save(again), Status::ok);
      ASSERT_EQ(saved.load(bytes_of(again)), Status::ok);
      Column<std::byte> once_more(std::pmr::get_default_resource());
      ASSERT_EQ(saved.save(once_more), Status::ok);
      EXPECT_TRUE(std::ranges::equal(bytes_of(again), bytes_of(once_more)));
      const std::vector<std::uint64_t> first = go_on(saved);
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        for (const int threads : {1, 2}) {
          Partition loaded(bounds_n_squared(), {.execution = Workers{threads}.execution()});
          ASSERT_EQ(loaded.load(bytes_of(bytes)), Status::ok);
          EXPECT_EQ(loaded.structure(), structure);
          EXPECT_EQ(loaded.volume(), volume);
          EXPECT_TRUE(go_on(loaded) == first) << to_string(isa) << " " << threads;
        }
      }
    }
  }
}

TEST(Snapshots, loaded_partition_answers_queries_before_pairs) {
  const Sphere everywhere{{0, 0, 0}, 1e6F};
  for (const StructureKind& structure : all_structures()) {
    SCOPED_TRACE(structure.name());
    std::vector<Key> keys;
    const Partition saved = with_past(structure, Volume::aabb, keys);
    Column<std::byte> bytes(std::pmr::get_default_resource());
    ASSERT_EQ(saved.save(bytes), Status::ok);
    Partition loaded(linear_bvh());
    OverlapBuffer objects;
    ASSERT_EQ(loaded.overlap(everywhere, objects), Status::ok);
    ASSERT_EQ(loaded.load(bytes_of(bytes)), Status::ok);
    ASSERT_EQ(loaded.overlap(everywhere, objects, {}, Order::canonical), Status::ok);
    EXPECT_TRUE(std::ranges::equal(objects.ids(), live_ids(saved)));
  }
}

TEST(Snapshots, inverted_boxes_are_refused) {
  const Aabb box{{1.25F, 2.5F, 3.75F}, {5.25F, 6.5F, 7.75F}};
  Partition partition(linear_bvh());
  Key key = expect_ok(partition.insert(box, 0));
  Column<std::byte> bytes(std::pmr::get_default_resource());
  ASSERT_EQ(partition.save(bytes), Status::ok);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::byte> wrong(bytes.begin(), bytes.end());
    const auto low = std::bit_cast<std::array<std::byte, 4>>(box.min[axis]);
    const auto beyond = std::bit_cast<std::array<std::byte, 4>>(8.0F);
    const auto found = std::ranges::search(wrong, low);
    ASSERT_FALSE(found.empty());
    std::ranges::copy(beyond, found.begin());
    EXPECT_NE(partition.load(wrong), Status::ok) << axis;
    EXPECT_TRUE(partition.contains(key));
  }
}

// New keys of a partition that was loaded in place, or into another partition, differ from all keys
// that were issued after the save.
TEST(Snapshots, loads_never_give_a_key_twice) {
  const Aabb box{{1, 1, 1}, {3, 3, 3}};
  std::vector<Key> keys;
  auto first = std::make_unique<Partition>(with_past(linear_bvh(), Volume::aabb, keys));
  Column<std::byte> bytes(std::pmr::get_default_resource());
  ASSERT_EQ(first->save(bytes), Status::ok);
  std::vector<Key> given;
  const auto insert = [&](Partition& partition) {
    for (int i = 0; i < 20; ++i) {
      Key key = expect_ok(partition.insert(box, 0));
      EXPECT_EQ(std::ranges::find(given, key), given.end());
      given.push_back(key);
    }
  };
  for (int round = 0; round < 3; ++round) {
    insert(*first);
    // Also keys of slots that have live objects in the snapshot.
    for (const Key key : {keys[0], keys[7]}) ASSERT_EQ(first->remove(key), Status::ok);
    insert(*first);
    ASSERT_EQ(first->load(bytes_of(bytes)), Status::ok);
    EXPECT_TRUE(first->contains(keys[0]));
    for (const Key& key : given) EXPECT_FALSE(first->contains(key));
  }
  first.reset();
  Partition later(linear_bvh());
  ASSERT_EQ(later.load(bytes_of(bytes)), Status::ok);
  EXPECT_TRUE(later.contains(keys[0]));
  insert(later);
}

TEST(Snapshots, loaded_partition_keeps_keys_unused_elsewhere) {
  Column<std::byte> bytes(std::pmr::get_default_resource());
  std::vector<Key> keys;
  {
    Partition saved = with_past(linear_bvh(), Volume::aabb, keys);
    ASSERT_EQ(saved.save(bytes), Status::ok);
    Partition beside(linear_bvh());
    ASSERT_EQ(beside.load(bytes_of(bytes)), Status::ok);
    EXPECT_FALSE(beside.contains(keys[0]));
    EXPECT_EQ(beside.key_of(keys[0].id).id, keys[0].id);
  }
  Partition later(linear_bvh());
  ASSERT_EQ(later.load(bytes_of(bytes)), Status::ok);
  EXPECT_TRUE(later.contains(keys[0]));
  EXPECT_EQ(later.key_of(keys[0].id), keys[0]);
}

/// Returns true if traversals read bit-identical data from both.
bool same_view(const MeshView& a, const MeshView& b) {
  const auto same = [](const auto* x, const auto* y, std::size_t count) {
    return std::memcmp(x, y, count * sizeof *x) == 0;
  };
  bool all = a.vertex_count == b.vertex_count && a.triangle_count == b.triangle_count &&
             a.levels == b.levels && (a.box == nullptr) == (b.box == nullptr) &&
             (a.corner[0] == nullptr) == (b.corner[0] == nullptr);
  if (!all) return false;
  const std::size_t slots = whole_leaves(a.triangle_count);
  all = same(a.vertex, b.vertex, 3 * std::size_t{a.vertex_count} + 1) &&
        same(a.triangle, b.triangle, slots) && same(a.origin, b.origin, 3) &&
        same(a.step, b.step, 3) && same(a.count, b.count, a.levels);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t slot = 0; slot < slots; ++slot) {
      all = all && corner_of(a, k, slot) == corner_of(b, k, slot);
    }
  }
  for (std::uint32_t level = 0; level < a.levels; ++level) {
    all = all && same(a.node[level], b.node[level], 6 * whole_leaves(a.count[level]));
  }
  return all && (a.box == nullptr || same(a.box, b.box, 6 * slots));
}

/// Returns the vertices of the mesh at other positions.
std::vector<Eigen::Vector3f> stirred(const MeshData& data) {
  std::vector<Eigen::Vector3f> vertices = data.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] *= 1.0F + 0.1F * static_cast<float>(i % 7);
  }
  return vertices;
}

TEST(Snapshots, loaded_mesh_answers_bit_identical) {
  Column<std::byte> bytes(std::pmr::get_default_resource());
  for (const MeshData& data : sample_meshes()) {
    SCOPED_TRACE(data.name);
    TriangleMesh mesh;
    ASSERT_EQ(data.build(mesh), Status::ok);
    TriangleMesh loaded;
    for (const bool deforms : {false, true}) {
      if (deforms) {
        ASSERT_EQ(mesh.refit(stirred(data)), Status::ok);
      }
      bytes.clear();
      ASSERT_EQ(mesh.save(bytes), Status::ok);
      ASSERT_EQ(loaded.load(bytes_of(bytes)), Status::ok);
      EXPECT_TRUE(same_view(view_of(mesh), view_of(loaded)));
      EXPECT_EQ(mesh.bounds(), loaded.bounds());
      EXPECT_EQ(mesh.radius(), loaded.radius());
    }
    // The neighbours of triangles were saved, too.
    ASSERT_EQ(mesh.refit(data.points()), Status::ok);
    ASSERT_EQ(loaded.refit(data.points()), Status::ok);
    EXPECT_TRUE(same_view(view_of(mesh), view_of(loaded)));
  }
  TriangleMesh mesh;
  bytes.clear();
  ASSERT_EQ(mesh.save(bytes), Status::ok);
  ASSERT_EQ(torus(20, 20).build(mesh), Status::ok);
  ASSERT_EQ(mesh.load(bytes_of(bytes)), Status::ok);
  EXPECT_EQ(mesh.triangles(), 0U);
}

/// Loads mutated snapshots, most of which have a valid digest. `load` returns the status of a load.
template <typename Load>
void load_mutated(const Column<std::byte>& good, std::size_t count, const Load& load) {
  Random random(3);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::byte> bytes(good.begin(), good.end());
    mutate(bytes, random);
    if (i % 8 != 0) seal_snapshot(bytes);
    if (load(std::span<const std::byte>(bytes)) != Status::ok) ++refused;
  }
  EXPECT_GT(refused, count / 16);
}

/// Queries and changes a partition that was loaded from a mutated snapshot.
void query_and_change(Partition& partition) {
  PairBuffer pairs;
  HitBuffer hits;
  Key key;
  EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
  EXPECT_EQ(partition.all(Ray{{1, 2, -9}, {0, 0.1F, 1}}, hits), Status::ok);
  EXPECT_EQ(partition.nearest({{1, 1, 1}, {2, 2, 2}}, 5, 100.0F, hits), Status::ok);
  for (int i = 0; i < 20; ++i) {
    key = expect_ok(partition.insert({{1, 1, 1}, {3, 3, 3}}, 9));
  }
  EXPECT_EQ(partition.remove(key), Status::ok);
  EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
}

TEST(Snapshots, untrusted_snapshots_are_read_or_refused) {
  std::vector<Key> keys;
  Column<std::byte> bytes(std::pmr::get_default_resource());
  for (const Volume volume : {Volume::aabb, Volume::sphere, Volume::kdop26}) {
    Partition saved = with_past(loose_octree(), volume, keys);
    bytes.clear();
    ASSERT_EQ(saved.save(bytes), Status::ok);
    load_mutated(bytes, scaled(300), [](std::span<const std::byte> made_up) {
      Partition partition(linear_bvh());
      const Status status = partition.load(made_up);
      EXPECT_TRUE(status == Status::ok || status == Status::invalid_argument);
      if (status != Status::ok) {
        EXPECT_EQ(partition.size(), 0U);
      } else {
        query_and_change(partition);
      }
      return status;
    });
  }
  TriangleMesh mesh;
  ASSERT_EQ(torus(12, 10).build(mesh), Status::ok);
  ASSERT_EQ(mesh.refit(stirred(torus(12, 10))), Status::ok);
  bytes.clear();
  ASSERT_EQ(mesh.save(bytes), Status::ok);
  load_mutated(bytes, scaled(600), [](std::span<const std::byte> made_up) {
    TriangleMesh loaded;
    const Status status = loaded.load(made_up);
    if (status != Status::ok) {
      EXPECT_EQ(loaded.triangles(), 0U);
      return status;
    }
    const MeshView& view = view_of(loaded);
    std::vector<std::uint32_t> slots(2 * loaded.triangles() + 32);
    SlotPairSink pairs{slots.data(), slots.data() + slots.size() / 2, slots.size() / 2};
    constexpr double kNoMargin[3] = {};
    mesh_overlap_pairs(view, view, {}, kNoMargin, pairs);
    const std::vector<Vec3f> vertices(loaded.vertices(), Vec3f(1, 2, 3));
    EXPECT_EQ(loaded.refit(vertices), Status::ok);
    return status;
  });
}

}  // namespace
}  // namespace winnow::test
