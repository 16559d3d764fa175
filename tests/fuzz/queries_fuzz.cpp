// Rays, casts, regions and nearest objects: two structures are compared with a brute-force
// reference, and bit by bit with each other.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <deque>
#include <map>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/queries/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

Vector3f grid_vector(Bytes& bytes) {
  return {static_cast<float>(bytes.grid_value()), static_cast<float>(bytes.grid_value()),
          static_cast<float>(bytes.grid_value())};
}

/// Two partitions with the same objects.
class Pairing {
 public:
  Pairing(Bytes& bytes, CountingMemory& memory)
      : a_(structure(bytes), options(bytes, memory)),
        b_(structure(bytes), options(bytes, memory)) {}

  void step(Bytes& bytes);
  void check_memory(const CountingMemory& memory) const {
    WINNOW_REQUIRE(a_.footprint().total().reserved + b_.footprint().total().reserved ==
                   memory.outstanding());
  }

 private:
  static StructureKind structure(Bytes& bytes) {
    return all_structures()[bytes.below(all_structures().size())];
  }
  static PartitionOptions options(Bytes& bytes, CountingMemory& memory) {
    return {.memory = &memory,
            .execution = bytes.chance(4) ? Execution::parallel() : Execution::serial()};
  }

  void insert(Bytes& bytes);
  void change(Bytes& bytes);
  void cast(Bytes& bytes);
  void batch(Bytes& bytes);
  void region(Bytes& bytes);
  void boxes(Bytes& bytes);
  void nearest(Bytes& bytes);

  [[nodiscard]] Cast some_cast(Bytes& bytes) const;
  [[nodiscard]] Region some_region(Bytes& bytes);
  /// Returns the objects that pass a filter.
  [[nodiscard]] std::vector<Object> seen(const Filter& filter) const;
  static Filter some_filter(Bytes& bytes);

  Partition a_;
  Partition b_;
  std::map<ObjectId, Object> objects_;
  std::vector<Plane> planes_;
};

void Pairing::insert(Bytes& bytes) {
  if (objects_.size() > 250) return;
  const std::size_t count = 1 + bytes.below(bytes.chance(3) ? 70 : 5);
  const Vector3f step = grid_vector(bytes) * 0.0625F;
  Aabb box = bytes.box();
  for (std::size_t i = 0; i < count; ++i) {
    Key keys[2];
    const Status status = a_.insert(box, i).get(keys[0]);
    WINNOW_REQUIRE(status == b_.insert(box, i).get(keys[1]));
    WINNOW_REQUIRE((status == Status::ok) == box.is_valid());
    if (status != Status::ok) break;
    WINNOW_REQUIRE(keys[0].id == keys[1].id);
    objects_[keys[0].id] = {keys[0].id, box, {}};
    box.min += step;
    box.max += step;
  }
}

void Pairing::change(Bytes& bytes) {
  if (objects_.empty()) return;
  const std::size_t count = 1 + bytes.below(8);
  for (std::size_t i = 0; i < count && !objects_.empty(); ++i) {
    auto at = objects_.lower_bound(static_cast<ObjectId>(bytes.byte()));
    if (at == objects_.end()) at = objects_.begin();
    Object& object = at->second;
    const Key keys[2] = {a_.key_of(object.id), b_.key_of(object.id)};
    switch (bytes.below(4)) {
      case 0:
        WINNOW_REQUIRE(a_.remove(keys[0]) == Status::ok && b_.remove(keys[1]) == Status::ok);
        objects_.erase(at);
        break;
      case 1:
        object.filter = {1U << bytes.below(3), static_cast<unsigned>(bytes.below(8)),
                         static_cast<unsigned>(bytes.below(2))};
        WINNOW_REQUIRE(a_.set_filter(keys[0], object.filter) == Status::ok);
        WINNOW_REQUIRE(b_.set_filter(keys[1], object.filter) == Status::ok);
        break;
      default: {
        const Aabb box = bytes.grid_box();
        WINNOW_REQUIRE(a_.update(keys[0], box) == Status::ok);
        WINNOW_REQUIRE(b_.update(keys[1], box) == Status::ok);
        object.box = box;
      }
    }
  }
}

