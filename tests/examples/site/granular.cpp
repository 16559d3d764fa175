// Grains: neighbours within a distance, updated from step to step, and contacts.

#include <winnow/winnow.h>

#include <cstddef>
#include <span>
#include <vector>

#include "tests/examples/check.h"

int main() {
  std::vector<winnow::Sphere> grains;
  for (int i = 0; i < 4000; ++i) {
    const auto at = [](int k) { return 1.05F * static_cast<float>(k); };
    grains.push_back({{at(i % 20), at(i / 20 % 20), at(i / 400)}, 0.5F});
  }
  std::vector<winnow::Key> keys(grains.size());

  // [neighbours]
  winnow::Partition partition(winnow::hierarchical_grid(),
                              {.volume = winnow::Volume::sphere,     // instead of bounding boxes
                               .fat_margin = {.distance = 0.05F}});  // the skin of a Verlet list
  must(partition.insert(grains, {}, keys));
  winnow::PairBuffer neighbours;
  must(partition.self_pairs(neighbours));
  // [end]
  check(neighbours.size() > 3 * 3500, "each grain has three neighbours after it, but at the rim");

  const std::size_t before = neighbours.size();
  for (winnow::Sphere& grain : grains) grain.center.x() += 0.02F;
  // [a step]
  must(partition.update(keys, grains));    // a move within the skin costs nothing
  must(partition.self_pairs(neighbours));  // recomputes pairs of grains that left their skins
  // [end]
  check(neighbours.size() == before, "nobody has left");

  winnow::ShapePool shapes;
  const winnow::ShapeId grain = shapes.add(winnow::SphereShape{0.5});
  winnow::Contacts contacts;
  // [contacts of grains]
  winnow::Scene scene(shapes, {.contact_margin = 0.06,      // speculative contacts
                               .cache_tolerance = 0.002});  // keeps resting contacts
  std::vector<winnow::BodyDefinition> bodies;
  for (const winnow::Sphere& s : grains) {
    bodies.push_back({grain, winnow::Pose::at(s.center.x(), s.center.y(), s.center.z())});
  }
  must(scene.add(bodies, keys));
  must(scene.collide(winnow::ContactLevel::distance, contacts));  // distance and normal
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double overlap = -contacts.distance()[i];
    check(overlap < 0.0, "they stand a twentieth apart");
  }
  // [end]
  check(contacts.size() > 3 * 3500, "neighbours are contacts within the margin");
}
