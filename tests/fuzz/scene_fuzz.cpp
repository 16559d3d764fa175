// All calls of a scene, compared with a scene that is built from scratch each time; its queries,
// including rays and moving shapes, are compared with tests of each single body.

#include <winnow/winnow.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/every_shape.h"
#include "tests/fuzz/target.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using KeyOrder = decltype([](const Key& a, const Key& b) {
  return std::pair(a.id, a.stamp) < std::pair(b.id, b.stamp);
});

/// A pair of bodies, the smaller id first, and the kinds of their shapes in that order: if a body
/// gets a shape of another kind, the pair begins anew.
struct BodyKindPair {
  Key a;
  Key b;
  std::uint32_t kinds[2];

  friend auto operator<=>(const BodyKindPair& x, const BodyKindPair& y) {
    const auto all = [](const BodyKindPair& m) {
      return std::tuple(m.a.id, m.b.id, m.a.stamp, m.b.stamp, m.kinds[0], m.kinds[1]);
    };
    return all(x) <=> all(y);
  }
  friend bool operator==(const BodyKindPair& x, const BodyKindPair& y) { return (x <=> y) == 0; }
};
using BodyPairSet = std::set<BodyKindPair>;

class Play {
 public:
  Play(Bytes& bytes, CountingMemory& memory);
  void step(Bytes& bytes);
  void check_memory(const CountingMemory& memory) const {
    WINNOW_REQUIRE(scene_->footprint().total().reserved + contacts_.footprint().total().reserved ==
                   memory.outstanding());
  }

 private:
  static SceneOptions some_options(Bytes& bytes, const EveryShape& shapes, CountingMemory& memory);

  void add(Bytes& bytes);
  void change(Bytes& bytes);
  void remove(Bytes& bytes);
  void misuse(Bytes& bytes);
  void collide(Bytes& bytes);
  void check_events();
  void check_fresh(ContactLevel level);
  void check_cached(const Contacts& fresh) const;
  void query(Bytes& bytes);
  void query_ray(Bytes& bytes, SceneQueries& queries);
  void query_cast(Bytes& bytes, SceneQueries& queries);
  void query_overlap(Bytes& bytes, SceneQueries& queries);
  void query_distance(SceneQueries& queries);

  [[nodiscard]] Pose some_pose(Bytes& bytes) const {
    Pose pose = bytes.pose();
    for (double& x : pose.position) x += far_;
    return pose;
  }
  [[nodiscard]] BodyDefinition* some_body(Bytes& bytes, Key& key);
  [[nodiscard]] BodyKindPair body_kind_pair(Key a, Key b) const;
  [[nodiscard]] double distance(ShapeId a, const Pose& at_a, ShapeId b, const Pose& at_b) const;

  EveryShape shapes_;
  double far_ = 0.0;
  SceneOptions options_;
  std::unique_ptr<Scene> scene_;
  Contacts contacts_;
  std::map<Key, BodyDefinition, KeyOrder> bodies_;
  BodyPairSet shown_;    // by the last frame
  BodyPairSet dormant_;  // pairs of two bodies that have rested since they were reported
  ContactLevel level_ = ContactLevel::pairs;
  std::uint64_t named_ = 0;
};

Play::Play(Bytes& bytes, CountingMemory& memory) : shapes_(bytes), contacts_(&memory) {
  constexpr double kFar[] = {0.0, 0.0, 1e4, 1e9};
  far_ = kFar[bytes.below(4)];
  options_ = some_options(bytes, shapes_, memory);
  scene_ = std::make_unique<Scene>(shapes_.pool, options_);
}

SceneOptions Play::some_options(Bytes& bytes, const EveryShape& shapes, CountingMemory& memory) {
  SceneOptions options{.memory = &memory, .composites = &shapes.composites};
  options.execution = bytes.chance(4) ? Execution::parallel() : Execution::serial();
  const auto all = all_structures();
  for (StructureKind& kind : options.structures) kind = all[bytes.below(all.size())];
  if (bytes.chance(2)) options.contact_margin = 0.25;
  if (bytes.chance(3)) options.cache_tolerance = 0.0625;
  options.warm_start = bytes.chance(2);
  return options;
}

