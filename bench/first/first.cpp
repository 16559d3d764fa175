// The first table of bench/run: frames of 10,000 moving boxes in each structure. The program links
// only partitions, so that the table appears minutes before the tool is built.
// `winnow dev throughput` measures the same kinds of frames in turns and on several threads.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kBoxes = 10'000;
constexpr std::size_t kFrames = 31;

/// Boxes at uniform places, which move a little in each frame.
class MovingBoxes {
 public:
  MovingBoxes() : random_(1) {
    std::uniform_real_distribution<float> place(0.0F, 40.0F);
    for (std::size_t i = 0; i < kBoxes; ++i) {
      const Vec3f low{place(random_), place(random_), place(random_)};
      boxes_.push_back({low, low + Vec3f{1, 1, 1}});
    }
  }
  [[nodiscard]] const std::vector<Aabb>& boxes() const noexcept { return boxes_; }
  void move() {
    std::uniform_real_distribution<float> step(-0.1F, 0.1F);
    for (Aabb& box : boxes_) {
      const Vec3f way{step(random_), step(random_), step(random_)};
      box = {box.min + way, box.max + way};
    }
  }

 private:
  std::mt19937 random_;
  std::vector<Aabb> boxes_;
};

struct Frames {
  double median_ms = 0.0;
  std::size_t pairs = 0;
  double bytes_per_box = 0.0;
};

/// Updates all boxes and finds all pairs, kFrames times. False if a call fails.
[[nodiscard]] bool measure(StructureKind structure, Frames& frames) {
  MovingBoxes scene;
  Partition partition(structure, {.execution = Execution::serial()});
  std::vector<Key> keys(kBoxes);
  PairBuffer pairs;
  if (partition.insert(scene.boxes(), {}, keys) != Status::ok) return false;
  std::vector<double> times;
  for (std::size_t i = 0; i < kFrames; ++i) {
    scene.move();
    const auto began = std::chrono::steady_clock::now();
    if (partition.update(keys, scene.boxes()) != Status::ok) return false;
    if (partition.self_pairs(pairs) != Status::ok) return false;
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
    times.push_back(took.count());
  }
  std::ranges::nth_element(times, times.begin() + kFrames / 2);
  frames = {times[kFrames / 2], pairs.size(),
            static_cast<double>(partition.footprint().total().used) / kBoxes};
  return true;
}

}  // namespace
}  // namespace winnow::bench

int main() {
  using namespace winnow;
  std::printf("%zu boxes move, 1 thread, median of %zu frames\n", bench::kBoxes, bench::kFrames);
  std::printf("%-18s%10s%10s%15s\n", "partition", "frame ms", "pairs", "bytes per box");
  for (const StructureKind structure : all_structures()) {
    if (structure == n_squared()) continue;  // returns all 50 million pairs, untested
    bench::Frames frames;
    if (!bench::measure(structure, frames)) return 1;
    std::printf("%-18s%10.3f%10zu%15.1f\n", std::string(structure.name()).c_str(), frames.median_ms,
                frames.pairs, frames.bytes_per_box);
  }
}
