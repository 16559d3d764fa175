#include "tests/support/reference.h"

#include <algorithm>
#include <cstddef>

namespace winnow::test {
namespace {

bool pair_up(const Object& a, const Object& b) {
  return a.box.overlaps(b.box) && filters_allow(a.filter, b.filter);
}

}  // namespace

std::vector<Pair> brute_force_pairs(std::span<const Object> objects) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size(); ++j) {
      if (!pair_up(objects[i], objects[j])) continue;
      const auto [first, second] = std::minmax(objects[i].id, objects[j].id);
      pairs.push_back({first, second});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Pair> swept_pairs(std::span<const Object> objects) {
  std::vector<Object> sorted(objects.begin(), objects.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const Object& a, const Object& b) { return a.box.min.x() < b.box.min.x(); });
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t j = i + 1; j < sorted.size(); ++j) {
      if (sorted[j].box.min.x() > sorted[i].box.max.x()) break;
      if (!pair_up(sorted[i], sorted[j])) continue;
      const auto [first, second] = std::minmax(sorted[i].id, sorted[j].id);
      pairs.push_back({first, second});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Pair> true_pairs(std::span<const Object> objects) {
  return objects.size() <= 300 ? brute_force_pairs(objects) : swept_pairs(objects);
}

std::vector<Object> numbered(std::span<const Aabb> boxes) {
  std::vector<Object> objects;
  objects.reserve(boxes.size());
  for (const Aabb& box : boxes) objects.push_back({static_cast<ObjectId>(objects.size()), box});
  return objects;
}

std::vector<Pair> cross_pairs(std::span<const Object> a, std::span<const Object> b) {
  std::vector<Pair> pairs;
  for (const Object& x : a) {
    for (const Object& y : b) {
      if (pair_up(x, y)) pairs.push_back({x.id, y.id});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace winnow::test
