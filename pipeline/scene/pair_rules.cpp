// Rules about pairs beyond sets and object filters: layers, ignored pairs and the caller's
// predicate. SceneState::find_pairs and ContinuousCollision apply them through `may_pair`, queries
// about two bodies or sets through `accepts_pair`.

#include "pipeline/scene/pair_rules.h"

#include "core/hooks/log.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

/// Marks an ignored pair for removal. Ids are below kMaxBodies and leave this bit free.
constexpr std::uint64_t kMark = std::uint64_t{1} << 63U;

[[nodiscard]] std::uint64_t pair_number(ObjectId a, ObjectId b) noexcept {
  return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

}  // namespace

Status Scene::set_ignored(Key a, Key b, bool ignored) {
  const KeyPair pair{a, b};
  return set_ignored({&pair, 1}, ignored);
}

Status Scene::set_ignored(std::span<const KeyPair> pairs, bool ignored) {
  if (state_ == nullptr) return Status::out_of_memory;
  SceneState& s = *state_;
  for (const KeyPair& pair : pairs) {
    if (!s.keys.is_valid(pair.first) || !s.keys.is_valid(pair.second)) return Status::invalid_key;
    if (pair.first == pair.second) return Status::invalid_argument;
  }
  if (!pairs.empty()) {
    if (ignored && !s.rules.add_ignored(pairs, s.shape.size())) return Status::out_of_memory;
    if (!ignored) s.rules.remove_ignored(pairs);
    s.invalidate_pairs();
  }
  if (s.observer != nullptr) s.observer->set_ignored(pairs, ignored);
  return Status::ok;
}

bool BodyPairRules::add_ignored(std::span<const KeyPair> key_pairs, std::size_t bodies) noexcept {
  const std::size_t before = ignored.size();
  const std::size_t all = before + key_pairs.size();
  const std::size_t known = ignores.size();
  if (!ignored.grow(all + key_pairs.size()) || !ignores.grow(bodies)) return false;
  ignores.set_size(bodies);
  std::fill(ignores.begin() + known, ignores.end(), std::uint8_t{0});
  // The new pairs are sorted beyond the end of the merged list.
  ignored.set_size(all + key_pairs.size());
  std::uint64_t* const added = ignored.data() + all;
  for (std::size_t i = 0; i < key_pairs.size(); ++i) {
    added[i] = pair_number(key_pairs[i].first.id, key_pairs[i].second.id);
    ignores[key_pairs[i].first.id] = ignores[key_pairs[i].second.id] = 1;
  }
  std::sort(added, added + key_pairs.size());
  std::size_t old = before;
  std::size_t own = key_pairs.size();
  for (std::size_t to = all; own > 0; --to) {
    const bool takes_old = old > 0 && ignored[old - 1] > added[own - 1];
    ignored[to - 1] = takes_old ? ignored[--old] : added[--own];
  }
  const std::uint64_t* const end = std::unique(ignored.begin(), ignored.begin() + all);
  ignored.set_size(static_cast<std::size_t>(end - ignored.begin()));
  return true;
}

void BodyPairRules::remove_ignored(std::span<const KeyPair> key_pairs) noexcept {
  const auto number_of = [](std::uint64_t pair) { return pair & ~kMark; };
  for (const KeyPair& pair : key_pairs) {
    const std::uint64_t number = pair_number(pair.first.id, pair.second.id);
    std::uint64_t* const at =
        std::ranges::lower_bound(ignored.begin(), ignored.end(), number, {}, number_of);
    if (at != ignored.end() && number_of(*at) == number) *at |= kMark;
  }
  drop_ignored([](std::uint64_t pair) { return (pair & kMark) != 0; });
}

bool Scene::is_ignored(Key a, Key b) const noexcept {
  return contains(a) && contains(b) && state_->rules.is_ignored(a.id, b.id);
}

void Scene::set_predicate(const PairPredicate& predicate) noexcept {
  if (state_ == nullptr) return;
  SceneObserver* const observer = state_->observer;
  state_->rules.predicate = observer == nullptr ? predicate : observer->set_predicate(predicate);
  state_->invalidate_pairs();
}

bool BodyPairRules::is_ignored(ObjectId a, ObjectId b) const noexcept {
  const auto may_be = [&](ObjectId body) { return body < ignores.size() && ignores[body] != 0; };
  return may_be(a) && may_be(b) &&
         std::binary_search(ignored.begin(), ignored.end(), pair_number(a, b));
}

