#include "partitions/choice/sample_scene.h"

#include "core/sort/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>

namespace winnow {
namespace {

// The sample has one row in eight, but at least 64 and at most kMaxSampled.
constexpr std::size_t kMaxSampled = 512;
constexpr double kUnbounded = 1e30;
constexpr std::size_t kCells = 64;
constexpr double kMaxPairs = 16.0;  // per object; larger estimates are mostly wrong

// Returns log2, exact at powers of two and linear between them: within 0.09 of log2, and identical
// on every machine.
double rough_log2(double value) noexcept {
  int exponent = 0;
  const double part = std::frexp(value, &exponent);
  return exponent - 2.0 + 2.0 * part;
}

/// Columns of the sampled boxes.
struct BoxSample {
  std::size_t count = 0;
  std::array<std::array<float, kMaxSampled>, 3> low;
  std::array<std::array<float, kMaxSampled>, 3> edge;
  std::array<float, kMaxSampled> longest;

  BoxSample(const BoundsPool& pool, std::size_t live) noexcept {
    const std::size_t sample_size = std::clamp<std::size_t>(live / 8, 64, kMaxSampled);
    const std::size_t step = std::max<std::size_t>(1, pool.rows() / sample_size);
    const std::array<const float*, 6> box = box_columns(pool);
    for (std::size_t row = step / 2; row < pool.rows() && count < kMaxSampled; row += step) {
      if (pool.ids()[row] == kNoObject) continue;
      longest[count] = 0.0F;
      for (std::size_t a = 0; a < 3; ++a) {
        low[a][count] = box[a][row];
        edge[a][count] = box[3 + a][row] - low[a][count];
        longest[count] = std::max(longest[count], edge[a][count]);
      }
      ++count;
    }
  }

  // Returns the value below which `share` of the sample is. `share` must be less than 0.12 from 0
  // or from 1, because kMaxRank limits the rank.
  [[nodiscard]] double quantile(const std::array<float, kMaxSampled>& values,
                                double share) const noexcept {
    const auto at = static_cast<std::size_t>(share * static_cast<double>(count - 1));
    const std::span<const float> all(values.data(), count);
    return static_cast<double>(share < 0.5 ? value_of_rank(all, at, std::less<>())
                                           : value_of_rank(all, count - 1 - at, std::greater<>()));
  }

  [[nodiscard]] double mean_edge(std::size_t axis) const noexcept {
    double sum = 0.0;
    std::size_t bounded = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto e = static_cast<double>(edge[axis][i]);
      if (!(e < kUnbounded)) continue;
      sum += e;
      ++bounded;
    }
    return bounded == 0 ? 0.0 : sum / static_cast<double>(bounded);
  }
};

/// An axis divided evenly into cells.
struct SampledAxis {
  double from = 0.0;
  double range = 0.0;
  std::size_t cells = 1;
  double cells_of_length = 0.0;  // number of cells per unit of length

  void divide(std::size_t count) noexcept {
    cells = count;
    cells_of_length = count == 1 ? 0.0 : static_cast<double>(count) / range;
  }
  [[nodiscard]] std::size_t cell_of(float low) const noexcept {
    const double at = (static_cast<double>(low) - from) * cells_of_length;
    // The comparison sends NaN, from an axis of infinite range, to the first cell.
    return at > 0.0 ? static_cast<std::size_t>(std::min(at, static_cast<double>(cells - 1))) : 0;
  }
};

// Divides the axes that have room into 64 cells: 4 x 4 x 4, 8 x 8 or 64 in a row.
void divide(std::array<SampledAxis, 3>& axes, const std::array<double, 3>& room) noexcept {
  constexpr std::array<std::size_t, 4> kEach{1, 64, 8, 4};
  const auto roomy = [](double r) { return r > 4.0; };
  const auto count = static_cast<std::size_t>(std::count_if(room.begin(), room.end(), roomy));
  for (std::size_t a = 0; a < 3; ++a) axes[a].divide(roomy(room[a]) ? kEach[count] : 1);
}

double crowding_of(const BoxSample& sample, const std::array<SampledAxis, 3>& axes) noexcept {
  std::array<std::uint32_t, kCells> in_cell{};
  std::size_t cells = 1;
  for (const SampledAxis& axis : axes) cells *= axis.cells;
  for (std::size_t i = 0; i < sample.count; ++i) {
    std::size_t cell = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      cell = cell * axes[a].cells + axes[a].cell_of(sample.low[a][i]);
    }
    ++in_cell[cell];
  }
  double together = 0.0;
  for (const std::uint32_t n : in_cell) together += static_cast<double>(n) * (n - 1.0);
  const auto n = static_cast<double>(sample.count);
  const double likelihood = together / (n * (n - 1.0)) * static_cast<double>(cells);
  return std::max(1.0, likelihood);
}

}  // namespace

SceneFeatures sample_scene(const BoundsPool& pool, std::size_t live) noexcept {
  SceneFeatures features{.objects = live};
  BoxSample sample(pool, live);
  if (sample.count < 2) return features;
  std::array<SampledAxis, 3> axes;
  double pairs_of_one = 0.5 * static_cast<double>(live);
  for (std::size_t a = 0; a < 3; ++a) {
    axes[a].from = sample.quantile(sample.low[a], 0.02);
    axes[a].range = sample.quantile(sample.low[a], 0.98) - axes[a].from;
    const double edge = sample.mean_edge(a);
    features.room[a] = std::min(axes[a].range / std::max(edge, 1e-30), 1e12);
    // Two objects overlap on this axis if their lower bounds are less than an edge apart.
    pairs_of_one *= std::min(1.0, 2.0 / std::max(features.room[a], 1e-12));
  }
  const double small = std::max(sample.quantile(sample.longest, 0.05), 1e-30);
  const double large = std::min(sample.quantile(sample.longest, 0.95), kUnbounded);
  features.size_spread = std::clamp(rough_log2(large / small), 0.0, 64.0);
  divide(axes, features.room);
  const double likelier = crowding_of(sample, axes);
  features.crowding = rough_log2(likelier);
  features.pairs = std::min({pairs_of_one * likelier, kMaxPairs, 0.5 * static_cast<double>(live)});
  return features;
}

}  // namespace winnow