BodyDefinition* Play::some_body(Bytes& bytes, Key& key) {
  if (bodies_.empty()) return nullptr;
  auto at = bodies_.lower_bound(Key{bytes.byte(), 0});
  if (at == bodies_.end()) at = bodies_.begin();
  key = at->first;
  return &at->second;
}

void Play::add(Bytes& bytes) {
  if (bodies_.size() > 40) return;
  std::vector<BodyDefinition> bodies(1 + bytes.below(6));
  for (BodyDefinition& body : bodies) {
    body.shape = shapes_.ids[bytes.below(shapes_.ids.size())];
    body.pose = some_pose(bytes);
    body.state = static_cast<BodyState>(bytes.below(3));
    body.data = named_++;
  }
  std::vector<Key> keys(bodies.size());
  WINNOW_REQUIRE(scene_->add(bodies, keys) == Status::ok);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    WINNOW_REQUIRE(bodies_.emplace(keys[i], bodies[i]).second);
  }
}

void Play::change(Bytes& bytes) {
  Key key;
  BodyDefinition* body = some_body(bytes, key);
  if (body == nullptr) return;
  switch (bytes.below(6)) {
    case 0:
      body->state = static_cast<BodyState>(bytes.below(3));
      WINNOW_REQUIRE(scene_->set_body_state(key, body->state) == Status::ok);
      break;
    case 1:
      body->shape = shapes_.ids[bytes.below(shapes_.ids.size())];
      WINNOW_REQUIRE(scene_->set_shape(key, body->shape) == Status::ok);
      break;
    case 2:
      body->filter = {1U << bytes.below(2), static_cast<unsigned>(1 + bytes.below(3)), 0};
      WINNOW_REQUIRE(scene_->set_filter(key, body->filter) == Status::ok);
      break;
    case 3: {
      const double step = 0.015625 * static_cast<double>(bytes.below(4));
      for (double& x : body->pose.position) x += step;
      WINNOW_REQUIRE(scene_->move(key, body->pose) == Status::ok);
      break;
    }
    default:
      body->pose = some_pose(bytes);
      WINNOW_REQUIRE(scene_->move(key, body->pose) == Status::ok);
  }
}

void Play::remove(Bytes& bytes) {
  Key key;
  if (some_body(bytes, key) == nullptr) return;
  const Key twice[] = {key, key};
  WINNOW_REQUIRE(scene_->remove(twice) == Status::invalid_key);
  WINNOW_REQUIRE(scene_->remove(key) == Status::ok);
  WINNOW_REQUIRE(scene_->remove(key) == Status::invalid_key);
  bodies_.erase(key);
}

/// Makes calls that must be refused; later checks notice if they changed anything.
void Play::misuse(Bytes& bytes) {
  const ShapeId bad{bytes.any<std::uint32_t>()};
  const bool there = shapes_.pool.contains(bad) || shapes_.composites.contains(bad);
  Key live;
  if (some_body(bytes, live) == nullptr) return;
  if (!there) {
    WINNOW_REQUIRE(scene_->set_shape(live, bad) == Status::invalid_key);
    const BodyDefinition bodies[] = {bodies_.at(live), {.shape = bad}};
    Key keys[2];
    WINNOW_REQUIRE(scene_->add(bodies, keys) == Status::invalid_key);
  }
  Pose pose;
  for (double& x : pose.position) x = bytes.any<double>();
  for (double& q : pose.orientation) q = bytes.any<double>();
  if (!pose.is_valid()) WINNOW_REQUIRE(scene_->move(live, pose) == Status::invalid_pose);
  const auto stale = bytes.any<Key>();
  if (!bodies_.contains(stale)) {
    const Key keys[] = {live, stale};
    WINNOW_REQUIRE(scene_->set_body_state(keys, BodyState::fixed) == Status::invalid_key);
    WINNOW_REQUIRE(scene_->remove(keys) == Status::invalid_key);
    WINNOW_REQUIRE(!scene_->contains(stale));
  }
}

