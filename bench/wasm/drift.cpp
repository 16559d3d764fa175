// Spheres and boxes, half of each, that drift and rotate in a cube. As a native program it reads
// lines from standard input: for each line `frame` it prints the milliseconds to move all bodies,
// the milliseconds to find all contacts, and the number of touching pairs. In WebAssembly,
// JavaScript calls the exported functions and reads the poses from memory.

#include <winnow/winnow.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#ifdef __wasm__
#define EXPORTED(name) __attribute__((export_name(name)))
#else
#define EXPORTED(name)
#endif

namespace {

struct Drift {
  double side = 0.0;
  std::vector<winnow::Pose> poses;
  std::vector<winnow::Vec3d> velocities;  // per frame
  std::vector<winnow::Key> keys;
  winnow::ShapePool shapes;
  winnow::Scene scene{shapes, {.execution = winnow::Execution::serial()}};
  winnow::Contacts contacts;
};

Drift& drift() {
  static Drift one;
  return one;
}

/// Returns the same numbers on every machine.
class Random {
 public:
  double between(double low, double high) {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return low + (high - low) * static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

void normalize(Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& x : q) x /= length;
}

// Rotates by a small angle about the (1, 1, 1) axis of the body.
void turn(Quaternion& q) {
  constexpr double kTurn = 0.01;
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  q[0] = w - kTurn * (x + y + z);
  q[1] = x + kTurn * (w + y - z);
  q[2] = y + kTurn * (w + z - x);
  q[3] = z + kTurn * (w + x - y);
  normalize(q);
}

}  // namespace

extern "C" {

/// Adds this many bodies at random positions, alternating spheres of radius 0.5 and boxes of edge
/// 1. Returns false if winnow rejects them.
EXPORTED("drift_start") bool drift_start(std::uint32_t count) {
  Drift& d = drift();
  Random random;
  d.side = std::cbrt(2.0 * count);
  winnow::ShapeId shape[2];
  if (d.shapes.add(winnow::SphereShape{0.5}, shape[0]) != winnow::Status::ok) return false;
  if (d.shapes.add(winnow::BoxShape{{0.5, 0.5, 0.5}}, shape[1]) != winnow::Status::ok) return false;
  std::vector<winnow::BodyDefinition> bodies(count);
  d.poses.resize(count);
  d.velocities.resize(count);
  d.keys.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (double& x : d.poses[i].position) x = random.between(0.0, d.side);
    for (double& q : d.poses[i].orientation) q = random.between(-1.0, 1.0);
    normalize(d.poses[i].orientation);
    for (int k = 0; k < 3; ++k) d.velocities[i][k] = random.between(-0.05, 0.05);
    bodies[i] = {.shape = shape[i % 2], .pose = d.poses[i], .state = winnow::BodyState::dynamic};
  }
  return d.scene.add(bodies, d.keys) == winnow::Status::ok;
}

/// Computes the poses of the next frame; drift_move passes them to the scene.
EXPORTED("drift_advance") void drift_advance() {
  Drift& d = drift();
  for (std::size_t i = 0; i < d.poses.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      double& x = d.poses[i].position[k];
      x += d.velocities[i][k];
      if (x < 0.0 || x > d.side) d.velocities[i][k] = -d.velocities[i][k];
    }
    turn(d.poses[i].orientation);
  }
}

/// Returns seven doubles for each body: position, and quaternion w, x, y, z.
EXPORTED("drift_poses") const winnow::Pose* drift_poses() {
  return drift().poses.data();
}

EXPORTED("drift_move") bool drift_move() {
  Drift& d = drift();
  return d.scene.move(d.keys, std::span<const winnow::Pose>(d.poses)) == winnow::Status::ok;
}

/// Finds contacts with manifolds and returns the number of touching pairs.
EXPORTED("drift_detect") std::uint32_t drift_detect() {
  Drift& d = drift();
  if (d.scene.collide(winnow::ContactLevel::manifold, d.contacts) != winnow::Status::ok) return 0;
  return static_cast<std::uint32_t>(d.contacts.manifolds());
}

EXPORTED("drift_isa") const char* drift_isa() {
  return winnow::isa_name();
}
}

#ifndef __wasm__
int main(int argc, char** argv) {
  const auto count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 5000UL;
  if (!drift_start(static_cast<std::uint32_t>(count))) return 1;
  const auto milliseconds = [](auto since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since)
        .count();
  };
  std::cout << drift_isa() << std::endl;
  for (std::string line; std::getline(std::cin, line) && line == "frame";) {
    drift_advance();
    const auto began = std::chrono::steady_clock::now();
    if (!drift_move()) return 1;
    const double moved = milliseconds(began);
    const std::uint32_t touching = drift_detect();
    std::cout << moved << ' ' << milliseconds(began) - moved << ' ' << touching << std::endl;
  }
}
#endif