Filter Pairing::some_filter(Bytes& bytes) {
  Filter filter;
  if (!bytes.chance(3)) return filter;
  filter.layers = static_cast<unsigned>(bytes.below(8));
  filter.mask = static_cast<unsigned>(bytes.below(8));
  filter.environment = bytes.chance(2) ? kAllEnvironments : static_cast<unsigned>(bytes.below(3));
  if (bytes.chance(2)) {
    filter.predicate.accept = [](void*, Key key, ClientData) { return key.id % 3 != 0; };
  }
  return filter;
}

std::vector<Object> Pairing::seen(const Filter& filter) const {
  std::vector<Object> seen;
  for (const auto& [id, object] : objects_) {
    const bool accepted =
        filter.predicate.accept == nullptr || filter.predicate.accept(nullptr, a_.key_of(id), 0);
    if (accepted && filters_allow(filter.object(), object.filter)) seen.push_back(object);
  }
  return seen;
}

Cast Pairing::some_cast(Bytes& bytes) const {
  Vector3f direction = grid_vector(bytes);
  if (bytes.chance(4)) direction *= 1e-20F;
  if (direction.isZero(0.0F)) direction = Vector3f::UnitY();
  const float min_t = bytes.chance(4) ? 0.5F : 0.0F;
  const float max_t =
      bytes.chance(2) ? std::numeric_limits<float>::infinity() : min_t + 0.25F * bytes.byte();
  const Vector3f at = grid_vector(bytes);
  const auto size = static_cast<float>(bytes.extent());
  switch (bytes.below(4)) {
    case 0:
      return Ray{at, direction, min_t, max_t};
    case 1:
      return BoxCast{{at, at + Vector3f::Constant(size)}, direction, min_t, max_t};
    case 2:
      return SphereCast{{at, size}, direction, min_t, max_t};
    default:
      return CapsuleCast{{at, grid_vector(bytes), size}, direction, min_t, max_t};
  }
}

Region Pairing::some_region(Bytes& bytes) {
  const Vector3f at = grid_vector(bytes);
  const auto size = static_cast<float>(bytes.extent());
  switch (bytes.below(7)) {
    case 0:
      return at;
    case 1:
      return bytes.grid_box();
    case 2: {
      OrientedBox box{at, Vector3f(size, 1.0F, 2.0F), Eigen::Matrix3f::Identity()};
      for (int i = 0; i < 3; ++i) box.axes.set_column(i, grid_vector(bytes) * 0.125F);
      return box;
    }
    case 3:
      return Sphere{at, size};
    case 4:
      return Capsule{at, grid_vector(bytes), size};
    case 5: {
      const Frustum frustum = Frustum::perspective(at, grid_vector(bytes), grid_vector(bytes), 1.0F,
                                                   1.5F, 0.125F, 0.125F + size);
      return frustum;
    }
    default:
      planes_.clear();
      for (std::size_t i = bytes.below(5); i-- != 0;) {
        planes_.push_back({grid_vector(bytes), static_cast<float>(bytes.grid_value())});
      }
      return std::span<const Plane>(planes_);
  }
}

void Pairing::cast(Bytes& bytes) {
  const Cast question = some_cast(bytes);
  const Filter filter = some_filter(bytes);
  HitBuffer hits;
  HitBuffer others;
  Hit first;
  Hit any;
  WINNOW_REQUIRE(a_.all(question, hits, filter) == Status::ok);
  WINNOW_REQUIRE(right_hits(hits.hits(), candidates(question, seen(filter)), a_));
  WINNOW_REQUIRE(a_.closest(question, filter).get(first) == Status::ok);
  WINNOW_REQUIRE(is_first_of(first, hits.hits()));
  WINNOW_REQUIRE(a_.any(question, filter).get(any) == Status::ok);
  WINNOW_REQUIRE(is_any_of(any, hits.hits()));
  WINNOW_REQUIRE(b_.all(question, others, filter) == Status::ok);
  WINNOW_REQUIRE(std::ranges::equal(hits, others, [](const Hit& x, const Hit& y) {
    return x.key.id == y.key.id && x.data == y.data && x.t == y.t;
  }));
}

