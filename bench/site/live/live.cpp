// The scene of page one: boxes that drift about a plane, which of them overlap, and what the page's
// pointer asks. One scene a page; JavaScript reads the arrays where they lie, until the next call.

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

// Off the walls, and back in.
void bounce(winnow::Aabb& box, winnow::Vec3f& speed, int axis, float end) {
  if (box.min[axis] < 0.0F && speed[axis] < 0.0F) speed[axis] = -speed[axis];
  if (box.max[axis] > end && speed[axis] > 0.0F) speed[axis] = -speed[axis];
}

}  // namespace

extern "C" {

#ifdef __wasm__
// The library for WASI cannot throw: what would ends the scene, as an exception in a callback ends
// a program. Nothing here does.
[[noreturn]] __attribute__((weak)) void __cxa_throw(void*, void*, void (*)(void*)) {
  __builtin_trap();
}
__attribute__((weak)) void* __cxa_allocate_exception(std::size_t) {
  __builtin_trap();
}
#endif

/// So many boxes at random; false if there was no memory for them.
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
  // As much of the plane is covered, however many there are.
  const float edge = 45.0F / std::sqrt(static_cast<float>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const winnow::Vec3f size(edge * draw(0.4F, 1.6F), edge * draw(0.4F, 1.6F), 1.0F);
    const winnow::Vec3f low(draw(0.0F, kWidth - size.x()), draw(0.0F, kHeight - size.y()), 0.0F);
    scene.boxes[i] = {low, low + size};
    scene.speeds[i] = {draw(-9.0F, 9.0F), draw(-9.0F, 9.0F), 0.0F};
  }
  return scene.partition.insert(scene.boxes, {}, scene.keys) == winnow::Status::ok;
}

/// Moves every box, and finds all pairs.
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

/// What a ball about a point meets.
EXPORTED("live_near") std::uint32_t live_near(float x, float y, float radius) {
  Live& scene = live();
  (void)scene.partition.overlap(winnow::Sphere{{x, y, 0.5F}, radius}, scene.near);
  return static_cast<std::uint32_t>(scene.near.size());
}

/// Where a ray from the middle to a point first meets a box, 1 at the point; above 1 if it meets
/// none.
EXPORTED("live_ray") float live_ray(float x, float y) {
  const winnow::Vec3f eye(kWidth / 2, kHeight / 2, 0.5F);
  Live& scene = live();
  winnow::Ray ray{eye, winnow::Vec3f(x, y, 0.5F) - eye};
  ray.max_t = 1.0F;
  if (scene.partition.closest(ray, scene.hit) != winnow::Status::ok || !scene.hit) return 2.0F;
  return scene.hit.t;
}

/// Six floats a box: its least and greatest corner.
EXPORTED("live_boxes") const float* live_boxes() {
  return live().boxes.front().min.data();
}
/// Two numbers of boxes a pair.
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
