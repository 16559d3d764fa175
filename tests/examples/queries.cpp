// Queries boxes with rays, moving volumes, a camera view and nearest neighbours.

#include <winnow/partitions/partition.h>

#include <cstddef>
#include <span>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::size_t drawn = 0;
void draw(std::span<const winnow::ObjectId> ids) {
  drawn += ids.size();
}
void test_children(std::span<const winnow::ObjectId> ids) {
  drawn += ids.size();
}

}  // namespace

int main() {
  std::vector<winnow::Aabb> boxes;
  for (int i = 0; i < 100; ++i) {
    const float x = 2.0F * static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  std::vector<winnow::Key> keys(boxes.size());
  winnow::Partition partition(winnow::linear_bvh());
  must(partition.insert(boxes, {}, keys));

  // [queries]
  const winnow::Hit hit =
      partition.closest(winnow::Ray{{-5, 0.5F, 0.5F}, {1, 0, 0}});  // key, client data, t
  winnow::HitBuffer hits;                                           // keep it from query to query
  must(partition.all(winnow::SphereCast{{{-5, 0, 0}, 0.5F}, {1, 0, 0}},
                     hits));  // sorted by first touch

  const winnow::Vec3f eye(0, 0, 50), ahead(0, 0, -1), up(0, 1, 0);
  winnow::OverlapBuffer seen;
  must(partition.overlap(winnow::Frustum::perspective(eye, ahead, up, 1.0F, 1.6F, 0.1F, 100.0F),
                         seen));
  draw(seen.inside());  // children of these need no test
  test_children(seen.crossing());

  must(
      partition.nearest({{7, 3, 0}, {7, 3, 0}}, 8, 50.0F, hits));  // to a point, sorted by distance
  winnow::PairBuffer pairs;
  must(partition.overlap(winnow::BoxView(boxes), pairs));  // (index of the box, object)
  // [end]
  check(hit.key == keys[0] && hit.t == 5.0F, "the first box is hit");
  check(drawn == seen.size() && drawn > 10, "the camera sees some of them");
  check(hits.size() == 8 && hits[0].key == keys[3], "the nearest to x = 7 is the fourth");
  check(pairs.size() == boxes.size(), "each box overlaps only itself");
}
