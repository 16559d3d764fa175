#include "tests/pipeline/scene_world.h"

#include "pipeline/solver/solver.h"

#include <bit>
#include <cmath>

namespace winnow::test {

SceneWorld::SceneWorld(std::size_t count, std::uint64_t seed)
    : random(seed), side(std::cbrt(static_cast<double>(count) * 0.6)) {
  shapes.resize(7);
  bool good = pool.add(SphereShape{0.5}).get(shapes[0]) == Status::ok;
  good = good && pool.add(CapsuleShape{0.3, 0.4}).get(shapes[1]) == Status::ok;
  good = good && pool.add(BoxShape{{0.4, 0.5, 0.3}}).get(shapes[2]) == Status::ok;
  good = good && pool.add(CylinderShape{0.4, 0.3}).get(shapes[3]) == Status::ok;
  good = good && pool.add(ConeShape{0.4, 0.4}).get(shapes[4]) == Status::ok;
  good = good &&
         pool.add(TriangleShape{{{-0.5, -0.4, 0}, {0.5, -0.3, 0.1}, {0, 0.6, 0}}}).get(shapes[5]) ==
             Status::ok;
  const std::vector<Vec3d> corners = {{0.6, 0, 0},  {-0.6, 0, 0}, {0, 0.5, 0},
                                      {0, -0.5, 0}, {0, 0, 0.4},  {0, 0, -0.4}};
  const std::vector<std::uint32_t> loops = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                            2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  good = good && pool.add_hull(corners, {loops, sizes}, 0.0).get(shapes[6]) == Status::ok;
  if (!good) shapes.clear();
  for (std::size_t i = 0; i < count; ++i) {
    BodyDefinition body;
    body.shape = shapes[i % shapes.size()];
    body.pose = random_pose();
    body.state = static_cast<BodyState>(random.below(10) < 8 ? 1 : random.below(2) * 2);
    if (random.chance(0.1)) body.filter = {.layers = 2, .mask = ~2U};
    body.data = i;
    bodies.push_back(body);
  }
  keys.resize(count);
  removed.resize(count, false);
}

Pose SceneWorld::random_pose() {
  Pose pose;
  for (double& p : pose.position) p = random.uniform(0.0, side);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

void SceneWorld::stir(double step) {
  for (BodyDefinition& body : bodies) {
    for (double& p : body.pose.position) p += random.uniform(-step, step);
    for (double& q : body.pose.orientation) q += random.uniform(-step, step);
  }
}

std::map<Names, double> SceneWorld::touching(double margin) const {
  std::map<Names, double> found;
  SolverCounts counts;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const BodyDefinition& a = bodies[i];
      const BodyDefinition& b = bodies[j];
      if (removed[i] || removed[j] || !filters_allow(a.filter, b.filter)) continue;
      if (a.state != BodyState::dynamic && b.state != BodyState::dynamic) continue;
      double square = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double d = a.pose.position[k] - b.pose.position[k];
        square += d * d;
      }
      // No shape extends farther than 0.8 from its origin.
      if (square > (1.6 + margin) * (1.6 + margin)) continue;
      const PairAnswer answer = solve_pair(pool.tables(), a.shape, a.pose, b.shape, b.pose,
                                           ContactLevel::distance, margin, counts);
      if (answer.distance <= margin) found[names(a.data, b.data)] = answer.distance;
    }
  }
  return found;
}

Status add_all(Scene& scene, SceneWorld& world) {
  return scene.add(world.bodies, world.keys);
}

Status move_all(Scene& scene, const SceneWorld& world) {
  std::vector<Key> keys;
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.removed[i]) continue;
    keys.push_back(world.keys[i]);
    poses.push_back(world.bodies[i].pose);
  }
  return scene.move(keys, poses);
}

std::set<Names> shown(const Contacts& contacts) {
  std::set<Names> found;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    found.insert(names(contacts.data_a()[i], contacts.data_b()[i]));
  }
  return found;
}

std::vector<std::uint64_t> digest(const Contacts& contacts) {
  std::vector<std::uint64_t> bits;
  const auto put = [&](double value) { bits.push_back(std::bit_cast<std::uint64_t>(value)); };
  for (const ContactRun& run : contacts.runs()) {
    bits.insert(bits.end(), {run.kind_a, run.kind_b, run.first, run.count});
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    bits.insert(bits.end(), {contacts.data_a()[i], contacts.data_b()[i], contacts.a()[i].id,
                             contacts.b()[i].id, static_cast<std::uint64_t>(contacts.event()[i])});
  }
  for (const std::uint32_t first : contacts.manifold_first()) bits.push_back(first);
  for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
    bits.insert(bits.end(), {contacts.part_a()[m], contacts.part_b()[m]});
    if (contacts.level() < ContactLevel::distance) continue;
    put(contacts.distance()[m]);
    put(contacts.error_bound()[m]);
    for (int k = 0; k < 3; ++k) put(contacts.normal(k)[m]);
    for (int k = 0; k < 3 && contacts.level() == ContactLevel::distance; ++k) {
      put(contacts.point(k)[m]);
    }
  }
  for (const std::uint32_t first : contacts.point_first()) bits.push_back(first);
  for (std::size_t p = 0; p < contacts.points(); ++p) {
    const ContactPoint point = contacts.contact(p);
    for (const float x : point.position) put(static_cast<double>(x));
    put(static_cast<double>(point.depth));
    bits.push_back(point.feature);
  }
  for (const EndedContact& pair : contacts.ended()) {
    bits.insert(bits.end(), {pair.data_a, pair.data_b, pair.a.id, pair.b.id});
  }
  return bits;
}

}  // namespace winnow::test
