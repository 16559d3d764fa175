// Records some frames of a scene of boxes and balls that rest on each other. Run by pages.cmake.

#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/scene.h>

#include <array>
#include <cstdio>

int main(int count, char** arguments) {
  using namespace winnow;
  if (count != 2) {
    std::fprintf(stderr, "usage: %s FILE.winnow\n", arguments[0]);
    return 2;
  }
  constexpr int kBodies = 60;
  constexpr int kFrames = 4;
  Recorder recorder(arguments[1]);
  ShapePool shapes;
  const std::array<ShapeId, 2> kinds{shapes.add(BoxShape{{0.5, 0.5, 0.5}}),
                                     shapes.add(SphereShape{0.5})};
  Scene scene(shapes, {.recorder = &recorder});
  std::array<Key, kBodies> bodies;
  Contacts contacts;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int i = 0; i < kBodies; ++i) {
      const Pose pose = Pose::at(i % 4 * 0.95 + 0.02 * frame, i / 4 % 4 * 0.95, i / 16 * 0.95);
      Key& body = bodies[static_cast<std::size_t>(i)];
      const Status status =
          frame == 0
              ? scene.add({.shape = kinds[static_cast<std::size_t>(i % 2)], .pose = pose}).get(body)
              : scene.move(body, pose);
      if (status != Status::ok) return 1;
    }
    if (scene.collide(ContactLevel::manifold, contacts) != Status::ok) return 1;
    recorder.end_frame();
  }
  return recorder.status() == Status::ok ? 0 : 1;
}
