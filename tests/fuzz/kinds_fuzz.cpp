// Makes the same calls on a partition of each exact structure, each with another number of threads
// and each step on another instruction set: pairs, rays and boxes give bit-identical results in all
// of them.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

/// A partition, with its own number of threads.
struct Player {
  explicit Player(const StructureKind& structure, std::size_t number)
      : partition(structure,
                  {.execution = number % 3 == 0 ? Execution::serial() : Execution::parallel()}),
        threads(1 + static_cast<int>(number % 3)) {}

  Partition partition;
  Threads threads;
  PairBuffer pairs;  // reused from call to call
};

class Game {
 public:
  Game() {
    for (const StructureKind& structure : all_structures()) {
      if (structure != n_squared()) players_.emplace_back(structure, players_.size());
    }
  }

  void step(Bytes& bytes);

 private:
  void insert(Bytes& bytes);
  void update(Bytes& bytes);
  void remove(Bytes& bytes);
  void filter(Bytes& bytes);
  void query_pairs();
  void query_ray(Bytes& bytes);
  void query_box(Bytes& bytes);

  /// Runs `call(player)` for every player; the results must be equal.
  template <typename Call>
  void all_return(const Call& call) {
    std::optional<decltype(call(players_[0]))> first;
    for (Player& player : players_) {
      auto result = player.threads.run([&] { return call(player); });
      if (!first) first = result;
      WINNOW_REQUIRE(result == *first);
    }
  }
  /// Returns some objects, mostly consecutive; the same for every player.
  [[nodiscard]] std::vector<ObjectId> some(Bytes& bytes) const;
  static std::vector<Key> keys_of(const Player& player, const std::vector<ObjectId>& ids) {
    std::vector<Key> keys;
    for (const ObjectId id : ids) keys.push_back(player.partition.key_of(id));
    return keys;
  }

  std::deque<Player> players_;
  std::vector<ObjectId> live_;
};

std::vector<ObjectId> Game::some(Bytes& bytes) const {
  std::vector<ObjectId> ids;
  if (live_.empty()) return ids;
  std::size_t at = bytes.any<std::uint16_t>() % live_.size();
  const std::size_t stride = 1 + bytes.below(3);
  for (std::size_t count = 1 + bytes.below(bytes.chance(3) ? 200 : 6);
       count != 0 && at < live_.size(); --count, at += stride) {
    ids.push_back(live_[at]);
  }
  return ids;
}

void Game::insert(Bytes& bytes) {
  if (live_.size() > 600) return;
  std::vector<Aabb> boxes(1 + bytes.below(bytes.chance(3) ? 120 : 6));
  Aabb box = bytes.box();
  const auto step = static_cast<float>(bytes.extent());
  for (Aabb& one : boxes) {
    one = box.is_valid() ? box : bytes.grid_box();
    box = bytes.chance(2) ? bytes.box() : one;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] += step;
      box.max[axis] += step;
    }
  }
  std::vector<Key> keys(boxes.size());
  all_return([&](Player& player) {
    WINNOW_REQUIRE(player.partition.insert(boxes, {}, keys) == Status::ok);
    std::vector<ObjectId> ids;
    for (const Key& key : keys) ids.push_back(key.id);
    return ids;
  });
  for (const Key& key : keys) live_.push_back(key.id);
}

void Game::update(Bytes& bytes) {
  const std::vector<ObjectId> ids = some(bytes);
  std::vector<Aabb> boxes(ids.size());
  for (Aabb& box : boxes) {
    box = bytes.box();
    if (!box.is_valid()) box = bytes.grid_box();
  }
  all_return([&](Player& player) {
    return player.partition.update(keys_of(player, ids), boxes) == Status::ok;
  });
}

void Game::remove(Bytes& bytes) {
  const std::vector<ObjectId> ids = some(bytes);
  all_return(
      [&](Player& player) { return player.partition.remove(keys_of(player, ids)) == Status::ok; });
  std::erase_if(live_, [&](ObjectId id) { return std::ranges::find(ids, id) != ids.end(); });
}

void Game::filter(Bytes& bytes) {
  const std::vector<ObjectId> ids = some(bytes);
  std::vector<ObjectFilter> filters(ids.size());
  for (ObjectFilter& one : filters) {
    one = {1U << bytes.below(3), static_cast<unsigned>(bytes.below(8)),
           static_cast<unsigned>(bytes.below(3))};
  }
  all_return([&](Player& player) {
    return player.partition.set_filter(keys_of(player, ids), filters) == Status::ok;
  });
}

void Game::query_pairs() {
  all_return([](Player& player) {
    WINNOW_REQUIRE(player.partition.self_pairs(player.pairs, {.order = Order::canonical}) ==
                   Status::ok);
    return std::vector<Pair>(player.pairs.begin(), player.pairs.end());
  });
}

void Game::query_ray(Bytes& bytes) {
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = bytes.wild();
    ray.direction[axis] = static_cast<float>(bytes.grid_value());
  }
  all_return([&](Player& player) {
    HitBuffer hits;
    std::vector<std::pair<ObjectId, double>> result;
    if (player.partition.all(ray, hits) != Status::ok) return result;
    for (const Hit& hit : hits) result.emplace_back(hit.key.id, static_cast<double>(hit.t));
    return result;
  });
}

void Game::query_box(Bytes& bytes) {
  const Aabb box = bytes.box();
  all_return([&](Player& player) {
    PairBuffer found;
    std::vector<Pair> result;
    const Status status =
        player.partition.overlap(BoxView(std::span(&box, 1)), found, {}, Order::canonical);
    WINNOW_REQUIRE((status == Status::ok) == box.is_valid());
    result.assign(found.begin(), found.end());
    return result;
  });
}

void Game::step(Bytes& bytes) {
  switch (bytes.below(8)) {
    case 0:
    case 1:
      return insert(bytes);
    case 2:
    case 3:
      return update(bytes);
    case 4:
      return remove(bytes);
    case 5:
      return bytes.chance(2) ? filter(bytes) : query_box(bytes);
    case 6:
      return query_ray(bytes);
    default:
      return query_pairs();
  }
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  const auto isas = available_isas();
  Game game;
  for (int steps = 0; !bytes.empty() && steps < 80; ++steps) {
    const IsaScope isa(isas[bytes.below(isas.size())]);
    game.step(bytes);
  }
}

std::vector<std::string> fuzz_seeds() {
  return random_seeds(120, 1200);
}

}  // namespace winnow::test
