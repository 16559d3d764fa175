// Partitions of spheres and k-DOPs, compared with a brute-force test of the volumes.

#include <winnow/core/eigen.h>
#include <winnow/core/volumes.h>

#include <cmath>
#include <limits>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

template <typename T>
std::vector<Pair> volume_pairs(const std::vector<T>& volumes) {
  std::vector<Pair> pairs;
  for (ObjectId i = 0; i < volumes.size(); ++i) {
    for (ObjectId j = i + 1; j < volumes.size(); ++j) {
      if (volumes[i].overlaps(volumes[j])) pairs.push_back({i, j});
    }
  }
  return pairs;
}

std::vector<Sphere> spheres_around(const std::vector<Aabb>& boxes) {
  std::vector<Sphere> spheres;
  for (const Aabb& box : boxes) spheres.push_back(Sphere::around(box));
  return spheres;
}

// Returns k-DOPs of tetrahedra in the boxes, which separate some pairs whose boxes overlap.
template <int K>
std::vector<Kdop<K>> kdops_in(const std::vector<Aabb>& boxes) {
  std::vector<Kdop<K>> kdops;
  for (const Aabb& box : boxes) {
    const Vec3f e = box.max - box.min;
    const std::vector<Vec3f> corners{box.min, box.min + Vec3f(e.x(), e.y(), 0),
                                     box.min + Vec3f(e.x(), 0, e.z()),
                                     box.min + Vec3f(0, e.y(), e.z())};
    kdops.push_back(Kdop<K>::around(corners));
  }
  return kdops;
}

constexpr Volume volume_of(const Kdop<14>&) {
  return Volume::kdop14;
}
constexpr Volume volume_of(const Kdop<18>&) {
  return Volume::kdop18;
}
constexpr Volume volume_of(const Kdop<26>&) {
  return Volume::kdop26;
}

class Volumes : public Conformance {
 protected:
  Partition make(Volume volume) {
    return Partition(structure_named(config().partition),
                     {.execution = config().execution(), .volume = volume});
  }

  std::vector<Pair> pairs_of(const Partition& partition, Threads& threads) {
    PairBuffer buffer;
    const Status status =
        threads.run([&] { return partition.self_pairs(buffer, {.order = Order::canonical}); });
    EXPECT_EQ(status, Status::ok);
    return {buffer.begin(), buffer.end()};
  }

  template <int K>
  void expect_right_kdops() {
    Threads threads(config().threads);
    for (const std::size_t n : {1U, 17U, 600U}) {
      Partition partition = make(volume_of(Kdop<K>{}));
      std::vector<Kdop<K>> kdops = kdops_in<K>(mixed_boxes(n));
      std::vector<Key> keys(n);
      ASSERT_EQ(partition.insert(std::span<const Kdop<K>>(kdops), {}, keys), Status::ok);
      EXPECT_EQ(pairs_of(partition, threads), volume_pairs(kdops));
      kdops = kdops_in<K>(uniform_boxes(n));
      ASSERT_EQ(partition.update(keys, std::span<const Kdop<K>>(kdops)), Status::ok);
      EXPECT_EQ(pairs_of(partition, threads), volume_pairs(kdops));
      Aabb box = expect_ok(partition.bounds(keys[0]));
      EXPECT_EQ(box, kdops[0].bounds());
    }
  }
};

TEST_P(Volumes, pairs_of_14_dops_are_right) {
  expect_right_kdops<14>();
}
TEST_P(Volumes, pairs_of_18_dops_are_right) {
  expect_right_kdops<18>();
}
TEST_P(Volumes, pairs_of_26_dops_are_right) {
  expect_right_kdops<26>();
}

// Every true pair must be reported. A false pair may have a gap of at most a millionth of the
// distance of the centres.
TEST_P(Volumes, pairs_of_spheres_are_right) {
  Threads threads(config().threads);
  for (const double scale : {1.0, 1e-12, 1e12}) {
    Partition partition = make(Volume::sphere);
    std::vector<Sphere> spheres = spheres_around(mixed_boxes(600));
    // Touching spheres on a lattice: rounding must not lose a pair.
    for (int i = 0; i < 60; ++i) {
      spheres.push_back(
          {{static_cast<float>(i % 5), static_cast<float>(i / 5 % 4), static_cast<float>(i / 20)},
           0.5F});
    }
    for (Sphere& s : spheres) {
      s.center *= static_cast<float>(scale);
      s.radius *= static_cast<float>(scale);
    }
    std::vector<Key> keys(spheres.size());
    ASSERT_EQ(partition.insert(spheres, {}, keys), Status::ok);
    const std::vector<Pair> got = pairs_of(partition, threads);
    EXPECT_TRUE(right_pairs(got, volume_pairs(spheres), false));
    for (const Pair& pair : got) {
      const Sphere& a = spheres[pair.first];
      const Sphere& b = spheres[pair.second];
      const double distance = (a.center.cast<double>() - b.center.cast<double>()).norm();
      EXPECT_LE(distance * (1 - 1e-6),
                static_cast<double>(a.radius) + static_cast<double>(b.radius));
    }
  }
}

