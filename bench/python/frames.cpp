// The C++ counterpart of race.py: the same frames by the same calls.
//
// Usage: winnow_python_frames boxes|worlds FILE OBJECTS
//
// FILE contains frames of OBJECTS boxes, six floats each, or of OBJECTS positions of balls of
// radius 0.5, ten per environment, three doubles each. Prints the median milliseconds of a frame
// and the number of pairs or contacts of the last one.

#include <winnow/winnow.h>
#include "bench/common/need.h"
#include "bench/common/sample.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

namespace {

using namespace winnow;
using bench::need;

template <typename T>
std::vector<T> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<T> values(bytes.size() / sizeof(T));
  std::copy_n(bytes.data(), values.size() * sizeof(T), reinterpret_cast<char*>(values.data()));
  return values;
}

/// Returns the median time of all frames but the first.
template <typename Frame>
double median_ms(std::size_t frames, Frame&& frame) {
  std::vector<double> times;
  for (std::size_t f = 1; f < frames; ++f) {
    const bench::Stopwatch clock;
    frame(f);
    times.push_back(clock.ms());
  }
  return bench::median_of(times);
}

void time_boxes(const char* path, std::size_t objects) {
  const std::vector<float> values = read<float>(path);
  const auto boxes = [&](std::size_t frame) {
    const float* const p = values.data() + frame * objects * 6;
    return BoxView({p, p + 1, p + 2}, {p + 3, p + 4, p + 5}, objects, 6 * sizeof(float));
  };
  Partition partition(linear_bvh());
  std::vector<Key> keys(objects);
  need(partition.insert(boxes(0), {}, keys), "insert");
  PairBuffer pairs;
  need(partition.self_pairs(pairs), "self_pairs");
  const double ms = median_ms(values.size() / objects / 6, [&](std::size_t frame) {
    need(partition.update(keys, boxes(frame)), "update");
    need(partition.self_pairs(pairs), "self_pairs");
  });
  std::printf("%.6f %zu\n", ms, pairs.size());
}

void time_worlds(const char* path, std::size_t objects) {
  const std::vector<double> values = read<double>(path);
  const auto poses = [&](std::size_t frame) {
    const double* const p = values.data() + frame * objects * 3;
    return PoseView({p, p + 1, p + 2}, std::array<const double*, 4>{}, objects, 3 * sizeof(double));
  };
  ShapePool shapes;
  ShapeId ball;
  need(shapes.add(SphereShape{0.5}, ball), "a ball");
  Scene scene(shapes);
  std::vector<BodyDefinition> bodies(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    bodies[i].shape = ball;
    bodies[i].pose = poses(0)[i];
    bodies[i].filter.environment = static_cast<std::uint32_t>(i / 10);
  }
  std::vector<Key> keys(objects);
  need(scene.add(bodies, keys), "add");
  Contacts contacts;
  need(scene.collide(ContactLevel::distance, contacts), "collide");
  const double ms = median_ms(values.size() / objects / 3, [&](std::size_t frame) {
    need(scene.move(keys, poses(frame)), "move");
    need(scene.collide(ContactLevel::distance, contacts), "collide");
  });
  std::printf("%.6f %zu\n", ms, contacts.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::size_t objects = std::strtoul(argv[3], nullptr, 10);
  if (std::string_view(argv[1]) == "boxes") time_boxes(argv[2], objects);
  if (std::string_view(argv[1]) == "worlds") time_worlds(argv[2], objects);
}
