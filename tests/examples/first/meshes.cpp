// Two meshes from OBJ files: rays, closest points, and their distance from each other.

#include <winnow/winnow.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

struct Mesh {
  std::vector<std::array<float, 3>> points;
  std::vector<std::uint32_t> corners;
};

/// Reads the vertices and the triangles of a Wavefront OBJ file.
Mesh read_obj(std::istream& in) {
  Mesh mesh;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      std::array<float, 3> point{};
      words >> point[0] >> point[1] >> point[2];
      mesh.points.push_back(point);
    } else if (kind == "f") {
      for (int k = 0; k < 3; ++k) {
        std::string corner;
        words >> corner;
        mesh.corners.push_back(static_cast<std::uint32_t>(std::stoul(corner)) - 1);
      }
    }
  }
  return mesh;
}

int main(int count, char** files) {
  std::istringstream pyramid(
      "v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\nv 0 0 2\n"
      "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 1 3 2\nf 1 4 3\n");
  std::ifstream file(count > 1 ? files[1] : "");
  const Mesh mesh = read_obj(count > 1 ? static_cast<std::istream&>(file) : pyramid);

  winnow::ShapePool convex;
  winnow::CompositePool meshes(convex);
  const auto shape = meshes.add_mesh(mesh.points, mesh.corners);
  if (!shape || meshes.set_solid(shape) != winnow::Status::ok) return 1;
  winnow::Scene scene(convex, {.composites = &meshes});
  const winnow::Key near = scene.add({.shape = shape});
  const winnow::Key far = scene.add({.shape = shape, .pose = winnow::Pose::at(5, 0, 0)});
  if (scene.refresh() != winnow::Status::ok) return 1;

  winnow::SceneQueries queries(scene);
  const winnow::SceneHit hit = queries.closest(winnow::ShapeRay{{0.1, 0.2, 9}, {0, 0, -1}});
  if (hit) std::printf("the ray hits triangle %u at height %.3f\n", hit.part, hit.point.z());
  const auto closest = queries.nearest({0, 0, 0.5}, 1, 10.0);
  for (const winnow::SceneDistance& to : closest) {
    std::printf("the point is %.3f from a surface\n", to.distance);
  }
  const winnow::SceneDistance apart = queries.distance(near, far, 100.0, winnow::PairRules::none);
  std::printf("the meshes are %.3f apart\n", apart.distance);
  return hit && closest.size() == 1 && apart ? 0 : 1;
}