TEST_P(Volumes, volumes_given_as_boxes_miss_no_box_pair) {
  Threads threads(config().threads);
  const std::vector<Aabb> boxes = mixed_boxes(500);
  const std::vector<Pair> truth = true_pairs(numbered(boxes));
  for (const Volume volume :
       {Volume::aabb, Volume::sphere, Volume::kdop14, Volume::kdop18, Volume::kdop26}) {
    Partition partition = make(volume);
    std::vector<Key> keys(boxes.size());
    ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    EXPECT_EQ(partition.volume(), volume);
    EXPECT_EQ(partition.is_exact(), volume == Volume::aabb);
    EXPECT_TRUE(right_pairs(pairs_of(partition, threads), truth, partition.is_exact()));
    for (std::size_t i = 0; i < keys.size(); ++i) {
      Aabb box = expect_ok(partition.bounds(keys[i]));
      EXPECT_TRUE((as_eigen(box.min).array() <= as_eigen(boxes[i].min).array()).all());
      EXPECT_TRUE((as_eigen(box.max).array() >= as_eigen(boxes[i].max).array()).all());
    }
  }
}

// pairs_with compares the stored boxes, whatever the volumes are. Only NSquared may report other
// pairs, too.
TEST_P(Volumes, pairs_of_two_partitions_compare_boxes) {
  Threads threads(config().threads);
  const std::vector<Aabb> boxes = mixed_boxes(300);
  const std::vector<Aabb> others = uniform_boxes(200);
  Partition other(linear_bvh(), {.execution = config().execution()});
  std::vector<Key> other_keys(others.size());
  ASSERT_EQ(other.insert(others, {}, other_keys), Status::ok);
  for (const Volume volume : {Volume::sphere, Volume::kdop14}) {
    Partition partition = make(volume);
    std::vector<Key> keys(boxes.size());
    ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    std::vector<Pair> truth;
    for (ObjectId i = 0; i < keys.size(); ++i) {
      Aabb box = expect_ok(partition.bounds(keys[i]));
      for (ObjectId k = 0; k < others.size(); ++k) {
        if (box.overlaps(others[k])) truth.push_back({i, k});
      }
    }
    PairBuffer buffer;
    const auto query = [&] {
      return partition.pairs_with(other, buffer, {.order = Order::canonical});
    };
    ASSERT_EQ(threads.run(query), Status::ok);
    const std::vector<Pair> got{buffer.begin(), buffer.end()};
    EXPECT_TRUE(right_cross_pairs(got, truth, config().partition != "NSquared"));
  }
}

// Later frames are incremental queries: they test only the moved objects. pairs_with compares
// boxes.
TEST_P(Volumes, moving_volumes_are_right_in_every_frame) {
  Threads threads(config().threads);
  std::vector<Aabb> boxes = uniform_boxes(700);
  const std::vector<Aabb> others = mixed_boxes(60);
  Partition other(bounds_n_squared(), {.execution = config().execution()});
  std::vector<Key> other_keys(others.size());
  ASSERT_EQ(other.insert(others, {}, other_keys), Status::ok);
  auto made = make(Volume::kdop18);
  std::vector<Kdop<18>> kdops = kdops_in<18>(boxes);
  std::vector<Key> keys(kdops.size());
  ASSERT_EQ(made.insert(std::span<const Kdop<18>>(kdops), {}, keys), Status::ok);
  PairBuffer buffer;
  Random random(5);
  for (int frame = 0; frame < 4; ++frame) {
    ASSERT_EQ(threads.run([&] { return made.self_pairs(buffer, {.order = Order::canonical}); }),
              Status::ok);
    EXPECT_EQ(std::vector<Pair>(buffer.begin(), buffer.end()), volume_pairs(kdops));
    PairBuffer cross;
    ASSERT_EQ(made.pairs_with(other, cross, {.order = Order::canonical}), Status::ok);
    EXPECT_TRUE(
        right_cross_pairs(cross.pairs(), cross_pairs(numbered(boxes), numbered(others)), true));
    const std::vector<std::size_t> moved = move(Motion::few, boxes, random);
    kdops = kdops_in<18>(boxes);
    std::vector<Key> some;
    std::vector<Kdop<18>> shapes;
    for (const std::size_t i : moved) {
      some.push_back(keys[i]);
      shapes.push_back(kdops[i]);
    }
    ASSERT_EQ(made.update(some, std::span<const Kdop<18>>(shapes)), Status::ok);
  }
  EXPECT_GT(made.statistics().incremental_queries, 0U);
}

