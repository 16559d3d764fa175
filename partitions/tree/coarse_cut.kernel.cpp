// Kernels of coarse_cut.cpp: plan cells from a sample and assign points to them.

#include "partitions/tree/coarse_cut.kernel.h"
#include "partitions/tree/axis_extent.wide.h"
#include "partitions/tree/equal_parts.wide.h"
#include "simd/lanes/lanes.h"
#include "simd/lanes/load_partial.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

static_assert(CoarseCells::kPlaces == kPlacesPerAxis);

constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);
constexpr std::size_t kSample = 4096;

void reach(const float* x, std::size_t count, float& least, float& greatest) {
  const AxisExtent of = AxisExtent::of(x, count);
  least = of.low;
  greatest = of.high;
}

/// The number of parts of each axis, for approximately cubic cells.
struct CoarseParts {
  std::uint32_t slabs = 0;
  std::uint32_t lines = 0;
  std::uint32_t cells = 0;

  /// Lengths of the axes, longest first.
  CoarseParts(const float* length, std::uint32_t target_cells) {
    const float longest = length[0];
    const auto all = static_cast<float>(target_cells);
    if (longest > kMinExtent) {
      const float m = length[1] / longest;
      const float s = length[2] / longest;
      // Rounded roots.
      const auto half = [](std::uint32_t n) { return static_cast<float>(n) + 0.5F; };
      while (half(slabs) * half(slabs) * half(slabs) * m < all * s * s) ++slabs;
      const float of_slab = slabs == 0 ? all : all / static_cast<float>(slabs);
      while (half(lines) * half(lines) < of_slab * m) ++lines;
    }
    slabs = slabs == 0 ? 1 : slabs;
    lines = lines == 0 ? 1 : lines;
    while (slabs * lines > target_cells) --(lines > 1 ? lines : slabs);
    cells = (2 * target_cells + slabs * lines) / (2 * slabs * lines);
    while (slabs * lines * cells > kMaxCoarseCells) --cells;
  }
};

/// Places (see equal_parts.wide.h) of a sample of the points.
struct CoarseSample {
  std::uint8_t place[3][kSample];
  std::size_t count = 0;

  CoarseSample(const CoarseCells& plan, const float* const* at, std::size_t points) {
    const std::size_t stride = (points + kSample - 1) / kSample;
    count = (points + stride - 1) / stride;
    alignas(64) float x[kLanes] = {};
    alignas(64) std::uint32_t whole[kLanes];
    for (int k = 0; k < 3; ++k) {
      const float* const all = at[plan.axis[k]];
      for (std::size_t i = 0; i < count; i += kStep) {
        const std::size_t here = count - i < kStep ? count - i : kStep;
        for (std::size_t lane = 0; lane < here; ++lane) x[lane] = all[(i + lane) * stride];
        places_of(Floats::load(x), plan.half_low[k], plan.scale[k]).store(whole);
        for (std::size_t lane = 0; lane < here; ++lane) {
          place[k][i + lane] = static_cast<std::uint8_t>(whole[lane]);
        }
      }
    }
  }
};

/// Cuts each of `rows` sets of the sample into `parts` parts along axis k.
template <typename RowOf>
void cut_rows(const CoarseSample& sample, int k, std::uint32_t rows, std::uint32_t parts,
              const RowOf& row_of, std::uint8_t (*part)[kPlacesPerAxis]) {
  std::uint32_t points[kMaxCoarseCells][kPlacesPerAxis];
  std::uint32_t all[kMaxCoarseCells] = {};
  __builtin_memset(points, 0, rows * sizeof points[0]);
  for (std::size_t i = 0; i < sample.count; ++i) {
    const std::uint32_t row = row_of(i);
    ++points[row][sample.place[k][i]];
    ++all[row];
  }
  for (std::uint32_t r = 0; r < rows; ++r) {
    cut_equally(points[r], all[r], parts, part[r]);
    // Odd rows run backwards.
    for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) {
      const std::uint32_t own = (r & 1U) != 0 ? parts - 1 - part[r][p] : part[r][p];
      part[r][p] = static_cast<std::uint8_t>(r * parts + own);
    }
  }
}

bool is_concentrated(const CoarseSample& sample, int k) {
  std::uint32_t points[kPlacesPerAxis] = {};
  for (std::size_t i = 0; i < sample.count; ++i) ++points[sample.place[k][i]];
  return most_at_a_place(points) > sample.count / 32 + kStep;
}

bool plan(const float* const* at, std::size_t count, const float* least, const float* greatest,
          std::uint32_t target_cells, CoarseCells& plan) {
  float length[3];
  int order[3];
  for (int a = 0; a < 3; ++a) length[a] = AxisExtent{least[a], greatest[a]}.half();
  order_by_length(length, order);
  const float sorted[3] = {length[order[0]], length[order[1]], length[order[2]]};
  const CoarseParts parts(sorted, target_cells);
  for (int k = 0; k < 3; ++k) {
    const int axis = order[2 - k];
    plan.axis[k] = axis;
    plan.half_low[k] = 0.5F * least[axis];
    plan.scale[k] = places_per(length[axis]);
  }
  plan.cells = parts.slabs * parts.lines * parts.cells;
  const CoarseSample sample(plan, at, count);
  const std::uint32_t cuts[3] = {parts.slabs, parts.lines, parts.cells};
  for (int k = 0; k < 3; ++k) {
    if (cuts[k] != 1 && is_concentrated(sample, k)) return false;
  }
  const auto slab_of = [&](std::size_t i) -> std::uint32_t {
    return plan.slab[sample.place[0][i]];
  };
  const auto line_of = [&](std::size_t i) -> std::uint32_t {
    return plan.line[slab_of(i)][sample.place[1][i]];
  };
  cut_rows(
      sample, 0, 1, parts.slabs, [](std::size_t) { return 0U; }, &plan.slab);
  cut_rows(sample, 1, parts.slabs, parts.lines, slab_of, plan.line);
  cut_rows(sample, 2, parts.slabs * parts.lines, parts.cells, line_of, plan.cell);
  return true;
}

void assign(const CoarseCells& plan, const float* const* at, std::size_t begin, std::size_t end,
            std::uint8_t* cell, std::uint32_t* sizes) {
  for (std::uint32_t c = 0; c < plan.cells; ++c) sizes[c] = 0;
  alignas(64) std::uint32_t place[3][kLanes];
  for (std::size_t i = begin; i < end; i += kStep) {
    const std::size_t here = end - i < kStep ? end - i : kStep;
    for (int k = 0; k < 3; ++k) {
      const Floats x = load_partial(at[plan.axis[k]] + i, here);
      places_of(x, plan.half_low[k], plan.scale[k]).store(place[k]);
    }
    for (std::size_t lane = 0; lane < here; ++lane) {
      const std::uint8_t line = plan.line[plan.slab[place[0][lane]]][place[1][lane]];
      const std::uint8_t own = plan.cell[line][place[2][lane]];
      cell[i + lane] = own;
      ++sizes[own];
    }
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const CoarseCutKernels WINNOW_KERNEL_TABLE(coarse_cut_kernels) = {
    WINNOW_ISA_NAME::reach, WINNOW_ISA_NAME::plan, WINNOW_ISA_NAME::assign};

}  // namespace winnow