void Pairing::batch(Bytes& bytes) {
  std::vector<Ray> rays(1 + bytes.below(40));
  Ray ray{grid_vector(bytes), grid_vector(bytes)};
  if (ray.direction.is_zero()) ray.direction = Vector3f::UnitZ();
  const Vector3f step = grid_vector(bytes) * 0.0625F;
  for (Ray& one : rays) {
    one = ray;
    ray.origin += step;
  }
  const Filter filter = some_filter(bytes);
  std::vector<Key> keys(rays.size());
  std::vector<float> t(rays.size());
  HitBuffer lists;
  WINNOW_REQUIRE(a_.closest(rays, {keys.data(), nullptr, t.data()}, filter) == Status::ok);
  WINNOW_REQUIRE(b_.all(RayBatch(rays), lists, filter) == Status::ok);
  HitBuffer hits;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    WINNOW_REQUIRE(b_.all(rays[i], hits, filter) == Status::ok);
    WINNOW_REQUIRE(same_hits(hits.hits(), lists.of(i)));
    const Hit first = hits.empty() ? Hit{} : hits[0];
    WINNOW_REQUIRE(first.key.id == keys[i].id && first.t == t[i]);
  }
  rays[bytes.below(rays.size())].direction = {};
  WINNOW_REQUIRE(a_.all(RayBatch(rays), lists, filter) == Status::invalid_argument);
}

void Pairing::region(Bytes& bytes) {
  const Region question = some_region(bytes);
  const Filter filter = some_filter(bytes);
  const Order order = bytes.chance(2) ? Order::fast : Order::canonical;
  OverlapBuffer found;
  const Status status = a_.overlap(question, found, filter, order);
  OverlapBuffer others;
  WINNOW_REQUIRE(b_.overlap(question, others, filter, order) == status);
  if (status != Status::ok) {
    WINNOW_REQUIRE(status == Status::invalid_argument || status == Status::invalid_bounds);
    return;
  }
  const RegionCandidates truth = candidates(question, seen(filter));
  WINNOW_REQUIRE(right_objects(found, truth, order));
  WINNOW_REQUIRE(right_objects(others, truth, order));
}

void Pairing::boxes(Bytes& bytes) {
  std::vector<Aabb> query_boxes(1 + bytes.below(20));
  for (Aabb& box : query_boxes) box = bytes.grid_box();
  const Filter filter = some_filter(bytes);
  PairBuffer found;
  WINNOW_REQUIRE(a_.overlap(BoxView(query_boxes), found, filter, Order::canonical) == Status::ok);
  std::vector<Pair> truth;
  const std::vector<Object> objects = seen(filter);
  for (std::uint32_t i = 0; i < query_boxes.size(); ++i) {
    for (const Object& object : objects) {
      if (query_boxes[i].overlaps(object.box)) truth.push_back({i, object.id});
    }
  }
  WINNOW_REQUIRE(std::ranges::equal(found, truth));
}

void Pairing::nearest(Bytes& bytes) {
  const Aabb from = bytes.grid_box();
  const std::size_t count = bytes.below(20);
  const float radius =
      bytes.chance(3) ? std::numeric_limits<float>::infinity() : 0.5F * bytes.byte();
  const Filter filter = some_filter(bytes);
  HitBuffer hits;
  HitBuffer others;
  WINNOW_REQUIRE(a_.nearest(from, count, radius, hits, filter) == Status::ok);
  WINNOW_REQUIRE(right_nearest(hits.hits(), from, count, radius, seen(filter), a_));
  WINNOW_REQUIRE(b_.nearest(from, count, radius, others, filter) == Status::ok);
  WINNOW_REQUIRE(std::ranges::equal(
      hits, others, [](const Hit& x, const Hit& y) { return x.key.id == y.key.id && x.t == y.t; }));
}

void Pairing::step(Bytes& bytes) {
  switch (bytes.below(10)) {
    case 0:
    case 1:
    case 2:
      return insert(bytes);
    case 3:
      return change(bytes);
    case 4:
    case 5:
      return cast(bytes);
    case 6:
      return batch(bytes);
    case 7:
      return region(bytes);
    case 8:
      return boxes(bytes);
    default:
      return nearest(bytes);
  }
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  CountingMemory memory;
  const auto isas = available_isas();
  const IsaScope isa(isas[bytes.below(isas.size())]);
  Pairing pairing(bytes, memory);
  for (int steps = 0; !bytes.empty() && steps < 100; ++steps) {
    pairing.step(bytes);
    pairing.check_memory(memory);
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(200, 600);
}

}  // namespace winnow::test
