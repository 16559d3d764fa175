// All calls of a partition, on two partitions, compared with a model that tests every pair.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/counting_memory.h"
#include "tests/support/reference.h"

namespace winnow::test {
namespace {

/// An object as it was inserted or last updated.
struct Given {
  Key key;
  Aabb box;
  std::optional<Sphere> sphere{};
  ClientData data = 0;
  ObjectFilter filter{};
};

bool sphere_overlaps(const Sphere& sphere, const Aabb& box) {
  const Vec3d c = sphere.center.cast<double>();
  const Vec3d nearest = c.max(box.min.cast<double>()).min(box.max.cast<double>());
  const auto r = static_cast<double>(sphere.radius);
  return (nearest - c).squared_norm() <= r * r;
}

/// Returns true if the pair must be reported.
bool must_pair(const Given& a, const Given& b) {
  if (!filters_allow(a.filter, b.filter) || !a.box.overlaps(b.box)) return false;
  if (a.sphere && b.sphere) return a.sphere->overlaps(*b.sphere);
  if (a.sphere) return sphere_overlaps(*a.sphere, b.box);
  return !b.sphere || sphere_overlaps(*b.sphere, a.box);
}

bool by_ids(const KeyPair& a, const KeyPair& b) {
  return std::pair(a.first.id, a.second.id) < std::pair(b.first.id, b.second.id);
}
bool by_keys(const KeyPair& a, const KeyPair& b) {
  const auto all = [](const KeyPair& p) {
    return std::tuple(p.first.id, p.second.id, p.first.stamp, p.second.stamp);
  };
  return all(a) < all(b);
}

std::vector<KeyPair> without(const std::vector<KeyPair>& all, const std::vector<KeyPair>& others) {
  std::vector<KeyPair> rest;
  std::set_difference(all.begin(), all.end(), others.begin(), others.end(),
                      std::back_inserter(rest), by_keys);
  return rest;
}

StructureKind some_structure(Bytes& bytes) {
  const auto all = all_structures();
  const StructureKind kind = all[bytes.below(all.size())];
  if (kind == loose_octree())
    return loose_octree(1.125F + 0.25F * static_cast<float>(bytes.below(28)));
  return kind;
}

PartitionOptions some_options(Bytes& bytes, std::pmr::memory_resource* memory) {
  PartitionOptions options{.memory = memory};
  options.execution = bytes.chance(4) ? Execution::parallel() : Execution::serial();
  constexpr Volume kVolumes[] = {Volume::aabb,   Volume::aabb,   Volume::aabb,  Volume::sphere,
                                 Volume::kdop14, Volume::kdop18, Volume::kdop26};
  options.volume = kVolumes[bytes.below(std::size(kVolumes))];
  if (bytes.chance(3)) options.fat_margin = {static_cast<float>(bytes.extent()), 0.05F};
  constexpr std::size_t kBudgets[] = {0, 1, 7, 40, ~std::size_t{0}};
  options.build_budget = kBudgets[bytes.below(std::size(kBudgets))];
  return options;
}

/// A partition, the objects that it must contain, and the pairs that its events imply.
class Model {
 public:
  Model(Bytes& bytes, CountingMemory& memory)
      : partition_(some_structure(bytes), some_options(bytes, &memory)), tracked_(&memory) {}

  [[nodiscard]] const Partition& partition() const { return partition_; }
  [[nodiscard]] const std::map<ObjectId, Given>& objects() const { return objects_; }
  [[nodiscard]] std::size_t reserved() const {
    return partition_.footprint().total().reserved + tracked_.footprint().total().reserved;
  }

  void step(Bytes& bytes, const Model& other);
  void check_objects() const;
  void check_cross(const Model& other) const;
  void query(Bytes& bytes);

 private:
  void insert(Bytes& bytes);
  void insert_spheres(Bytes& bytes);
  void update(Bytes& bytes);
  void update_entries(Bytes& bytes);
  void remove(Bytes& bytes);
  void set_filters(Bytes& bytes);
  void empty_or_reserve(Bytes& bytes);
  void misuse(Bytes& bytes, const Model& other);
  void query_events();
  void query_only_changes();

