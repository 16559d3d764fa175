// A row of boxes, one of which moves into its neighbour.

#include <winnow/partitions/partition.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::vector<winnow::KeyPair> begun;
void on_begin(const winnow::KeyPair& pair) {
  begun.push_back(pair);
}
void on_end(const winnow::KeyPair&) {}

}  // namespace

int main() {
  std::vector<winnow::Aabb> boxes;
  for (int i = 0; i < 1000; ++i) {
    const float x = 1.5F * static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  const std::vector<winnow::ClientData> names(boxes.size(), 7);
  std::vector<winnow::Key> keys(boxes.size());

  // [boxes]
  winnow::Partition partition(winnow::linear_bvh());
  must(partition.insert(boxes, names, keys));  // Aabb, or your own columns or structs: see BoxView
  winnow::PairBuffer pairs;                    // keep it from frame to frame
  must(partition.self_pairs(pairs));           // pairs of ids: keys[i].id
  // [end]
  check(pairs.empty(), "boxes that are apart make no pairs");

  const std::vector<std::uint32_t> moved{3};
  boxes[3] = {{4, 0, 0}, {5, 1, 1}};
  // [frames]
  winnow::PairEvents events;
  must(partition.self_pairs(pairs, events));
  must(
      partition.update(keys, boxes, winnow::IndexSubset::listed(moved)));  // or IndexSubset::masked
  must(partition.self_pairs(pairs,
                            events));  // if few objects moved, only their pairs are recomputed
  for (const winnow::KeyPair& pair : events.begun()) on_begin(pair);
  for (const winnow::KeyPair& pair : events.ended()) on_end(pair);
  // [end]
  check(pairs.size() == 1, "two boxes overlap");
  check(begun.size() == 1 && begun[0].first == keys[2] && begun[0].second == keys[3],
        "their pair has begun");

  // [structures]
  must(partition.set_structure(winnow::hierarchical_grid()));  // keys, filters and events stay
  must(partition.set_structure(winnow::automatic()));  // chooses one, and changes it if needed
  winnow::Partition bodies(
      winnow::linear_bvh(),
      {.volume = winnow::Volume::kdop14,                     // or aabb, sphere, ...
       .fat_margin = {.distance = 0.02F, .share = 0.05F}});  // moves within it cost nothing
  // [end]
  must(partition.self_pairs(pairs));
  check(pairs.size() == 1, "another structure finds the same");
  must(bodies.insert(boxes, names, keys));
  check(bodies.size() == boxes.size(), "they hold the same objects");
}
