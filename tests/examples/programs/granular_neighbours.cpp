// Touching grains of a dense packing, in every step of a granular simulation, compared with the
// cell list that such programs usually contain. The diameters are between 0.5 and 1.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

using Pairs = std::vector<winnow::Pair>;

bool touch(const winnow::Sphere& a, const winnow::Sphere& b) {
  const float reach = a.radius + b.radius;
  return (a.center - b.center).squared_norm() <= reach * reach;
}

/// A grid of cells as wide as the largest grain. A counting sort orders the grains by cell. The
/// grains of a cell are tested with each other and with the grains of half of the 26 neighbours.
class CellList {
 public:
  CellList(float cell, float world) : cell_(cell), side_(static_cast<int>(world / cell) + 3) {
    first_.resize(static_cast<std::size_t>(side_ * side_ * side_) + 1);
  }

  void find(std::span<const winnow::Sphere> grains, Pairs& pairs) {
    sort(grains);
    pairs.clear();
    for (int z = 1; z < side_ - 1; ++z) {
      for (int y = 1; y < side_ - 1; ++y) {
        for (int x = 1; x < side_ - 1; ++x) find_in(index(x, y, z), pairs);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>((z * side_ + y) * side_ + x);
  }
  [[nodiscard]] int coordinate(float x) const {
    return std::clamp(static_cast<int>(x / cell_) + 1, 1, side_ - 2);
  }

  void sort(std::span<const winnow::Sphere> grains) {
    cell_of_.resize(grains.size());
    sorted_.resize(grains.size());
    number_.resize(grains.size());
    std::fill(first_.begin(), first_.end(), 0U);
    for (std::size_t i = 0; i < grains.size(); ++i) {
      const winnow::Vec3f& c = grains[i].center;
      cell_of_[i] = index(coordinate(c.x()), coordinate(c.y()), coordinate(c.z()));
      ++first_[cell_of_[i]];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& first : first_) first = sum += first;
    for (std::size_t i = grains.size(); i-- > 0;) {
      const std::uint32_t place = --first_[cell_of_[i]];
      sorted_[place] = grains[i];
      number_[place] = static_cast<std::uint32_t>(i);
    }
  }

  void find_in(std::size_t cell, Pairs& pairs) {
    const auto row = static_cast<std::size_t>(side_);
    const std::size_t layer = row * row;
    for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
      // The rest of this cell and the next cell; then rows of three adjacent cells.
      test(i, i + 1, first_[cell + 2], pairs);
      for (const std::size_t middle :
           {cell + row, cell + layer - row, cell + layer, cell + layer + row}) {
        test(i, first_[middle - 1], first_[middle + 2], pairs);
      }
    }
  }

  void test(std::uint32_t i, std::uint32_t begin, std::uint32_t end, Pairs& pairs) {
    const winnow::Sphere grain = sorted_[i];
    for (std::uint32_t j = begin; j < end; ++j) {
      if (!touch(grain, sorted_[j])) continue;
      pairs.push_back({std::min(number_[i], number_[j]), std::max(number_[i], number_[j])});
    }
  }

  float cell_;
  int side_;
  std::vector<std::uint32_t> first_;
  std::vector<std::size_t> cell_of_;
  std::vector<winnow::Sphere> sorted_;
  std::vector<std::uint32_t> number_;
};

/// Grains that jitter about fixed positions.
struct Packing {
  explicit Packing(std::size_t count) : side(std::cbrt(0.35F * static_cast<float>(count))) {
    std::uniform_real_distribution<float> place(0.0F, side);
    std::uniform_real_distribution<float> radius(0.25F, 0.5F);
    for (std::size_t i = 0; i < count; ++i) {
      grains.push_back({{place(random), place(random), place(random)}, radius(random)});
    }
  }
  void step() {
    std::uniform_real_distribution<float> by(-0.002F, 0.002F);
    for (winnow::Sphere& grain : grains) {
      grain.center += winnow::Vec3f(by(random), by(random), by(random));
    }
  }

  std::mt19937 random{1};
  float side;
  std::vector<winnow::Sphere> grains;
};

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  Packing packing(race.size(2'000, 100'000));

  winnow::Partition partition(winnow::linear_bvh(), {.execution = winnow::Execution::serial(),
                                                     .volume = winnow::Volume::sphere});
  std::vector<winnow::Key> keys(packing.grains.size());
  check(partition.insert(packing.grains, {}, keys) == winnow::Status::ok, "grains are inserted");
  winnow::PairBuffer pairs;
  CellList cells(1.0F, packing.side);
  Pairs expected;
  for (std::size_t frame = 0; frame < race.size(5, 40); ++frame) {
    packing.step();
    race.time("winnow, spheres", [&] {
      check(partition.update(keys, packing.grains) == winnow::Status::ok, "grains move");
      check(partition.self_pairs(pairs) == winnow::Status::ok, "pairs are found");
    });
    race.time("a plain cell list", [&] { cells.find(packing.grains, expected); });
    // winnow may report spheres whose gap is below the rounding of a float.
    const auto touching = std::ranges::count_if(pairs.pairs(), [&](const winnow::Pair& pair) {
      return touch(packing.grains[pair.first], packing.grains[pair.second]);
    });
    check(static_cast<std::size_t>(touching) == expected.size(), "both find as many pairs");
  }
  return race.finish("granular neighbours: " + std::to_string(packing.grains.size()) + " grains, " +
                     std::to_string(pairs.size()) + " pairs, one thread each");
}