  [[nodiscard]] std::vector<Key> some_keys(Bytes& bytes) const;
  [[nodiscard]] std::vector<Aabb> some_boxes(Bytes& bytes, std::size_t count) const;
  [[nodiscard]] bool takes(const Aabb& box) const {
    return box.is_valid() && (partition_.volume() != Volume::sphere ||
                              (box.min.all_finite() && box.max.all_finite()));
  }
  void check_pairs(std::span<const Pair> got) const;
  [[nodiscard]] std::vector<KeyPair> keyed(std::span<const Pair> pairs) const;
  static void check_events(const PairEvents& events, std::vector<KeyPair>& before,
                           std::vector<KeyPair> now);

  Partition partition_;
  std::map<ObjectId, Given> objects_;
  std::vector<Key> stale_;
  PairBuffer tracked_;
  PairEvents events_;
  std::vector<KeyPair> tracked_pairs_;  // of the last frame, sorted by keys
  PairEvents only_changes_events_;
  std::vector<KeyPair> only_changes_pairs_;
};

std::vector<Key> Model::some_keys(Bytes& bytes) const {
  std::vector<Key> keys;
  if (objects_.empty()) return keys;
  const std::size_t count = 1 + bytes.below(bytes.chance(4) ? 200 : 6);
  auto at = std::next(objects_.begin(),
                      static_cast<std::ptrdiff_t>(bytes.any<std::uint16_t>() % objects_.size()));
  const std::size_t stride = 1 + bytes.below(3);
  while (keys.size() < count && at != objects_.end()) {
    keys.push_back(at->second.key);
    for (std::size_t i = 0; i < stride && at != objects_.end(); ++i) ++at;
  }
  return keys;
}

std::vector<Aabb> Model::some_boxes(Bytes& bytes, std::size_t count) const {
  std::vector<Aabb> boxes;
  Aabb box = bytes.box();
  const Vec3f step(static_cast<float>(bytes.extent()), static_cast<float>(bytes.extent()),
                   static_cast<float>(bytes.extent()));
  // Half of the time, repeats one box in steps, so that few bytes make many objects.
  const bool repeats = bytes.chance(2);
  for (std::size_t i = 0; i < count; ++i) {
    boxes.push_back(takes(box) ? box : bytes.grid_box());
    if (!repeats) {
      box = bytes.box();
    } else {
      box.min += step;
      box.max += step;
    }
  }
  return boxes;
}

void Model::insert(Bytes& bytes) {
  if (objects_.size() > 300) return;
  const std::size_t count = 1 + bytes.below(bytes.chance(3) ? 60 : 6);
  const std::vector<Aabb> boxes = some_boxes(bytes, count);
  std::vector<ClientData> data(count);
  for (std::size_t i = 0; i < count; ++i) data[i] = (objects_.size() + i) * 31;
  std::vector<Key> keys(count);
  const Status status = partition_.insert(boxes, data, keys);
  if (status != Status::ok) {
    // A sphere around a huge box may not be finite.
    WINNOW_REQUIRE(partition_.volume() == Volume::sphere && status == Status::invalid_bounds);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    WINNOW_REQUIRE(!objects_.contains(keys[i].id));
    objects_[keys[i].id] = {keys[i], boxes[i], {}, data[i], {}};
  }
}

void Model::insert_spheres(Bytes& bytes) {
  const Vec3f center(static_cast<float>(bytes.grid_value()), static_cast<float>(bytes.grid_value()),
                     static_cast<float>(bytes.grid_value()));
  const Sphere sphere{center, static_cast<float>(bytes.extent())};
  Key key;
  const Status status = partition_.insert({&sphere, 1}, {}, {&key, 1});
  if (partition_.volume() != Volume::sphere) {
    WINNOW_REQUIRE(status == Status::unsupported_volume && key == Key{});
    return;
  }
  WINNOW_REQUIRE(status == Status::ok);
  objects_[key.id] = {key, sphere.bounds(), sphere, 0, {}};
}

void Model::update(Bytes& bytes) {
  const std::vector<Key> keys = some_keys(bytes);
  if (keys.empty()) return;
  std::vector<Aabb> boxes;
  if (bytes.chance(2)) {
    boxes = some_boxes(bytes, keys.size());
  } else {
    // Moves each box a little, or not at all.
    const auto step = static_cast<float>(bytes.extent() * (bytes.chance(2) ? 0.0625 : 0.0));
    for (const Key& key : keys) {
      Aabb box = objects_.at(key.id).box;
      box.min += Vec3f::constant(step);
      box.max += Vec3f::constant(step);
      boxes.push_back(takes(box) ? box : objects_.at(key.id).box);
    }
  }
  const Status status = partition_.update(keys, boxes);
  if (status != Status::ok) {
    WINNOW_REQUIRE(partition_.volume() == Volume::sphere && status == Status::invalid_bounds);
    return;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Given& given = objects_.at(keys[i].id);
    given.box = boxes[i];
    given.sphere.reset();
  }
}

void Model::update_entries(Bytes& bytes) {
  const std::vector<Key> keys = some_keys(bytes);
  if (keys.empty()) return;
  std::vector<Aabb> boxes;
  for (const Key& key : keys) boxes.push_back(objects_.at(key.id).box);
  std::vector<std::uint32_t> listed;
  std::vector<std::uint64_t> words((keys.size() + 63) / 64);
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    if (!bytes.chance(2)) continue;
    listed.push_back(i);
    words[i / 64] |= 1ULL << i % 64;
    boxes[i] = bytes.grid_box();
  }
  const IndexSubset entries =
      bytes.chance(2) ? IndexSubset::listed(listed) : IndexSubset::masked(words);
  WINNOW_REQUIRE(partition_.update(keys, boxes, entries) == Status::ok);
  for (const std::uint32_t i : listed) {
    Given& given = objects_.at(keys[i].id);
    given.box = boxes[i];
    given.sphere.reset();
  }
}

void Model::remove(Bytes& bytes) {
  const std::vector<Key> keys = some_keys(bytes);
  WINNOW_REQUIRE(partition_.remove(keys) == Status::ok);
  for (const Key& key : keys) {
    objects_.erase(key.id);
    if (stale_.size() < 4) stale_.push_back(key);
  }
}

void Model::set_filters(Bytes& bytes) {
  const std::vector<Key> keys = some_keys(bytes);
  std::vector<ObjectFilter> filters;
  for (const Key& key : keys) {
    ObjectFilter filter;
    const std::size_t choice = bytes.below(8);
    if (choice < 4)
      filter.environment = choice == 3 ? kAllEnvironments : static_cast<unsigned>(choice);
    if (choice >= 4) filter = {1U << choice % 3, static_cast<unsigned>(bytes.below(8)), 0};
    filters.push_back(filter);
    objects_.at(key.id).filter = filter;
  }
  WINNOW_REQUIRE(partition_.set_filter(keys, filters) == Status::ok);
}

void Model::empty_or_reserve(Bytes& bytes) {
  switch (bytes.below(4)) {
    case 0:
      for (const auto& [id, given] : objects_) {
        if (stale_.size() < 4) stale_.push_back(given.key);
      }
      objects_.clear();
      partition_.clear();
      break;
    case 1:
      partition_.release_memory();
      break;
    case 2:
      WINNOW_REQUIRE(partition_.reserve(bytes.any<std::uint16_t>() % 2000) == Status::ok);
      break;
    default:
      WINNOW_REQUIRE(partition_.refresh() == Status::ok);
  }
}

/// Makes calls that must be refused; later checks notice if they changed anything.
void Model::misuse(Bytes& bytes, const Model& other) {
  const Key live = objects_.empty() ? Key{} : objects_.begin()->second.key;
  Key bad = bytes.any<Key>();
  if (!stale_.empty() && bytes.chance(2)) bad = stale_[bytes.below(stale_.size())];
  if (!other.objects_.empty() && bytes.chance(3)) bad = other.objects_.begin()->second.key;
  const auto of_bad = objects_.find(bad.id);
  if (of_bad != objects_.end() && of_bad->second.key == bad) return;
  const Aabb box = bytes.grid_box();
  const Key keys[] = {live, bad};
  const Aabb boxes[] = {box, box};
  WINNOW_REQUIRE(partition_.update(keys, boxes) == Status::invalid_key);
  WINNOW_REQUIRE(partition_.remove(keys) == Status::invalid_key);
  WINNOW_REQUIRE(!partition_.contains(bad));
  const ObjectFilter filters[2] = {{2, 2, 2}, {2, 2, 2}};
  WINNOW_REQUIRE(partition_.set_filter(keys, filters) == Status::invalid_key);
  WINNOW_REQUIRE(partition_.set_structure(StructureKind{}) == Status::invalid_argument);
  if (live == Key{}) return;
  const Key twice[] = {live, live};
  WINNOW_REQUIRE(partition_.remove(twice) == Status::invalid_key);
  WINNOW_REQUIRE(partition_.update(twice, BoxView(std::span(boxes, 1))) == Status::size_mismatch);
  const std::uint32_t none[] = {1};
  WINNOW_REQUIRE(partition_.update({&live, 1}, BoxView(std::span(boxes, 1)),
                                   IndexSubset::listed(none)) == Status::invalid_argument);
  Aabb wild{{bytes.wild(), bytes.wild(), bytes.wild()}, {bytes.wild(), bytes.wild(), bytes.wild()}};
  if (wild.is_valid()) return;
  const Aabb mixed[] = {box, wild};
  Key out[2];
  WINNOW_REQUIRE(partition_.insert(mixed, {}, out) == Status::invalid_bounds && out[0] == Key{});
  WINNOW_REQUIRE(partition_.update(live, wild) == Status::invalid_bounds);
}

void Model::check_objects() const {
  WINNOW_REQUIRE(partition_.size() == objects_.size());
  for (const auto& [id, given] : objects_) {
    WINNOW_REQUIRE(partition_.contains(given.key) && partition_.key_of(id) == given.key);
    Aabb stored;
    WINNOW_REQUIRE(partition_.bounds(given.key).get(stored) == Status::ok);
    WINNOW_REQUIRE(stored.min.min(given.box.min) == stored.min &&
                   stored.max.max(given.box.max) == stored.max);
    WINNOW_REQUIRE(partition_.client_data_of(id) == given.data);
    ObjectFilter filter;
    WINNOW_REQUIRE(partition_.filter(given.key).get(filter) == Status::ok &&
                   filter == given.filter);
  }
}

void Model::check_pairs(std::span<const Pair> got) const {
  std::vector<Pair> pairs(got.begin(), got.end());
  std::sort(pairs.begin(), pairs.end());
  WINNOW_REQUIRE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
  auto at = pairs.begin();
  // Only n_squared and partitions of spheres may report pairs whose stored boxes are apart: spheres
  // are rounded outward.
  const bool prunes =
      partition_.structure() != n_squared() && partition_.volume() != Volume::sphere;
  std::map<ObjectId, Aabb> stored;
  for (const auto& [id, given] : objects_) stored[id] = partition_.bounds(given.key);
  for (auto a = objects_.begin(); a != objects_.end(); ++a) {
    for (auto b = std::next(a); b != objects_.end(); ++b) {
      const bool must = must_pair(a->second, b->second);
      if (at == pairs.end() || *at != Pair{a->first, b->first}) {
        WINNOW_REQUIRE(!must);
        continue;
      }
      ++at;
      WINNOW_REQUIRE(filters_allow(a->second.filter, b->second.filter));
      WINNOW_REQUIRE(must || !partition_.is_exact());
      WINNOW_REQUIRE(!prunes || stored[a->first].overlaps(stored[b->first]));
    }
  }
  // Remaining pairs would have an unknown object, or their ids in the wrong order.
  WINNOW_REQUIRE(at == pairs.end());
}

std::vector<KeyPair> Model::keyed(std::span<const Pair> pairs) const {
  std::vector<KeyPair> keyed;
  for (const Pair& pair : pairs) {
    keyed.push_back({objects_.at(pair.first).key, objects_.at(pair.second).key});
  }
  std::sort(keyed.begin(), keyed.end(), by_keys);
  return keyed;
}

void Model::check_events(const PairEvents& events, std::vector<KeyPair>& before,
                         std::vector<KeyPair> now) {
  const std::vector<KeyPair> begun = without(now, before);
  std::vector<KeyPair> ended = without(before, now);
  std::vector<KeyPair> reported(events.ended().begin(), events.ended().end());
  WINNOW_REQUIRE(std::is_sorted(reported.begin(), reported.end(), by_ids));
  std::sort(reported.begin(), reported.end(), by_keys);
  WINNOW_REQUIRE(std::ranges::equal(events.begun(), begun));
  WINNOW_REQUIRE(reported == ended);
  WINNOW_REQUIRE(events.persisting() == now.size() - begun.size());
  before = std::move(now);
}

void Model::query(Bytes& bytes) {
  // A pair buffer is updated in place only until another buffer receives the full result. Therefore
  // half of the queries make no full query.
  if (bytes.chance(2)) return query_events();
  if (bytes.chance(4)) return query_only_changes();
  PairBuffer fresh;
  const Order order = bytes.chance(2) ? Order::canonical : Order::fast;
  WINNOW_REQUIRE(partition_.self_pairs(fresh, {.order = order, .incremental = false}) ==
                 Status::ok);
  WINNOW_REQUIRE(order == Order::fast || std::is_sorted(fresh.begin(), fresh.end()));
  check_pairs(fresh.pairs());
  const PairPredicate odd{[](void*, ObjectId a, ObjectId b) { return (a ^ b) % 3 != 0; }, nullptr};
  PairBuffer chosen;
  WINNOW_REQUIRE(partition_.self_pairs(chosen, {.incremental = false, .predicate = odd}) ==
                 Status::ok);
  const auto accepted = std::count_if(fresh.begin(), fresh.end(), [&](const Pair& pair) {
    return odd.accept(nullptr, pair.first, pair.second);
  });
  WINNOW_REQUIRE(chosen.size() == static_cast<std::size_t>(accepted));
}

void Model::query_events() {
  WINNOW_REQUIRE(partition_.self_pairs(tracked_, events_) == Status::ok);
  check_pairs(tracked_.pairs());
  check_events(events_, tracked_pairs_, keyed(tracked_.pairs()));
  const auto begun = tracked_.pairs().subspan(events_.persisting());
  WINNOW_REQUIRE(std::ranges::equal(begun, events_.begun(), [](const Pair& a, const KeyPair& b) {
    return a == Pair{b.first.id, b.second.id};
  }));
}

void Model::query_only_changes() {
  WINNOW_REQUIRE(partition_.self_pairs(only_changes_events_) == Status::ok);
  PairBuffer all;
  WINNOW_REQUIRE(partition_.self_pairs(all, {.incremental = false}) == Status::ok);
  check_events(only_changes_events_, only_changes_pairs_, keyed(all.pairs()));
}

void Model::check_cross(const Model& other) const {
  PairBuffer buffer;
  WINNOW_REQUIRE(partition_.pairs_with(other.partition_, buffer) == Status::ok);
  std::vector<Pair> pairs(buffer.begin(), buffer.end());
  std::sort(pairs.begin(), pairs.end());
  WINNOW_REQUIRE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
  for (const auto& [a, mine] : objects_) {
    for (const auto& [b, theirs] : other.objects_) {
      const bool got = std::binary_search(pairs.begin(), pairs.end(), Pair{a, b});
      WINNOW_REQUIRE(got || !must_pair(mine, theirs));
      WINNOW_REQUIRE(!got || filters_allow(mine.filter, theirs.filter));
    }
  }
}

void Model::step(Bytes& bytes, const Model& other) {
  switch (bytes.below(16)) {
    case 0:
    case 1:
    case 2:
      return insert(bytes);
    case 3:
      return insert_spheres(bytes);
    case 4:
    case 5:
    case 6:
      return update(bytes);
    case 7:
      return update_entries(bytes);
    case 8:
      return remove(bytes);
    case 9:
      return set_filters(bytes);
    case 10:
      WINNOW_REQUIRE(partition_.set_structure(some_structure(bytes)) == Status::ok);
      return;
    case 11:
      return empty_or_reserve(bytes);
    case 12:
      return misuse(bytes, other);
    case 13:
      return check_cross(other);
    default:
      return query(bytes);
  }
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  CountingMemory memory;
  Model models[2] = {{bytes, memory}, {bytes, memory}};
  std::size_t current = 0;
  for (int steps = 0; !bytes.empty() && steps < 200; ++steps) {
    if (bytes.chance(8)) current = 1 - current;
    models[current].step(bytes, models[1 - current]);
    WINNOW_REQUIRE(models[0].reserved() + models[1].reserved() == memory.outstanding());
  }
  for (Model& model : models) {
    model.check_objects();
    model.query(bytes);
  }
  models[0].check_cross(models[1]);
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(300, 1500);
}

}  // namespace winnow::test
