// A partition with a plain model that repeats all changes; the conformance tests compare the two
// after each query.

#include "tests/support/world.h"
#include "tests/support/answers.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>

namespace winnow::test {
namespace {

testing::AssertionResult right_set(std::span<const Pair> got, std::span<const Pair> truth,
                                   bool exact) {
  std::vector<Pair> sorted(got.begin(), got.end());
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end()) {
    return testing::AssertionFailure() << *twice << " is reported twice";
  }
  std::vector<Pair> difference;
  std::set_difference(truth.begin(), truth.end(), sorted.begin(), sorted.end(),
                      std::back_inserter(difference));
  if (!difference.empty()) {
    return testing::AssertionFailure() << difference.size() << " of " << truth.size()
                                       << " pairs are missing, the first is " << difference[0];
  }
  if (!exact || sorted.size() == truth.size()) return testing::AssertionSuccess();
  std::set_difference(sorted.begin(), sorted.end(), truth.begin(), truth.end(),
                      std::back_inserter(difference));
  return testing::AssertionFailure() << difference.size() << " pairs besides the " << truth.size()
                                     << " true ones, the first is " << difference[0];
}

// Compares bit by bit, except that a partition cannot distinguish an outer end at the largest float
// from infinity: no valid box is beyond either.
bool same_box(Aabb a, Aabb b) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float largest = std::numeric_limits<float>::max();
  for (Aabb* box : {&a, &b}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (box->min[axis] == -largest) box->min[axis] = -inf;
      if (box->max[axis] == largest) box->max[axis] = inf;
    }
  }
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

testing::AssertionResult right_pairs(std::span<const Pair> got, std::span<const Pair> truth,
                                     bool exact) {
  for (const Pair& pair : got) {
    if (pair.first >= pair.second) return testing::AssertionFailure() << pair << " is not ordered";
  }
  return right_set(got, truth, exact);
}

testing::AssertionResult right_cross_pairs(std::span<const Pair> got, std::span<const Pair> truth,
                                           bool exact) {
  return right_set(got, truth, exact);
}

World::World(const Config& config, std::pmr::memory_resource* memory)
    : partition_(config.make(memory)), threads_(config.threads) {}

std::vector<Key> World::insert(std::span<const Aabb> boxes, std::span<const ClientData> data) {
  std::vector<Key> keys(boxes.size());
  const Status status = threads_.run([&] { return partition_.insert(boxes, data, keys); });
  EXPECT_EQ(status, Status::ok);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_FALSE(entries_.contains(keys[i].id)) << "a live object's id was handed out again";
    entries_[keys[i].id] = {keys[i], boxes[i], data.empty() ? 0 : data[i], {}};
  }
  return keys;
}

Key World::insert(const Aabb& box, ClientData data) {
  Key key = expect_ok(partition_.insert(box, data));
  EXPECT_FALSE(entries_.contains(key.id)) << "a live object's id was handed out again";
  entries_[key.id] = {key, box, data, {}};
  return key;
}

void World::update(std::span<const Key> keys, std::span<const Aabb> boxes) {
  const Status status = threads_.run([&] { return partition_.update(keys, boxes); });
  EXPECT_EQ(status, Status::ok);
  for (std::size_t i = 0; i < keys.size(); ++i) entries_.at(keys[i].id).box = boxes[i];
}

void World::update(Key key, const Aabb& box) {
  EXPECT_EQ(partition_.update(key, box), Status::ok);
  entries_.at(key.id).box = box;
}

void World::remove(std::span<const Key> keys) {
  const Status status = threads_.run([&] { return partition_.remove(keys); });
  EXPECT_EQ(status, Status::ok);
  for (const Key& key : keys) entries_.erase(key.id);
}

void World::remove(Key key) {
  EXPECT_EQ(partition_.remove(key), Status::ok);
  entries_.erase(key.id);
}

void World::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  EXPECT_EQ(partition_.set_filter(keys, filters), Status::ok);
  for (std::size_t i = 0; i < keys.size(); ++i) entries_.at(keys[i].id).filter = filters[i];
}

void World::set_filter(Key key, const ObjectFilter& filter) {
  EXPECT_EQ(partition_.set_filter(key, filter), Status::ok);
  entries_.at(key.id).filter = filter;
}

void World::clear() {
  partition_.clear();
  entries_.clear();
}

Status World::self_pairs(PairBuffer& buffer, const PairOptions& options) {
  return threads_.run([&] { return partition_.self_pairs(buffer, options); });
}

Status World::pairs_with(const Partition& other, PairBuffer& buffer, const PairOptions& options) {
  return threads_.run([&] { return partition_.pairs_with(other, buffer, options); });
}

testing::AssertionResult World::agrees(PairBuffer& buffer, const PairOptions& options) {
  if (const Status status = self_pairs(buffer, options); status != Status::ok) {
    return testing::AssertionFailure() << "self_pairs returned " << winnow::to_string(status);
  }
  if (options.order == Order::canonical && !std::is_sorted(buffer.begin(), buffer.end())) {
    return testing::AssertionFailure() << "canonical order is not sorted";
  }
  if (const Statistics s = partition_.statistics();
      s.objects != entries_.size() || s.last_pairs != buffer.size()) {
    return testing::AssertionFailure()
           << "statistics report " << s.objects << " objects and " << s.last_pairs << " pairs, not "
           << entries_.size() << " and " << buffer.size();
  }
  return has_pairs(buffer);
}

testing::AssertionResult World::has_pairs(const PairBuffer& buffer) const {
  if (const auto may_pair = may_all_pair(buffer.pairs()); !may_pair) return may_pair;
  return right_pairs(buffer.pairs(), true_pairs(objects()), partition_.is_exact());
}

testing::AssertionResult World::may_all_pair(std::span<const Pair> pairs) const {
  for (const Pair& pair : pairs) {
    if (!filters_allow(entries_.at(pair.first).filter, entries_.at(pair.second).filter)) {
      return testing::AssertionFailure() << "the filters of " << pair << " reject it";
    }
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult World::agrees() {
  PairBuffer buffer;
  return agrees(buffer);
}

testing::AssertionResult World::holds_its_objects() const {
  if (partition_.size() != entries_.size()) {
    return testing::AssertionFailure()
           << "size is " << partition_.size() << " instead of " << entries_.size();
  }
  for (const auto& [id, entry] : entries_) {
    Aabb box;
    if (!partition_.contains(entry.key) || partition_.key_of(id) != entry.key) {
      return testing::AssertionFailure() << "the key of object " << id << " is lost";
    }
    if (partition_.bounds(entry.key).get(box) != Status::ok || !same_box(box, entry.box)) {
      return testing::AssertionFailure() << "the box of object " << id << " is another";
    }
    if (partition_.client_data(entry.key) != entry.data ||
        partition_.client_data_of(id) != entry.data) {
      return testing::AssertionFailure() << "the client data of object " << id << " is another";
    }
    ObjectFilter filter{~entry.filter.layers, 0, 0};
    if (partition_.filter(entry.key).get(filter) != Status::ok || filter != entry.filter) {
      return testing::AssertionFailure() << "the filter of object " << id << " is another";
    }
  }
  return testing::AssertionSuccess();
}

std::vector<Object> World::objects() const {
  std::vector<Object> objects;
  objects.reserve(entries_.size());
  for (const auto& [id, entry] : entries_) objects.push_back({id, entry.box, entry.filter});
  return objects;
}

}  // namespace winnow::test
