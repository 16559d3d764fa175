// The frame loop of a renderer: some objects move, then each camera collects its visible objects.
// Compared with the usual loop over all boxes, which tests six planes each.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

/// The fastest form of the loop: boxes in columns and no branch before the last line, so that
/// compilers vectorise it.
class CullingLoop {
 public:
  explicit CullingLoop(std::span<const winnow::Aabb> boxes) : is_seen_(boxes.size()) {
    for (auto& column : low_) column.resize(boxes.size());
    for (auto& column : high_) column.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) set(i, boxes[i]);
  }

  void set(std::size_t i, const winnow::Aabb& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis][i] = box.min[axis];
      high_[axis][i] = box.max[axis];
    }
  }

  void look(const winnow::Frustum& camera, std::vector<std::uint32_t>& seen) {
    std::fill(is_seen_.begin(), is_seen_.end(), 1);
    for (const winnow::Plane& plane : camera.planes) cut(plane);
    seen.resize(is_seen_.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < is_seen_.size(); ++i) {
      seen[count] = static_cast<std::uint32_t>(i);
      count += static_cast<std::size_t>(is_seen_[i]);
    }
    seen.resize(count);
  }

 private:
  // A box is outside of an inward-facing plane if its farthest corner along the normal is.
  void cut(const winnow::Plane& plane) {
    const auto corner = [&](std::size_t axis) {
      const bool up = plane.normal[axis] > 0.0F;
      return (up ? high_ : low_)[axis].data();
    };
    const float* const x = corner(0);
    const float* const y = corner(1);
    const float* const z = corner(2);
    const winnow::Vec3f n = plane.normal;
    for (std::size_t i = 0; i < is_seen_.size(); ++i) {
      const float far = n.x() * x[i] + n.y() * y[i] + n.z() * z[i] + plane.offset;
      is_seen_[i] &= far >= 0.0F ? 1 : 0;
    }
  }

  std::array<std::vector<float>, 3> low_;
  std::array<std::vector<float>, 3> high_;
  std::vector<std::int32_t> is_seen_;
};

/// A town: objects on a plane, of which one in fifty moves.
class Town {
 public:
  explicit Town(std::size_t count) : side_(2.0F * std::sqrt(static_cast<float>(count))) {
    std::uniform_real_distribution<float> place(0.0F, side_);
    std::uniform_real_distribution<float> edge(0.5F, 2.0F);
    for (std::size_t i = 0; i < count; ++i) {
      const winnow::Vec3f at(place(random_), place(random_), 0.0F);
      boxes.push_back({at, at + winnow::Vec3f(edge(random_), edge(random_), edge(random_))});
      if (i % 50 == 0) moving.push_back(static_cast<std::uint32_t>(i));
    }
  }
  void step() {
    for (const std::uint32_t i : moving) {
      boxes[i].min.x() += 0.1F;
      boxes[i].max.x() += 0.1F;
    }
  }
  /// Returns the camera of frame i, which circles above the town and looks ahead.
  [[nodiscard]] winnow::Frustum camera(std::size_t i) const {
    const float angle = 0.02F * static_cast<float>(i);
    const winnow::Vec3f ahead(std::cos(angle), std::sin(angle), -0.2F);
    const winnow::Vec3f eye = winnow::Vec3f(0.5F * side_, 0.5F * side_, 5.0F);
    return winnow::Frustum::perspective(eye, ahead, {0, 0, 1}, 1.0F, 1.6F, 0.1F, 150.0F);
  }

  std::vector<winnow::Aabb> boxes;
  std::vector<std::uint32_t> moving;

 private:
  std::mt19937 random_{1};
  float side_;
};

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  Town town(race.size(5'000, 100'000));

  winnow::Partition partition(winnow::linear_bvh(), {.execution = winnow::Execution::serial()});
  std::vector<winnow::Key> keys(town.boxes.size());
  check(partition.insert(town.boxes, {}, keys) == winnow::Status::ok, "objects are inserted");
  winnow::OverlapBuffer seen;
  CullingLoop loop(town.boxes);
  std::vector<std::uint32_t> expected;
  for (std::size_t frame = 0; frame < race.size(5, 200); ++frame) {
    town.step();
    const winnow::Frustum camera = town.camera(frame);
    race.time("winnow", [&] {
      check(partition.update(keys, town.boxes, winnow::IndexSubset::listed(town.moving)) ==
                winnow::Status::ok,
            "objects move");
      check(partition.overlap(camera, seen) == winnow::Status::ok, "the camera looks");
    });
    race.time("a loop over all boxes", [&] {
      for (const std::uint32_t i : town.moving) loop.set(i, town.boxes[i]);
      loop.look(camera, expected);
    });
    // The loop accepts boxes that are outside of the frustum but not outside of any single plane.
    check(seen.size() <= expected.size(), "winnow sees no more than the loop");
    check(10 * (expected.size() - seen.size()) <= expected.size(), "and hardly less");
  }
  return race.finish("culling: " + std::to_string(town.boxes.size()) + " objects, " +
                     std::to_string(seen.size()) + " seen, one thread each");
}
