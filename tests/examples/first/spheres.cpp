// 20,000 spheres fall onto a floor; a penalty force pushes apart those that touch.

#include <winnow/winnow.h>

#include <cstdio>
#include <vector>

int main() {
  constexpr std::size_t kSpheres = 20'000;
  constexpr double kStep = 0.002;
  winnow::ShapePool shapes;
  const winnow::ShapeId sphere = shapes.add(winnow::SphereShape{0.5});
  const winnow::ShapeId floor = shapes.add(winnow::HalfSpaceShape{});
  winnow::Scene scene(shapes);

  // The floor is body kSpheres of the arrays.
  std::vector<winnow::Vec3d> position(kSpheres);
  std::vector<winnow::Vec3d> velocity(kSpheres);
  std::vector<winnow::Vec3d> force(kSpheres + 1);
  std::vector<winnow::Key> keys(kSpheres);
  for (std::size_t i = 0; i < kSpheres; ++i) {
    const auto n = static_cast<double>(i);
    position[i] = {0.9 * static_cast<double>(i % 50), 0.9 * static_cast<double>(i / 50 % 50),
                   0.45 + 0.9 * static_cast<double>(i / 2500) + 1e-6 * n};
    keys[i] = scene.add({.shape = sphere, .pose = {position[i]}, .data = i});
  }
  if (!scene.add({.shape = floor, .state = winnow::BodyState::fixed, .data = kSpheres})) return 1;

  winnow::Contacts contacts;
  for (int step = 0; step < 20; ++step) {
    if (scene.collide(winnow::ContactLevel::manifold, contacts) != winnow::Status::ok) return 1;
    force.assign(kSpheres + 1, {0, 0, -9.81});
    for (const winnow::ContactPair& pair : contacts) {
      for (const winnow::ContactManifold& manifold : pair) {
        const winnow::Vec3d push = 5000.0 * manifold.distance() * manifold.normal();
        force[pair.data_a()] += push;
        force[pair.data_b()] -= push;
      }
    }
    for (std::size_t i = 0; i < kSpheres; ++i) {
      velocity[i] += kStep * force[i];
      position[i] += kStep * velocity[i];
    }
    if (scene.move(keys, winnow::PoseView::of_positions(position)) != winnow::Status::ok) return 1;
  }
  std::printf("%zu pairs touch\n", contacts.size());
  return contacts.size() > kSpheres ? 0 : 1;
}
