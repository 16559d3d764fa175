// Custom memory, memory that runs out, and boxes far from the origin.

#include <winnow/winnow.h>

#include <cstddef>
#include <memory_resource>
#include <vector>

#include "tests/examples/check.h"

int main() {
  std::vector<winnow::Aabb> boxes;
  for (int i = 0; i < 10'000; ++i) {
    const float x = 0.9F * static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  std::vector<winnow::Key> keys(boxes.size());

  // [own memory]
  std::pmr::unsynchronized_pool_resource arena;  // or your engine's: a std::pmr::memory_resource
  winnow::Partition partition(winnow::linear_bvh(), {.memory = &arena});
  winnow::PairBuffer pairs(&arena);  // every class takes one
  must(partition.reserve(10'000, winnow::Pages::prefaulted));
  must(partition.reserve_pairs(pairs, 20'000, winnow::Pages::prefaulted));
  must(partition.insert(boxes, {}, keys));                           // does not allocate
  must(partition.self_pairs(pairs));                                 // does not allocate either
  const std::size_t bytes = partition.footprint().total().reserved;  // exact, to the byte
  // [end]
  check(pairs.size() == 9999 && bytes > 10'000 * 24, "pairs are found, boxes are held");

  // [out of memory]
  std::byte room[20'000];
  std::pmr::monotonic_buffer_resource small(room, sizeof room, std::pmr::null_memory_resource());
  winnow::Partition crowded(winnow::linear_bvh(), {.memory = &small});
  const winnow::Status status = crowded.insert(boxes, {}, keys);
  if (status == winnow::Status::out_of_memory) {
    check(crowded.size() == 0, "all or nothing: it is as it was, and can be used");
  }
  // [end]
  check(status == winnow::Status::out_of_memory, "there is no room for ten thousand");

  // [far away]
  const winnow::Vec3d low(1e7, 2e7, 0), high(1e7 + 0.01, 2e7 + 0.01, 0.01);  // a centimetre
  const winnow::Vec3d here(1e7, 2e7, 0);                              // any point among the objects
  const winnow::Aabb tight = winnow::Aabb::outward(low, high, here);  // relative to this point
  const winnow::Aabb coarse = winnow::Aabb::outward(low, high);  // correct, but over a metre wide
  // [end]
  check(tight.max.x() - tight.min.x() < 0.011F,
        "relative to a near point, the box stays a centimetre wide");
  check(coarse.max.x() - coarse.min.x() >= 0.5F, "floats are a metre apart there");
}
