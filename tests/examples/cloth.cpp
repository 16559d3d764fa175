// A sheet moves through another in one step; the time of impact stops it.

#include <winnow/pipeline/deformable_mesh.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/examples/check.h"

namespace {

/// Two squares of two triangles, one above the other.
std::vector<winnow::Vec3d> squares(double height) {
  return {{0, 0, 0},      {1, 0, 0},      {0, 1, 0},      {1, 1, 0},
          {0, 0, height}, {1, 0, height}, {0, 1, height}, {1, 1, height}};
}

}  // namespace

int main() {
  const std::vector<winnow::Vec3d> before = squares(1.0);
  const std::vector<winnow::Vec3d> after = squares(-3.0);
  const std::vector<std::uint32_t> triangles{0, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6};
  // [cloth]
  winnow::DeformableMesh cloth;
  must(cloth.build(before, std::span(triangles)));  // once: rest positions, corners
  must(cloth.move(before, after));  // in every step: float or double, columns or structs
  double earliest = 1.0;
  for (const auto kind : {winnow::FeaturePair::vertex_face, winnow::FeaturePair::edge_edge}) {
    must(cloth.self_impacts(kind, {}, [&](std::span<const winnow::MeshImpact> impacts) {
      for (const winnow::MeshImpact& impact : impacts) {  // of the two impact.features
        earliest = std::min(earliest, impact.time);       // never late
      }
    }));
  }
  // [end]
  check(earliest <= 0.25 && earliest > 0.2499, "the upper square is stopped at the lower one");
}
