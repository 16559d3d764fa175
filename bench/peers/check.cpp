// Every peer against brute force: random, touching, mixed-size, degenerate and moving scenes,
// several frames each, one and two threads. Prints what differs; exit status 1 if anything does.

#include "bench/peers/peers.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace {

using winnow::Aabb;
using winnow::Pair;
using winnow::bench::Engine;

using Boxes = std::vector<Aabb>;
using Generator = std::mt19937;

constexpr int kFrames = 8;

float uniform(Generator& random, float lo, float hi) {
  return std::uniform_real_distribution<float>(lo, hi)(random);
}

Eigen::Vector3f point(Generator& random, float lo, float hi) {
  return {uniform(random, lo, hi), uniform(random, lo, hi), uniform(random, lo, hi)};
}

Boxes random_cubes(Generator& random, std::size_t count, float world, float smallest,
                   float largest) {
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const float edge = std::exp(uniform(random, std::log(smallest), std::log(largest)));
    const Eigen::Vector3f min = point(random, 0.0F, world);
    boxes.push_back({min, min + Eigen::Vector3f::Constant(edge)});
  }
  return boxes;
}

/// Boxes that share faces, edges and corners and nothing else.
Boxes lattice(int side) {
  Boxes boxes;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < side; ++z) {
        const Eigen::Vector3f min(static_cast<float>(x), static_cast<float>(y),
                                  static_cast<float>(z));
        boxes.push_back({min, min + Eigen::Vector3f::Ones()});
      }
    }
  }
  return boxes;
}

/// Points on a coarse lattice: zero extents, many of them equal.
Boxes points(Generator& random, std::size_t count) {
  Boxes boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f p = point(random, 0.0F, 6.0F).array().floor();
    boxes.push_back({p, p});
  }
  return boxes;
}

Boxes with_ground(Boxes boxes, float world) {
  boxes.insert(boxes.begin(), Aabb{{-world, -1.0F, -world}, {2.0F * world, 0.5F, 2.0F * world}});
  return boxes;
}

struct Scene {
  std::string name;
  Boxes boxes;
  float step;    ///< largest move of a frame along an axis
  float moving;  ///< share of the objects that move in a frame
};

std::vector<Scene> scenes() {
  Generator random(20);
  Scene wall{"wall", random_cubes(random, 600, 40.0F, 0.5F, 2.0F), 0.2F, 1.0F};
  for (Aabb& box : wall.boxes) box.min.x() = -box.max.x() - 1.0F;
  return {
      {"empty", {}, 0.1F, 1.0F},
      {"single", random_cubes(random, 1, 1.0F, 1.0F, 2.0F), 0.1F, 1.0F},
      {"uniform", random_cubes(random, 900, 12.0F, 1.0F, 1.001F), 0.1F, 1.0F},
      {"sleepy", random_cubes(random, 900, 12.0F, 1.0F, 1.001F), 0.1F, 0.05F},
      {"still", random_cubes(random, 300, 8.0F, 1.0F, 1.001F), 0.1F, 0.0F},
      {"jumping", random_cubes(random, 700, 12.0F, 1.0F, 1.001F), 9.0F, 0.5F},
      {"mixed", random_cubes(random, 700, 25.0F, 0.1F, 10.0F), 0.3F, 1.0F},
      {"pile", with_ground(random_cubes(random, 600, 14.0F, 0.8F, 1.2F), 14.0F), 0.1F, 1.0F},
      {"far from the origin", random_cubes(random, 500, 9.0F, 1.0F, 1.001F), 0.1F, 1.0F},
      {"lattice", lattice(9), 1.0F, 0.1F},
      {"points", points(random, 400), 1.0F, 0.3F},
      wall,
  };
}

/// Moves some boxes and gives their rows. Lattice-like scenes move by whole units, so that boxes
/// keep touching exactly.
std::vector<std::uint32_t> move(Scene& scene, Generator& random) {
  const bool whole_units = scene.step == 1.0F;
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
    if (uniform(random, 0.0F, 1.0F) >= scene.moving) continue;
    Eigen::Vector3f by = point(random, -scene.step, scene.step);
    if (whole_units) by = by.array().round();
    if (by == Eigen::Vector3f::Zero()) continue;
    scene.boxes[i].min += by;
    scene.boxes[i].max += by;
    rows.push_back(static_cast<std::uint32_t>(i));
  }
  return rows;
}

std::vector<Pair> brute_force(const Boxes& boxes) {
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      if (boxes[i].overlaps(boxes[j])) pairs.push_back({i, j});
    }
  }
  return pairs;
}

bool agrees(const Engine& engine, const Scene& scene, int frame) {
  std::vector<Pair> found(engine.pairs().begin(), engine.pairs().end());
  std::sort(found.begin(), found.end());
  const std::vector<Pair> expected = brute_force(scene.boxes);
  if (found == expected) return true;
  std::printf("%s, scene %s, frame %d: %zu pairs, %zu expected\n", engine.name().c_str(),
              scene.name.c_str(), frame, found.size(), expected.size());
  return false;
}

/// True if the engine is right in every frame.
bool run(Engine& engine, Scene scene) {
  Generator random(7);
  if (scene.name == "far from the origin") {
    for (Aabb& box : scene.boxes) {
      box.min += Eigen::Vector3f::Constant(1e5F);
      box.max += Eigen::Vector3f::Constant(1e5F);
    }
  }
  engine.start(scene.boxes);
  bool right = agrees(engine, scene, 0);
  for (int frame = 1; frame <= kFrames; ++frame) {
    const std::vector<std::uint32_t> rows = move(scene, random);
    // A copy that dies with the frame: nothing of it may be kept.
    const Boxes boxes = scene.boxes;
    engine.frame(rows, boxes);
    right = agrees(engine, scene, frame) && right;
  }
  return right;
}

}  // namespace

int main() {
  bool right = true;
  std::size_t runs = 0;
  for (const int threads : {1, 2}) {
    tbb::task_arena arena(threads);
    for (const Scene& scene : scenes()) {
      for (const std::unique_ptr<Engine>& engine : winnow::bench::make_peers(threads)) {
        arena.execute([&] { right = run(*engine, scene) && right; });
        ++runs;
      }
    }
  }
  std::printf("%zu runs of %d frames: %s\n", runs, kFrames + 1, right ? "all agree" : "FAILED");
  return right ? 0 : 1;
}
