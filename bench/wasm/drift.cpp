// Spheres and boxes, half of each, that drift and rotate in a cube. In WebAssembly, JavaScript
// calls the exported functions and reads the poses from memory. As a native program, with the
// numbers of bodies and frames as arguments, it prints the instruction set, and for each frame the
// milliseconds to move all bodies, the milliseconds to find all contacts, and the number of
// touching pairs.

#include <winnow/winnow.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <random>
#include <span>
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

void normalize(winnow::Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& x : q) x /= length;
}

}  // namespace

extern "C" {

/// Adds this many bodies at random positions, alternating spheres of radius 0.5 and boxes of edge
/// 1. Returns false if winnow rejects them.
EXPORTED("drift_start") bool drift_start(std::uint32_t count) {
  Drift& d = drift();
  std::mt19937_64 random(1);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
  };
  d.side = std::cbrt(2.0 * count);
  winnow::ShapeId shape[2];
  if (d.shapes.add(winnow::SphereShape{0.5}).get(shape[0]) != winnow::Status::ok) return false;
  if (d.shapes.add(winnow::BoxShape{{0.5, 0.5, 0.5}}).get(shape[1]) != winnow::Status::ok)
    return false;
  std::vector<winnow::BodyDefinition> bodies(count);
  d.poses.resize(count);
  d.velocities.resize(count);
  d.keys.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (double& x : d.poses[i].position) x = between(0.0, d.side);
    for (double& q : d.poses[i].orientation) q = between(-1.0, 1.0);
    normalize(d.poses[i].orientation);
    for (int k = 0; k < 3; ++k) d.velocities[i][k] = between(-0.05, 0.05);
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
    // Rotates by a small angle about the (1, 1, 1) axis of the body.
    winnow::Quaternion& turn = d.poses[i].orientation;
    turn = turn * winnow::Quaternion(1.0, 0.01, 0.01, 0.01);
    normalize(turn);
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
int main(int, char** argv) {
  if (!drift_start(static_cast<std::uint32_t>(std::atoi(argv[1])))) return 1;
  const auto milliseconds = [](auto since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since)
        .count();
  };
  std::cout << drift_isa() << '\n';
  for (int frame = 0; frame < std::atoi(argv[2]); ++frame) {
    drift_advance();
    const auto began = std::chrono::steady_clock::now();
    if (!drift_move()) return 1;
    const double moved = milliseconds(began);
    const std::uint32_t touching = drift_detect();
    std::cout << moved << ' ' << milliseconds(began) - moved << ' ' << touching << '\n';
  }
}
#endif