void Play::collide(Bytes& bytes) {
  const auto level = static_cast<ContactLevel>(bytes.below(4));
  WINNOW_REQUIRE(scene_->collide(level, contacts_) == Status::ok);
  WINNOW_REQUIRE(scene_->size() == bodies_.size());
  check_events();
  if (level != ContactLevel::pairs) check_fresh(level);
}

BodyKindPair Play::body_kind_pair(Key a, Key b) const {
  if (b.id < a.id) std::swap(a, b);
  return {a, b, {bodies_.at(a).shape.kind_index(), bodies_.at(b).shape.kind_index()}};
}

void Play::check_events() {
  BodyPairSet before = shown_;
  // Contacts of another level do not continue the dormant pairs.
  if (level_ == contacts_.level()) before.insert(dormant_.begin(), dormant_.end());
  level_ = contacts_.level();
  shown_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const BodyKindPair pair = body_kind_pair(contacts_.a()[i], contacts_.b()[i]);
    WINNOW_REQUIRE(shown_.insert(pair).second);
    const bool persists = before.erase(pair) == 1;
    WINNOW_REQUIRE(persists == (contacts_.event()[i] == ContactEvent::persisted));
    const BodyDefinition& a = bodies_.at(contacts_.a()[i]);
    const BodyDefinition& b = bodies_.at(contacts_.b()[i]);
    WINNOW_REQUIRE(a.data == contacts_.data_a()[i] && b.data == contacts_.data_b()[i]);
    WINNOW_REQUIRE(a.state == BodyState::dynamic || b.state == BodyState::dynamic);
    WINNOW_REQUIRE(filters_allow(a.filter, b.filter));
  }
  for (const EndedContact& pair : contacts_.ended()) {
    const auto [a, b] =
        pair.a.id < pair.b.id ? std::pair(pair.a, pair.b) : std::pair(pair.b, pair.a);
    const auto same = [a = a, b = b](const BodyKindPair& m) { return m.a == a && m.b == b; };
    const auto at = std::find_if(before.begin(), before.end(), same);
    WINNOW_REQUIRE(at != before.end());
    before.erase(at);
  }
  // Pairs that were neither reported nor ended are of two bodies at rest.
  dormant_ = before;
  for (const BodyKindPair& pair : dormant_) {
    WINNOW_REQUIRE(bodies_.at(pair.a).state != BodyState::dynamic);
    WINNOW_REQUIRE(bodies_.at(pair.b).state != BodyState::dynamic);
  }
}

/// Compares all columns of contact m in two Contacts that must be equal.
bool same_manifold(const Contacts& a, const Contacts& b, std::size_t m) {
  if (a.part_a()[m] != b.part_a()[m] || a.part_b()[m] != b.part_b()[m]) return false;
  if (a.level() < ContactLevel::distance) return true;
  bool same = a.distance()[m] == b.distance()[m] && a.error_bound()[m] == b.error_bound()[m];
  for (int k = 0; k < 3; ++k) same = same && a.normal(k)[m] == b.normal(k)[m];
  if (a.level() != ContactLevel::manifold) return same;
  same = same && a.point_first()[m + 1] == b.point_first()[m + 1];
  for (std::size_t p = a.point_first()[m]; same && p < a.point_first()[m + 1]; ++p) {
    const ContactPoint x = a.contact(p);
    const ContactPoint y = b.contact(p);
    same = x.position == y.position && x.depth == y.depth && x.feature == y.feature;
  }
  return same;
}