Status Scene::set_layers_collide(std::uint16_t a, std::uint16_t b, bool collide) {
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_layers_collide");
  if (std::max(a, b) >= kSceneLayers) {
    return logged(Status::invalid_argument, "Scene::set_layers_collide");
  }
  SceneState& s = *state_;
  if (s.rules.layers.collide(a, b) != collide) {
    if (!s.rules.layers.grow_to(std::max(a, b))) {
      return logged(Status::out_of_memory, "Scene::set_layers_collide");
    }
    s.rules.layers.set(a, b, collide);
    s.invalidate_pairs();
  }
  if (s.observer != nullptr) s.observer->set_layers_collide(a, b, collide);
  return Status::ok;
}

bool Scene::layers_collide(std::uint16_t a, std::uint16_t b) const noexcept {
  return state_ == nullptr || state_->rules.layers.collide(a, b);
}

Status Scene::set_layer(Key key, std::uint16_t layer) {
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_layer");
  SceneState& s = *state_;
  if (!s.keys.is_valid(key)) return logged(Status::invalid_key, "Scene::set_layer");
  if (layer >= kSceneLayers) return logged(Status::invalid_argument, "Scene::set_layer");
  if (s.rules.layer_of(key.id) != layer) {
    if (!s.rules.begin_layers(s.shape.size(), s.shape.capacity()))
      return logged(Status::out_of_memory, "Scene::set_layer");
    s.rules.layer[key.id] = layer;
    s.invalidate_pairs();
  }
  if (s.observer != nullptr) s.observer->set_layer(key, layer);
  return Status::ok;
}

std::uint16_t Scene::layer(Key key) const noexcept {
  return contains(key) ? state_->rules.layer_of(key.id) : std::uint16_t{0};
}

bool BodyPairRules::begin_layers(std::size_t bodies, std::size_t room) noexcept {
  if (with_layers) return true;
  if (!layer.grow(room)) return false;
  with_layers = true;
  layer.set_size(bodies);
  std::fill(layer.begin(), layer.end(), std::uint16_t{0});
  return true;
}

bool BodyPairRules::may_pair(ObjectId a, ObjectId b) const noexcept {
  if (!layers.collide(layer_of(a), layer_of(b))) return false;
  if (is_ignored(a, b)) return false;
  return predicate.accept == nullptr || predicate.accept(predicate.context, a, b);
}

bool SceneState::accepts_pair(ObjectId a, ObjectId b) const noexcept {
  if (body_state[a] != BodyState::dynamic) std::swap(a, b);
  if (a == b || body_state[a] != BodyState::dynamic || !filters_allow(filter_of(a), filter_of(b)))
    return false;
  // The predicate gets the two bodies in the order in which partitions return them.
  if (body_state[b] == BodyState::dynamic && place[b].id < place[a].id) std::swap(a, b);
  return rules.may_pair(a, b);
}

ObjectFilter SceneState::filter_of(ObjectId body) const noexcept {
  return set(body_state[body]).partition->filter(place[body]);
}

void BodyPairRules::forget_ignored(std::span<const Key> removed, const KeyTable& keys) noexcept {
  bool had_ignored = false;
  for (const Key& key : removed) {
    if (key.id >= ignores.size()) continue;
    had_ignored = had_ignored || ignores[key.id] != 0;
    ignores[key.id] = 0;
  }
  if (!had_ignored) return;
  drop_ignored([&](std::uint64_t pair) {
    return !keys.is_live(static_cast<ObjectId>(pair >> 32U)) ||
           !keys.is_live(static_cast<ObjectId>(pair));
  });
}

void BodyPairRules::forget_bodies() noexcept {
  layer.clear();
  with_layers = false;
  ignored.clear();
  ignores.clear();
}

void BodyPairRules::swap_bodies(BodyPairRules& other) noexcept {
  layer.swap(other.layer);
  std::swap(with_layers, other.with_layers);
  layers.swap(other.layers);
  ignored.swap(other.ignored);
  ignores.swap(other.ignores);
}

Bytes BodyPairRules::bytes() const noexcept {
  Bytes sum = bytes_of(layer, ignored, ignores);
  sum += layers.bytes();
  return sum;
}

void SceneState::invalidate_pairs() noexcept {
  for (SceneSet& set : sets) {
    set.with_dynamic.clear();
    ++set.changes;
  }
}

}  // namespace winnow
