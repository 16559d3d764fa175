// A robot arm of capsules that checks itself: which links touch, except those that share a joint.

#include <winnow/winnow.h>

#include <cmath>
#include <cstdio>
#include <vector>

int main() {
  constexpr int kLinks = 7;
  winnow::ShapePool shapes;
  const winnow::ShapeId link = shapes.add(winnow::CapsuleShape{0.1, 0.5});
  winnow::Scene scene(shapes);
  std::vector<winnow::Key> keys;
  std::vector<winnow::Pose> poses(kLinks);
  for (int i = 0; i < kLinks; ++i) keys.push_back(scene.add({.shape = link}));
  for (int i = 1; i < kLinks; ++i) {
    if (scene.set_ignored(keys[i - 1], keys[i]) != winnow::Status::ok) return 1;
  }

  winnow::SceneQueries queries(scene);
  int colliding = 0;
  for (int configuration = 0; configuration < 1000; ++configuration) {
    winnow::Pose joint;
    for (int i = 0; i < kLinks; ++i) {
      const double angle = 2.5 * std::sin(0.37 * configuration * (i + 1));
      joint = joint * winnow::Pose{{}, winnow::Quaternion::about({0, 1, 0}, angle)};
      poses[i] = joint * winnow::Pose::at(0, 0, 0.5);
      joint = joint * winnow::Pose::at(0, 0, 1);
    }
    if (scene.move(keys, poses) != winnow::Status::ok) return 1;
    if (scene.refresh() != winnow::Status::ok) return 1;
    const auto contact = queries.any_contact();
    if (contact.status != winnow::Status::ok) return 1;
    if (contact.first != winnow::Key{}) ++colliding;
  }
  std::printf("%d of 1000 configurations collide\n", colliding);
  return colliding > 0 && colliding < 1000 ? 0 : 1;
}