void Play::check_fresh(ContactLevel level) {
  const bool uses_cache = options_.cache_tolerance > 0.0;
  Scene fresh(shapes_.pool, {.contact_margin = options_.contact_margin + (uses_cache ? 0.25 : 0.0),
                             .composites = &shapes_.composites});
  for (const auto& [key, body] : bodies_) {
    Key ignored;
    WINNOW_REQUIRE(fresh.add(body).get(ignored) == Status::ok);
  }
  Contacts contacts;
  WINNOW_REQUIRE(fresh.collide(uses_cache ? ContactLevel::distance : level, contacts) ==
                 Status::ok);
  if (uses_cache) return check_cached(contacts);
  WINNOW_REQUIRE(std::ranges::equal(contacts.data_a(), contacts_.data_a()));
  WINNOW_REQUIRE(std::ranges::equal(contacts.data_b(), contacts_.data_b()));
  WINNOW_REQUIRE(std::ranges::equal(contacts.manifold_first(), contacts_.manifold_first()));
  for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
    WINNOW_REQUIRE(same_manifold(contacts_, contacts, m));
  }
}

/// Checks that every touching pair is reported, and no pair that is farther than margin and
/// cache tolerance allow.
void Play::check_cached(const Contacts& fresh) const {
  std::map<std::pair<ClientData, ClientData>, double> least;
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    double& distance =
        least.emplace(std::pair(fresh.data_a()[i], fresh.data_b()[i]), kInfinity).first->second;
    for (std::size_t m = fresh.manifold_first()[i]; m < fresh.manifold_first()[i + 1]; ++m) {
      distance = std::min(distance, fresh.distance()[m]);
    }
  }
  std::set<std::pair<ClientData, ClientData>> shown;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const std::pair pair(contacts_.data_a()[i], contacts_.data_b()[i]);
    shown.insert(pair);
    WINNOW_REQUIRE(least.contains(pair));
    WINNOW_REQUIRE(least[pair] <= options_.contact_margin + options_.cache_tolerance + 1e-6);
  }
  for (const auto& [pair, distance] : least) {
    if (distance <= 0.0) WINNOW_REQUIRE(shown.contains(pair));
  }
}

double Play::distance(ShapeId a, const Pose& at_a, ShapeId b, const Pose& at_b) const {
  const ShapeId ids[] = {a, b};
  const Pose poses[] = {at_a, at_b};
  const BodyPair pair[] = {{0, 1}};
  NarrowPhase narrow;
  NarrowResult result;
  WINNOW_REQUIRE(narrow.collide(shapes_.pool, {ids, poses}, pair,
                                {.level = ContactLevel::distance, .tier = NarrowTier::reference},
                                result) == Status::ok);
  return result.distance()[0];
}

void Play::query_ray(Bytes& bytes, SceneQueries& queries) {
  ShapeRay ray;
  for (double& x : ray.origin) x = 0.25 * bytes.grid_value() + far_;
  for (double& x : ray.direction) x = bytes.grid_value();
  ray.max_t = bytes.chance(2) ? kInfinity : bytes.extent();
  SceneHit first;
  std::span<const SceneHit> all;
  const Status status = queries.closest(ray).get(first);
  if (ray.direction[0] == 0.0 && ray.direction[1] == 0.0 && ray.direction[2] == 0.0) {
    WINNOW_REQUIRE(status == Status::invalid_argument);
    return;
  }
  WINNOW_REQUIRE(status == Status::ok && queries.all(ray).get(all) == Status::ok);
  WINNOW_REQUIRE(all.empty() ? !first : first.key == all[0].key && first.t == all[0].t);
  std::map<Key, double, KeyOrder> hits;
  double before = 0.0;
  for (const SceneHit& hit : all) {
    WINNOW_REQUIRE(hit.t >= before && hits.emplace(hit.key, hit.t).second);
    before = hit.t;
  }
  for (const auto& [key, body] : bodies_) {
    if (body.shape.is_composite()) continue;
    ShapeHit hit;
    WINNOW_REQUIRE(cast_ray(shapes_.pool.tables(), body.shape, body.pose, ray).get(hit) ==
                   Status::ok);
    const auto at = hits.find(key);
    WINNOW_REQUIRE(hit.hit == (at != hits.end()));
    WINNOW_REQUIRE(!hit.hit || hit.t == at->second);
  }
}

