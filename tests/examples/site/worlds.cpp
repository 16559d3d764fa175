// A thousand small worlds in one partition.

#include <winnow/partitions/partition.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/examples/check.h"

int main() {
  constexpr std::uint32_t kWorlds = 1000;
  std::vector<winnow::Aabb> boxes;
  std::vector<winnow::ObjectFilter> filters;
  // [worlds]
  for (std::uint32_t world = 0; world < kWorlds; ++world) {
    for (int i = 0; i < 10; ++i) {
      const float x = 0.9F * static_cast<float>(i);
      boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});  // all worlds are at the same position
      filters.push_back({.environment = world});    // but never collide
    }
  }
  std::vector<winnow::Key> keys(boxes.size());
  winnow::Partition partition(winnow::linear_bvh());
  must(partition.insert(boxes, {}, keys));
  must(partition.set_filter(keys, filters));
  winnow::PairBuffer pairs;
  must(partition.self_pairs(pairs));  // one call, on all threads, for all worlds
  // [end]
  check(pairs.size() == 9 * kWorlds, "each world has its nine pairs and no others");

  winnow::HitBuffer hits;
  // [one world]
  must(partition.all(winnow::Ray{{-5, 0.5F, 0.5F}, {1, 0, 0}}, hits, {.environment = 7}));
  // [end]
  check(hits.size() == 10, "a ray in one world hits its ten boxes");
}
