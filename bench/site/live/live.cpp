// The scene on the site's first page: boxes that drift in a plane, their overlapping pairs, and the
// queries at the page's pointer. There is one scene per page; JavaScript reads the arrays from
// memory, until the next call.

#include <winnow/partitions/partition.h>
#include <winnow/simd/isa.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#ifdef __wasm__
#define EXPORTED(name) __attribute__((export_name(name)))
#else
#define EXPORTED(name)
#endif

namespace {

constexpr float kWidth = 160.0F;
constexpr float kHeight = 90.0F;

struct Live {
  winnow::Partition partition{winnow::linear_bvh(), {.execution = winnow::Execution::serial()}};
  std::vector<winnow::Aabb> boxes;
  std::vector<winnow::Vec3f> speeds;
  std::vector<winnow::Key> keys;
  winnow::PairBuffer pairs;
  winnow::OverlapBuffer near;
  winnow::Hit hit;
};

Live& live() {
  static Live scene;
  return scene;
}

// Reverses the speed at the walls.
void bounce(winnow::Aabb& box, winnow::Vec3f& speed, int axis, float end) {
  if (box.min[axis] < 0.0F && speed[axis] < 0.0F) speed[axis] = -speed[axis];
  if (box.max[axis] > end && speed[axis] > 0.0F) speed[axis] = -speed[axis];
}

}  // namespace

extern "C" {

/// Adds this many boxes at random positions; returns false if memory ran out.
EXPORTED("live_start") bool live_start(std::uint32_t count) {
  Live& scene = live();
  std::mt19937 random(7);
  const auto draw = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random()) * 0x1p-32F;
  };
  scene.partition.clear();
  scene.boxes.resize(count);
  scene.speeds.resize(count);
  scene.keys.resize(count);
  // The covered share of the plane does not depend on the number of boxes.
  const float edge = 45.0F / std::sqrt(static_cast<float>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const winnow::Vec3f size(edge * draw(0.4F, 1.6F), edge * draw(0.4F, 1.6F), 1.0F);
    const winnow::Vec3f low(draw(0.0F, kWidth - size.x()), draw(0.0F, kHeight - size.y()), 0.0F);
    scene.boxes[i] = {low, low + size};
    scene.speeds[i] = {draw(-9.0F, 9.0F), draw(-9.0F, 9.0F), 0.0F};
  }
  return scene.partition.insert(scene.boxes, {}, scene.keys) == winnow::Status::ok;
}

/// Moves every box and returns the number of overlapping pairs.
EXPORTED("live_step") std::uint32_t live_step(float seconds) {
  Live& scene = live();
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
    const winnow::Vec3f way = seconds * scene.speeds[i];
    scene.boxes[i].min += way;
    scene.boxes[i].max += way;
    bounce(scene.boxes[i], scene.speeds[i], 0, kWidth);
    bounce(scene.boxes[i], scene.speeds[i], 1, kHeight);
  }
  (void)scene.partition.update(scene.keys, scene.boxes);
  (void)scene.partition.self_pairs(scene.pairs);
  return static_cast<std::uint32_t>(scene.pairs.size());
}

/// Returns the number of boxes that overlap a ball.
EXPORTED("live_near") std::uint32_t live_near(float x, float y, float radius) {
  Live& scene = live();
  (void)scene.partition.overlap(winnow::Sphere{{x, y, 0.5F}, radius}, scene.near);
  return static_cast<std::uint32_t>(scene.near.size());
}

/// Returns the ray parameter of the first hit on the segment from the centre to a point (1 at the
/// point), or a value above 1 without a hit.
EXPORTED("live_ray") float live_ray(float x, float y) {
  const winnow::Vec3f eye(kWidth / 2, kHeight / 2, 0.5F);
  Live& scene = live();
  winnow::Ray ray{eye, winnow::Vec3f(x, y, 0.5F) - eye};
  ray.max_t = 1.0F;
  if (scene.partition.closest(ray).get(scene.hit) != winnow::Status::ok || !scene.hit) return 2.0F;
  return scene.hit.t;
}

/// Returns six floats for each box: its lower and upper corner.
EXPORTED("live_boxes") const float* live_boxes() {
  return live().boxes.front().min.data();
}
/// Returns two box numbers for each pair.
EXPORTED("live_pairs") const winnow::Pair* live_pairs() {
  return live().pairs.begin();
}
EXPORTED("live_near_ids") const std::uint32_t* live_near_ids() {
  return live().near.ids().data();
}
EXPORTED("live_isa") const char* live_isa() {
  return winnow::isa_name();
}
}
