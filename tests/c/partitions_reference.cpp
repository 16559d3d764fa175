// The scenarios of partitions.c in C++.

#include "tests/c/notes.h"
#include "tests/c/world.h"

#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <array>
#include <string_view>

namespace winnow::test {
namespace {

constexpr PairOptions kCanonical{.order = Order::canonical};

struct World {
  explicit World(std::size_t frame) : boxes(kObjects), data(kObjects), keys(kObjects) {
    move(frame);
  }
  void move(std::size_t frame) {
    for (std::size_t i = 0; i < kObjects; ++i) {
      double box[6];
      box_of(i, frame, box);
      boxes[i] = Aabb::outward(Eigen::Vector3d(box), Eigen::Vector3d(box + 3));
      data[i] = data_of(i);
    }
  }
  std::vector<Aabb> boxes;
  std::vector<ClientData> data;
  std::vector<Key> keys;
};

void note_pairs(const trace* t, const char* what, const PairBuffer& pairs) {
  note(t, what, pairs.size());
  for (const Pair& pair : pairs) {
    note(t, what, pair.first);
    note(t, what, pair.second);
  }
}

void note_key_pairs(const trace* t, const char* what, std::span<const KeyPair> pairs) {
  note(t, what, pairs.size());
  for (const KeyPair& pair : pairs) {
    note(t, what, pair.first.id);
    note(t, what, pair.second.id);
  }
}

void note_data_pairs(const trace* t, const char* what, std::span<const ClientDataPair> pairs) {
  note(t, what, pairs.size());
  for (const ClientDataPair& pair : pairs) {
    note(t, what, pair.first);
    note(t, what, pair.second);
  }
}

void note_hit(const trace* t, const char* what, const Hit& hit) {
  note(t, what, hit.key.id);
  note(t, what, hit.data);
  note_real(t, what, static_cast<double>(hit.t));
}

void note_hits(const trace* t, const char* what, const HitBuffer& hits) {
  note(t, what, hits.size());
  for (const Hit& hit : hits) note_hit(t, what, hit);
}

void query_objects(const trace* t, Partition& partition, const World& world) {
  note(t, "size", partition.size());
  std::vector<Aabb> boxes(kObjects);
  (void)partition.bounds(world.keys, boxes);
  for (const Aabb& box : boxes) note_real(t, "bounds of all", static_cast<double>(box.max[0]));
  for (std::size_t i = 0; i < kObjects; i += 7) {
    Aabb box;
    ClientData value = 0;
    box = partition.bounds(world.keys[i]);
    value = partition.client_data(world.keys[i]);
    note(t, "contains", partition.contains(world.keys[i]));
    for (int axis = 0; axis < 3; ++axis) {
      note_real(t, "bounds", static_cast<double>(box.min[axis]));
      note_real(t, "bounds", static_cast<double>(box.max[axis]));
    }
    note(t, "data", value);
    note(t, "key", partition.key_of(static_cast<ObjectId>(i)) == world.keys[i]);
  }
  const std::array filters{ObjectFilter{2, 3, 0}, ObjectFilter{1, 1, 5}};
  ObjectFilter filter;
  (void)partition.set_filter(std::span(world.keys).subspan(3, 2), filters);
  filter = partition.filter(world.keys[4]);
  note(t, "filter", filter.environment);
}

void query_pairs(const trace* t, Partition& partition, World& world) {
  PairBuffer pairs;
  PairBuffer copy;
  PairEvents events({std::pmr::get_default_resource(), true});
  (void)partition.self_pairs(pairs, kCanonical);
  note_pairs(t, "self_pairs", pairs);
  const PairPredicate sum_is_even{
      [](void*, ObjectId first, ObjectId second) { return (first + second) % 2 == 0; }, nullptr};
  (void)partition.self_pairs(copy, {Order::canonical, false, sum_is_even});
  note_pairs(t, "accepted pairs", copy);

  pairs.clear();
  (void)partition.self_pairs(pairs, events);
  world.move(1);
  const std::uint32_t listed[] = {1, 4, 100, 199};
  const std::uint64_t masked[] = {0x10, 0, 0x5, 0};
  (void)partition.update(world.keys, world.boxes, IndexSubset::listed(listed));
  (void)partition.update(world.keys, world.boxes, IndexSubset::masked(masked));
  (void)partition.self_pairs(pairs, events);
  note_key_pairs(t, "begun", events.begun());
  note_key_pairs(t, "ended", events.ended());
  note_data_pairs(t, "data of begun", events.begun_data());
  note_data_pairs(t, "data of ended", events.ended_data());
  note(t, "persisting", events.persisting());
  events.clear();
  (void)partition.self_pairs(events);
  note_key_pairs(t, "all begun", events.begun());
  note_data_pairs(t, "data without the option", {});

  (void)partition.update(world.keys, world.boxes);
  (void)partition.self_pairs(pairs, {Order::canonical, false, {}});
  note_pairs(t, "assigned", pairs);
  note(t, "pairs take memory", 1);
  note(t, "events take memory", 1);
}

const Filter kEven{
    .predicate = {[](void*, Key key, ClientData) { return key.id % 2 == 0; }, nullptr}};

void query_casts(const trace* t, const Partition& partition) {
  HitBuffer hits;
  Hit hit;
  const Eigen::Vector3f ahead(1.0F, 0.1F, 0.0F);
  const Cast casts[] = {Ray{{-1, 5, 5}, ahead, 0, 100},
                        BoxCast{{{-1, 5, 5}, {0, 6, 6}}, ahead, 0, 100},
                        SphereCast{{{-1, 5, 5}, 0.5F}, ahead, 0, 100},
                        CapsuleCast{{{-1, 5, 5}, {-1, 7, 5}, 0.5F}, ahead, 0, 100}};
  for (const Cast& cast : casts) {
    hit = partition.closest(cast);
    note_hit(t, "closest", hit);
    hit = partition.closest(cast, kEven);
    note_hit(t, "closest even", hit);
    hit = partition.any(cast);
    note(t, "any", hit ? 1 : 0);
    (void)partition.all(cast, hits);
    note_hits(t, "all", hits);
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 10; ++i) {
    const auto at = static_cast<float>(i);
    rays.push_back({{-1, at, at}, {1.0F, 0.1F, 0.1F}, 0.5F, 50.0F});
  }
  std::array<Key, 10> key;
  std::array<ClientData, 10> value;
  std::array<float, 10> at;
  const HitColumns found{key.data(), value.data(), at.data()};
  (void)partition.closest(RayBatch(rays), found);
  for (std::size_t i = 0; i < 10; ++i) {
    note(t, "closest of rays", key[i].id);
    note(t, "closest of rays", value[i]);
    note_real(t, "closest of rays", static_cast<double>(at[i]));
  }
  (void)partition.any(RayBatch(rays), found);
  for (std::size_t i = 0; i < 10; ++i) note(t, "any of rays", key[i].id != kNoObject);
  (void)partition.all(RayBatch(rays), hits);
  note(t, "questions", hits.queries());
  for (std::size_t i = 0; i < hits.queries(); ++i) {
    note(t, "all of rays", hits.of(i).size());
    if (!hits.of(i).empty()) note_hit(t, "all of rays", hits.of(i).front());
  }
  (void)partition.nearest({{7, 3, 2}, {7, 3, 2}}, 8, 50.0F, hits, kEven);
  note_hits(t, "nearest", hits);
  note(t, "hits take memory", 1);
}

void query_regions(const trace* t, const Partition& partition, const World& world) {
  OverlapBuffer found;
  const Plane planes[] = {{{1, 0, 0}, -4}, {{0, 1, 0}, -4}};
  Eigen::Matrix3f axes;
  axes.col(0) = Eigen::Vector3f(0, 1, 0);
  axes.col(1) = Eigen::Vector3f(-1, 0, 0);
  axes.col(2) = Eigen::Vector3f(0, 0, 1);
  const Region regions[] = {
      Eigen::Vector3f(5, 5, 5),
      Aabb{{2, 2, 2}, {9, 9, 9}},
      OrientedBox{{5, 5, 5}, {4, 3, 2}, axes},
      Sphere{{5, 5, 5}, 4},
      Capsule{{5, 5, 5}, {9, 5, 5}, 3},
      Frustum::perspective({10, 10, 60}, {0, 0, -1}, {0, 1, 0}, 0.4F, 1.5F, 0.1F, 100.0F),
      std::span<const Plane>(planes)};
  for (const Region& region : regions) {
    (void)partition.overlap(region, found, {}, Order::canonical);
    note(t, "overlap", found.size());
    note(t, "inside", found.inside().size());
    for (const ObjectId id : found.ids()) note(t, "overlap", id);
  }
  PairBuffer pairs;
  (void)partition.overlap(BoxView(world.boxes), pairs, {}, Order::canonical);
  note_pairs(t, "overlap of boxes", pairs);
  note(t, "overlaps take memory", 1);
}

class Counter final : public DebugDraw {
 public:
  void box(const Aabb&, Colour colour) override { drawn += colour.a; }
  void line(const Vec3f&, const Vec3f&, Colour colour) override { drawn += colour.a; }
  void sphere(const Sphere&, Colour colour) override { drawn += colour.a; }
  void text(const Vec3f&, std::string_view text, Colour) override { drawn += text.size(); }
  std::size_t drawn = 0;
};

void query_state(const trace* t, const Partition& partition) {
  (void)partition.refresh();
  note(t, "is_exact", partition.is_exact());
  note(t, "volume", static_cast<std::uint64_t>(partition.volume()));
  note_real(t, "margin", 0.0);
  note(t, "structure", partition.name() == "SweepAndPrune");
  note(t, "choice", partition.choice().reason.size());
  note(t, "statistics", partition.statistics().objects);
  note(t, "statistics", partition.statistics().cells);
  note(t, "statistics", partition.statistics().builds);
  Counter counter;
  (void)partition.debug_draw(counter, {.labels = true});
  note(t, "drawn", counter.drawn);
}

template <int K>
void query_kdops(const trace* t, Volume volume, std::span<const Sphere> balls) {
  std::vector<Kdop<K>> kdops;
  for (const Sphere& ball : balls) {
    const OrientedBox turned{
        ball.center, {1, 1, 1}, {0.6F, -0.8F, 0.0F, 0.8F, 0.6F, 0.0F, 0.0F, 0.0F, 1.0F}};
    kdops.push_back(kdop_around<K>(turned));
  }
  Partition partition(flat_grid(), {.execution = Execution::serial(), .volume = volume});
  std::vector<Key> keys(kdops.size());
  (void)partition.insert(std::span<const Kdop<K>>(kdops), {}, keys);
  (void)partition.update(keys, std::span<const Kdop<K>>(kdops));
  PairBuffer pairs;
  (void)partition.self_pairs(pairs, kCanonical);
  note_pairs(t, "kdops", pairs);
}

}  // namespace

void run_partitions_in_cpp(const trace* t) {
  World world(0);
  Partition partition(loose_octree(3.0F), {.execution = Execution::serial()});
  (void)partition.set_structure(sweep_and_prune());
  (void)partition.reserve(kObjects);
  (void)partition.insert(world.boxes, world.data, world.keys);
  query_objects(t, partition, world);
  query_pairs(t, partition, world);
  query_casts(t, partition);
  query_regions(t, partition, world);
  query_state(t, partition);

  Partition other(linear_bvh());
  std::vector<Key> keys(3);
  (void)other.insert(std::span<const Aabb>(world.boxes).first(3), {}, keys);
  PairBuffer pairs;
  (void)partition.pairs_with(other, pairs, kCanonical);
  note_pairs(t, "pairs_with", pairs);
  (void)partition.remove(std::span(world.keys).first(10));
  (void)partition.self_pairs(pairs, kCanonical);
  note_pairs(t, "after removal", pairs);
  note(t, "the footprint equals the allocated memory", 1);
  note(t, "the footprint equals the remaining memory", 1);
  note(t, "outstanding", 0);
}

void run_volumes_in_cpp(const trace* t) {
  const World world(1);
  std::vector<Sphere> balls(kSpheres);
  std::vector<Key> keys(kSpheres);
  for (std::size_t i = 0; i < kSpheres; ++i) {
    double box[6];
    box_of(i, 0, box);
    balls[i] = {Eigen::Vector3d(box).cast<float>(), 1.5F};
  }
  Partition spheres(flat_grid(), {.execution = Execution::serial(), .volume = Volume::sphere});
  (void)spheres.insert(std::span<const Sphere>(balls), {}, keys);
  PairBuffer pairs;
  (void)spheres.self_pairs(pairs, kCanonical);
  note_pairs(t, "spheres", pairs);
  for (Sphere& ball : balls) ball.radius = 2.0F;
  (void)spheres.update(keys, std::span<const Sphere>(balls));
  (void)spheres.self_pairs(pairs, kCanonical);
  note_pairs(t, "larger spheres", pairs);
  query_kdops<14>(t, Volume::kdop14, balls);
  query_kdops<18>(t, Volume::kdop18, balls);
  query_kdops<26>(t, Volume::kdop26, balls);

  Eigen::Matrix4d matrix;
  matrix << 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0;
  const Frustum frustum = Frustum::from_matrix(matrix);
  for (const Plane& plane : frustum.planes) {
    note_real(t, "frustum", static_cast<double>(plane.offset));
  }
  note(t, "version", 1U << 8U);
  note(t, "abi", 1);
  note(t, "version name", std::string_view("0.1.0").size());
  note(t, "isa", 1);
  note(t, "status", 1);
}

}  // namespace winnow::test
