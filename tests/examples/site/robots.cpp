// A motion planner tests an arm of two links against obstacles.

#include <winnow/winnow.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "tests/examples/check.h"

namespace {

using Configuration = std::array<double, 2>;  // angles of the joints about z

/// Returns the poses of the link centres; each link is 1 long, along x if all angles are 0.
std::array<winnow::Pose, 2> link_poses(const Configuration& q) {
  std::array<winnow::Pose, 2> poses;
  double x = 0.0, y = 0.0, angle = 0.0;
  for (std::size_t link = 0; link < 2; ++link) {
    angle += q[link];
    poses[link] = winnow::Pose::at(x + std::cos(angle) / 2, y + std::sin(angle) / 2, 0.5);
    poses[link].orientation[0] = std::cos(angle / 2);
    poses[link].orientation[3] = std::sin(angle / 2);
    x += std::cos(angle);
    y += std::sin(angle);
  }
  return poses;
}

}  // namespace

int main() {
  winnow::ShapePool shapes;
  const winnow::ShapeId link = shapes.add(winnow::BoxShape{{0.5, 0.05, 0.05}});
  const winnow::ShapeId pillar = shapes.add(winnow::CylinderShape{0.1, 1.0});

  // [checker]
  enum Layer : std::uint32_t { obstacles = 1, tools = 2 };
  winnow::Scene world(
      shapes, {.structures = {winnow::static_bvh(), winnow::linear_bvh(), winnow::linear_bvh()}});
  std::vector<winnow::Key> keys(3);
  const std::vector<winnow::BodyDefinition> pillars{
      {pillar, winnow::Pose::at(1.6, 0.8, 0), winnow::BodyState::fixed, {.layers = obstacles}},
      {pillar, winnow::Pose::at(-1, 1, 0), winnow::BodyState::fixed, {.layers = obstacles}},
      {pillar, winnow::Pose::at(0, -1.5, 0), winnow::BodyState::fixed, {.layers = tools}}};
  must(world.add(pillars, keys));
  must(world.refresh());  // once; then any number of threads may query

  winnow::SceneQueries queries(world);  // one per thread
  const auto is_free = [&](const Configuration& q) {
    for (const winnow::Pose& pose : link_poses(q)) {
      const auto overlaps =
          queries.overlap(link, pose, {.mask = obstacles});  // exact, as tier robust
      if (!overlaps.empty()) return false;
    }
    return true;
  };
  // [end]
  check(is_free({0.0, 0.0}), "nothing stands along x");
  check(!is_free({0.0, 0.9}), "the second link hits the pillar");
  check(is_free({-1.57, 0.0}), "tools are ignored");

  // [clearance]
  const auto clearance = [&](const Configuration& q, double enough) {
    double least = enough;  // larger distances do not matter
    for (const winnow::Pose& pose : link_poses(q)) {
      const double reach = 0.51 + least;  // radius around the link's centre
      const auto near = queries.nearest(pose.position, 8, reach, {.mask = obstacles});
      for (const winnow::SceneDistance& body : near) least = std::min(least, body.distance - 0.51);
    }
    return least;  // a lower bound
  };
  // [end]
  check(clearance({0.0, 0.0}, 5.0) > 0.0, "there is room");
  check(clearance({0.0, 0.0}, 0.1) <= 0.1, "no more than the limit");
}
