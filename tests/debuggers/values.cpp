// Values that a debugger prints; run by the script `gdb`.

#include <winnow/winnow.h>

#include <vector>

namespace {

// The break point: takes the value by pointer, so that the compiler keeps it.
void stop_here(const void* /*value*/) {}

}  // namespace

int main() {
  const winnow::Aabb box{{1, 2, 3}, {4, 5, 6.5F}};
  const winnow::Aabb empty;
  const winnow::Key null_key;
  const winnow::Pose pose = winnow::Pose::at(1, 2, -0.25);
  const winnow::Sphere ball{{0, 1, 0}, 2.5F};
  const std::vector<winnow::Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}, {{0.5F, 0, 0}, {2, 1, 1}}};
  const winnow::BoxView box_view(boxes);
  const std::vector<winnow::Pose> poses{pose, pose};
  const winnow::PoseView pose_view(poses);

  winnow::Partition partition(winnow::linear_bvh());
  std::vector<winnow::Key> keys(boxes.size());
  bool good = partition.insert(boxes, {}, keys) == winnow::Status::ok;
  winnow::PairBuffer pairs;
  winnow::PairEvents events;
  good = good && partition.self_pairs(pairs, events) == winnow::Status::ok;
  winnow::OverlapBuffer overlapping;
  good = good && partition.overlap(winnow::Aabb{{-1, -1, -1}, {1.5F, 2, 2}}, overlapping) ==
                     winnow::Status::ok;
  winnow::ShapePool shapes;
  winnow::ShapeId shape;
  winnow::ShapeId oval;
  good = good && shapes.add(winnow::BoxShape{{1, 1, 1}}).get(shape) == winnow::Status::ok &&
         shapes.add(winnow::EllipsoidShape{{1, 1, 2}}).get(oval) == winnow::Status::ok;
  winnow::Scene scene(shapes);
  winnow::Key body;
  winnow::Contacts contacts;
  good = good && scene.add({.shape = shape}).get(body) == winnow::Status::ok &&
         scene.add({.shape = shape}).get(body) == winnow::Status::ok &&
         scene.collide(winnow::ContactLevel::boolean, contacts) == winnow::Status::ok;
  for (const void* value :
       {static_cast<const void*>(&box), static_cast<const void*>(&empty),
        static_cast<const void*>(&null_key), static_cast<const void*>(&pose_view),
        static_cast<const void*>(&ball), static_cast<const void*>(&box_view)}) {
    stop_here(value);
  }
  return good ? 0 : 1;
}