void Play::query_cast(Bytes& bytes, SceneQueries& queries) {
  ShapeCast cast{.shape = shapes_.ids[bytes.below(shapes_.convex)], .pose = some_pose(bytes)};
  double square = 0.0;
  for (double& x : cast.direction) {
    x = 0.25 * bytes.grid_value();
    square += x * x;
  }
  if (square == 0.0) return;
  constexpr double kTolerance = 1e-6;
  SceneHit hit;
  WINNOW_REQUIRE(queries.closest(cast, {}, kTolerance).get(hit) == Status::ok);
  // No convex body overlaps the moving shape before the hit. At the hit, the hit body, if convex,
  // is at most four tolerances away.
  for (const auto& [key, body] : bodies_) {
    if (body.shape.is_composite()) continue;
    const double end = hit ? hit.t : cast.max_t;
    for (const double share : {0.3, 0.9, 1.0}) {
      Pose pose = cast.pose;
      for (int k = 0; k < 3; ++k) pose.position[k] += share * end * cast.direction[k];
      const double gap = distance(cast.shape, pose, body.shape, body.pose);
      const double noise = 1e-8 + 1e-15 * (std::sqrt(square) + far_);
      if (hit && hit.t == 0.0) break;
      WINNOW_REQUIRE(gap >= -noise);
      if (share == 1.0 && hit && key == hit.key) {
        WINNOW_REQUIRE(gap <= kTolerance * 4 + noise);
      }
    }
  }
}

void Play::query_overlap(Bytes& bytes, SceneQueries& queries) {
  const ShapeId shape = shapes_.ids[bytes.below(shapes_.ids.size())];
  const Pose pose = some_pose(bytes);
  std::span<const SceneOverlap> found;
  WINNOW_REQUIRE(queries.overlap(shape, pose).get(found) == Status::ok);
  WINNOW_REQUIRE(std::is_sorted(found.begin(), found.end(),
                                [](const auto& a, const auto& b) { return a.key.id < b.key.id; }));
  if (shape.is_composite()) return;
  for (const auto& [of_body, body] : bodies_) {
    if (body.shape.is_composite()) continue;
    const Key key = of_body;
    const bool is_found = std::any_of(found.begin(), found.end(),
                                      [&](const SceneOverlap& one) { return one.key == key; });
    WINNOW_REQUIRE(is_found == (distance(shape, pose, body.shape, body.pose) <= 0.0));
  }
}

void Play::query_distance(SceneQueries& queries) {
  if (bodies_.size() < 2) return;
  const auto& [a, body_a] = *bodies_.begin();
  const auto& [b, body_b] = *bodies_.rbegin();
  SceneDistance answer;
  WINNOW_REQUIRE(queries.distance(a, b, kInfinity, PairRules::none).get(answer) == Status::ok);
  if (body_a.shape.is_composite() || body_b.shape.is_composite()) return;
  const double truth = distance(body_a.shape, body_a.pose, body_b.shape, body_b.pose);
  WINNOW_REQUIRE(answer.distance == truth ||
                 std::abs(answer.distance - truth) <= 2.0 * answer.error_bound + 1e-12);
}

void Play::query(Bytes& bytes) {
  WINNOW_REQUIRE(scene_->refresh() == Status::ok);
  SceneQueries queries(*scene_);
  switch (bytes.below(4)) {
    case 0:
      return query_ray(bytes, queries);
    case 1:
      return query_cast(bytes, queries);
    case 2:
      return query_overlap(bytes, queries);
    default:
      return query_distance(queries);
  }
}

void Play::step(Bytes& bytes) {
  switch (bytes.below(10)) {
    case 0:
    case 1:
      return add(bytes);
    case 2:
    case 3:
    case 4:
      return change(bytes);
    case 5:
      return remove(bytes);
    case 6:
      return misuse(bytes);
    case 7:
      return query(bytes);
    default:
      return collide(bytes);
  }
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  CountingMemory memory;
  Play play(bytes, memory);
  for (int steps = 0; !bytes.empty() && steps < 100; ++steps) {
    play.step(bytes);
    play.check_memory(memory);
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(200, 800);
}

}  // namespace winnow::test
