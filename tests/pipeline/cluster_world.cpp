#include "tests/pipeline/cluster_world.h"
#include "tests/support/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

namespace winnow::test {

ClusterWorld::ClusterWorld(std::uint32_t ranks, const ClusterOptions& options)
    : transport_(ranks), cluster_(transport_, options) {}

void ClusterWorld::add(const std::vector<Aabb>& boxes, Random& random) {
  const std::uint32_t ranks = cluster_.ranks();
  std::vector<std::vector<BodyName>> names(ranks);
  std::vector<std::vector<Aabb>> of_rank(ranks);
  for (const Aabb& box : boxes) {
    const BodyName name = next_++ * 0x9E3779B97F4A7C15ULL;
    const std::size_t rank = random.below(ranks);
    names[rank].push_back(name);
    of_rank[rank].push_back(box);
    boxes_[name] = box;
    placements_[name] = {static_cast<std::uint32_t>(rank), {}};
  }
  std::vector<ClusterBatch> batches(ranks);
  for (std::uint32_t r = 0; r < ranks; ++r) batches[r] = {names[r], of_rank[r]};
  std::vector<Status> answers(ranks, Status::unsupported);
  ASSERT_EQ(cluster_.add(batches, answers), Status::ok);
  EXPECT_EQ(std::count(answers.begin(), answers.end(), Status::ok), ranks);
  for (auto& [name, placement] : placements_) {
    placement.key = expect_ok(cluster_.key_of(placement.rank, name));
  }
}

void ClusterWorld::move(double share, double step, Random& random) {
  std::map<std::uint32_t, std::pair<std::vector<Key>, std::vector<Aabb>>> moves;
  for (auto& [name, box] : boxes_) {
    if (!random.chance(share)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const auto by = static_cast<float>(random.uniform(-step, step));
      box.min[axis] += by;
      box.max[axis] = std::max(box.max[axis] + by, box.min[axis]);
    }
    auto& [keys, boxes] = moves[rank_of(name)];
    keys.push_back(key_of(name));
    boxes.push_back(box);
  }
  for (const auto& [rank, bodies] : moves) {
    ASSERT_EQ(cluster_.move(rank, bodies.first, bodies.second), Status::ok);
  }
}

void ClusterWorld::remove(std::size_t count, Random& random) {
  for (; count > 0 && !boxes_.empty(); --count) {
    auto one = boxes_.begin();
    std::advance(one, random.below(boxes_.size()));
    const BodyName name = one->first;
    ASSERT_EQ(cluster_.remove(rank_of(name), std::span(&name, 1)), Status::ok);
    boxes_.erase(one);
    placements_.erase(name);
  }
}

/// Updates the rank and key of each body from the arrivals and departures that the ranks report.
void ClusterWorld::follow() {
  std::size_t bodies = 0;
  for (std::uint32_t rank = 0; rank < cluster_.ranks(); ++rank) {
    bodies += cluster_.size(rank);
    for (const ClusterBody& body : cluster_.arrived(rank)) {
      placements_[body.name] = {rank, body.key};
    }
  }
  ASSERT_EQ(bodies, boxes_.size());
  ASSERT_EQ(placements_.size(), boxes_.size());
  for (const auto& [name, placement] : placements_) {
    Key key = expect_ok(cluster_.key_of(placement.rank, name));
    ASSERT_EQ(key, placement.key);
  }
}

void ClusterWorld::check() {
  ASSERT_EQ(cluster_.self_pairs(Order::canonical), Status::ok);
  follow();
  const std::vector<NamePair> expected = true_pairs();
  EXPECT_EQ(found_pairs(), expected) << cluster_.ranks() << " ranks";
  EXPECT_EQ(cluster_.statistics().pairs, expected.size());
  EXPECT_EQ(cluster_.statistics().bodies, boxes_.size());
  ClusterDigest digest = expect_ok(cluster_.digest());
  EXPECT_EQ(digest, digest_of(expected));
}

std::vector<NamePair> ClusterWorld::true_pairs() const {
  std::vector<NamePair> pairs;
  for (auto a = boxes_.begin(); a != boxes_.end(); ++a) {
    for (auto b = std::next(a); b != boxes_.end(); ++b) {
      if (a->second.overlaps(b->second)) pairs.push_back({a->first, b->first});
    }
  }
  return pairs;
}

std::vector<NamePair> ClusterWorld::found_pairs() const {
  std::vector<NamePair> pairs;
  for (std::uint32_t rank = 0; rank < cluster_.ranks(); ++rank) {
    const auto found = cluster_.pairs(rank);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

ClusterDigest digest_of(const std::vector<NamePair>& pairs) {
  ClusterDigest sum;
  const auto mix = [](std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
    return x ^ (x >> 31U);
  };
  for (const NamePair& pair : pairs) {
    const std::uint64_t second = mix(pair.second + 0x9E3779B97F4A7C15ULL);
    sum.high += mix(pair.first ^ second);
    sum.low += mix(mix(pair.first + 0xD1B54A32D192ED03ULL) + second);
  }
  return sum;
}

}  // namespace winnow::test
