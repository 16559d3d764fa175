// Brute force: every row is tested against every other row.

#include "partitions/structures/brute_force/flat_rows.kernel.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/structure.h"
#include "partitions/structures/tasks.h"

#include <algorithm>
#include <cmath>

namespace winnow {

WINNOW_DEFINE_KERNELS(FlatKernels, flat_kernels)

namespace {

const FlatKernel& untested(Volume) noexcept {
  return flat_kernels().untested;
}

const FlatKernel& testing(Volume volume) noexcept {
  const FlatKernels& kernels = flat_kernels();
  switch (volume) {
    case Volume::aabb:
      return kernels.aabb;
    case Volume::sphere:
      return kernels.sphere;
    case Volume::kdop14:
      return kernels.kdop14;
    case Volume::kdop18:
      return kernels.kdop18;
    case Volume::kdop26:
      return kernels.kdop26;
  }
  return kernels.aabb;
}

/// Unordered rows with the kernel for their volume.
class BruteForce : public Structure {
 public:
  using KernelFor = const FlatKernel& (*)(Volume) noexcept;

  BruteForce(const StructureInput& input, KernelFor kernel_for) noexcept
      : Structure(input), kernel_for_(kernel_for) {}

  [[nodiscard]] bool is_flat() const noexcept override { return true; }
  [[nodiscard]] bool reserve(const BuildRoom&) noexcept override { return true; }

  [[nodiscard]] std::size_t pair_tasks() const noexcept override {
    return std::min(kMaxTasks, pool().blocks());
  }
  bool run_pair_task(std::size_t task, PairSink& sink) const noexcept override {
    return kernel_for_(pool().volume())
        .self_pairs(view(), first_block(task), first_block(task + 1), sink);
  }
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override {
    // Boxes are tested against boxes, as in every structure.
    const Volume volume = batch.is_box ? Volume::aabb : pool().volume();
    return kernel_for_(volume).query(view(), batch, sink);
  }

 private:
  // A block is tested against itself and all later blocks, so the last share x of the blocks has a
  // share x^2 of the pairs of blocks. Tasks take ranges of blocks with equal numbers of pairs.
  [[nodiscard]] std::uint32_t first_block(std::size_t task) const noexcept {
    const std::size_t tasks = pair_tasks();
    if (task >= tasks) return static_cast<std::uint32_t>(pool().blocks());
    const double left = 1.0 - static_cast<double>(task) / static_cast<double>(tasks);
    const double done = (1.0 - std::sqrt(left)) * static_cast<double>(pool().blocks());
    return static_cast<std::uint32_t>(done);
  }
  [[nodiscard]] FlatView view() const noexcept {
    const TreeView blocks = regular_tree();
    return {blocks.rows, static_cast<std::uint32_t>(pool().rows()), blocks};
  }

  const KernelFor kernel_for_;
};

/// Reports every pair of objects without testing bounds. Benchmarks use it as a baseline. Fuzz
/// tests use it for reference scenes, whose pairs then do not depend on bounds.
class NSquared final : public BruteForce {
 public:
  explicit NSquared(const StructureInput& input) noexcept : BruteForce(input, untested) {}

  [[nodiscard]] bool tests_volumes() const noexcept override { return false; }
};

/// Tests the bounding volume of every object against every other, 16 at a time: the least memory,
/// and the best choice for some dozens of objects by its costs below. O(n^2 / 16) tests. Exact for
/// its volume.
class BoundsNSquared final : public BruteForce {
 public:
  explicit BoundsNSquared(const StructureInput& input) noexcept : BruteForce(input, testing) {}
};

constexpr StructureCosts kCosts{.frame = 60,
                                .keep = 6,
                                .level = 0.063,
                                .crowd = 0.6,
                                .square = 0.25,
                                .pair = 3.2,
                                .moved = 150,
                                .rest = 1.5,
                                .build = 42,
                                .query = 120,
                                .scan = 0.75};
constexpr StructureInfo kNSquared = structure_info<NSquared>("NSquared");
constexpr StructureInfo kBoundsNSquared = structure_info<BoundsNSquared>("BoundsNSquared", &kCosts);

}  // namespace

StructureKind n_squared() noexcept {
  return StructureKind(kNSquared);
}

StructureKind bounds_n_squared() noexcept {
  return StructureKind(kBoundsNSquared);
}

}  // namespace winnow