TEST_P(Volumes, volumes_of_another_kind_are_refused) {
  std::vector<Key> keys(1);
  const std::vector<Sphere> sphere{{{0, 0, 0}, 1}};
  const std::vector<Kdop<14>> kdop{Kdop<14>::around(Aabb{{0, 0, 0}, {1, 1, 1}})};
  Partition boxes(bounds_n_squared());
  Partition kdops(bounds_n_squared(), {.volume = Volume::kdop26});
  for (Partition* partition : {&boxes, &kdops}) {
    EXPECT_EQ(partition->insert(sphere, {}, keys), Status::unsupported_volume);
    EXPECT_EQ(partition->insert(std::span<const Kdop<14>>(kdop), {}, keys),
              Status::unsupported_volume);
    EXPECT_EQ(partition->update(keys, sphere), Status::unsupported_volume);
    EXPECT_EQ(partition->size(), 0U);
  }
}

TEST_P(Volumes, unknown_volume_is_refused) {
  const auto none = static_cast<Volume>(17);
  Partition partition(bounds_n_squared(), {.volume = none});
  EXPECT_EQ(partition.status(), Status::invalid_argument);
  Key key;
  expect_error(partition.insert(Aabb{{0, 0, 0}, {1, 1, 1}}, 0), Status::invalid_argument);
}

TEST_P(Volumes, invalid_volumes_change_nothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  Partition partition = make(Volume::sphere);
  std::vector<Sphere> spheres = spheres_around(uniform_boxes(40));
  std::vector<Key> keys(spheres.size());
  ASSERT_EQ(partition.insert(spheres, {}, keys), Status::ok);
  for (const Sphere& bad :
       {Sphere{{0, 0, 0}, -1}, Sphere{{nan, 0, 0}, 1}, Sphere{{0, 0, 0}, nan}}) {
    std::vector<Sphere> some = spheres;
    some[20] = bad;
    std::vector<Key> fresh(some.size());
    EXPECT_EQ(partition.insert(some, {}, fresh), Status::invalid_bounds);
    EXPECT_EQ(partition.update(keys, some), Status::invalid_bounds);
    EXPECT_EQ(partition.size(), spheres.size());
  }
}

// Returns the configurations that take volumes from the caller and test them.
std::vector<Config> volume_configs() {
  std::vector<Config> configs;
  for (const Config& config : all_configs()) {
    if (config.partition == "NSquared") continue;
    configs.push_back(config);
  }
  return configs;
}

INSTANTIATE_TEST_SUITE_P(All, Volumes, testing::ValuesIn(volume_configs()),
                         testing::PrintToStringParamName());

TEST(VolumesGivenAsBoxes, every_partition_accepts_volumes_given_as_boxes) {
  const std::vector<Aabb> boxes = mixed_boxes(300);
  for (const std::string_view name : structure_names()) {
    for (const Volume volume : {Volume::sphere, Volume::kdop26}) {
      Partition partition(structure_named(name),
                          {.execution = Execution::serial(), .volume = volume});
      std::vector<Key> keys(boxes.size());
      ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
      EXPECT_FALSE(partition.is_exact());
      PairBuffer buffer;
      for (int frame = 0; frame < 3; ++frame) {
        ASSERT_EQ(partition.self_pairs(buffer, {.incremental = false}), Status::ok);
        EXPECT_TRUE(right_pairs(buffer.pairs(), true_pairs(numbered(boxes)), false)) << name;
        ASSERT_EQ(partition.update(keys, boxes), Status::ok);
      }
    }
  }
}

// A tree of other volumes is a tree of their boxes.
TEST(VolumesGivenAsBoxes, volumes_given_as_boxes_are_pruned_as_boxes) {
  const std::vector<Aabb> boxes = uniform_boxes(5000);
  std::uint64_t tests_of_boxes = 0;
  for (const Volume volume : {Volume::aabb, Volume::kdop14, Volume::kdop26}) {
    Partition partition(structure_named("LinearBvh"),
                        {.execution = Execution::serial(), .volume = volume});
    std::vector<Key> keys(boxes.size());
    ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    PairBuffer buffer;
    ASSERT_EQ(partition.self_pairs(buffer), Status::ok);
    const std::uint64_t tests = partition.statistics().last_tests;
    if (volume == Volume::aabb) tests_of_boxes = tests;
    EXPECT_LE(tests, tests_of_boxes + tests_of_boxes / 10);
  }
}

}  // namespace
}  // namespace winnow::test
