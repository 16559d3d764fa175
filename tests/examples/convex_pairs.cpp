// Uses only the narrow phase, on pairs that the caller has found.

#include <winnow/pipeline/narrow_phase.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::vector<std::uint32_t> touching;
void solve(std::uint32_t pair, std::size_t points) {
  if (points > 0) touching.push_back(pair);
}

}  // namespace

int main() {
  const std::vector<winnow::Vec3d> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  // [convex pairs]
  winnow::ShapePool shapes;  // bodies share shapes by id
  const winnow::ShapeId box = shapes.add(winnow::BoxShape{{1, 1, 1}});
  const winnow::ShapeId pyramid =
      shapes.add_hull(points, 0.0);  // coplanar faces are merged; no limit to vertices

  const std::vector<winnow::ShapeId> shape_of{box, pyramid, box};
  const std::vector<winnow::Pose> pose_of{winnow::Pose::at(0, 0, 0), winnow::Pose::at(0, 0, 0.9),
                                          winnow::Pose::at(0, 0, 4)};
  const std::vector<winnow::BodyPair> pairs{{0, 1}, {1, 2}};
  winnow::NarrowPhase narrow;
  winnow::NarrowResult result;  // keep it from call to call
  must(narrow.collide(shapes, {shape_of, pose_of}, pairs,
                      {.level = winnow::ContactLevel::manifold, .contact_margin = 0.01}, result));
  for (std::size_t i = 0; i < result.size(); ++i) {  // in the order of kinds of shapes
    if (result.overlaps(i)) solve(result.pair_of(i), result.contact_count()[i]);
    // also distance(), error_bound(), normal(axis), contact(point): position, depth, feature
  }
  // [end]
  // [one pair]
  winnow::PairAnswer answer;  // no scratch memory, no lists
  must(winnow::collide(shapes, box, winnow::Pose::at(0, 0, 0), pyramid, winnow::Pose::at(0, 0, 1.5),
                       {.level = winnow::ContactLevel::distance}, answer));
  // [end]
  check(std::abs(answer.distance - 0.5) < 1e-9, "the pyramid hovers above the box");
  check(touching.size() == 1 && touching[0] == 0, "the pyramid stands in the first box");
}
