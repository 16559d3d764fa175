#include "partitions/structures/octree/loose_octree_cells.h"

#include "partitions/structures/octree/hilbert_curve.h"
#include "partitions/structures/roots.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

constexpr double kObjectsInCell = 16;  // on average, on the finest level
constexpr double kThinWorld = 2;       // an axis of so few of its cells is not worth dividing
constexpr unsigned kLevelShift = 28;   // in keys and codes
constexpr std::uint32_t kCodeMask = (1U << kLevelShift) - 1U;

/// The edge of cells that hold `objects` on average. Axes on which all lies within one such cell
/// count for nothing.
double edge_of_cells(std::array<double, 3> range, std::size_t axes, double objects) {
  for (;; --axes) {
    std::array<double, 4> factor{1.0 / objects};
    std::size_t least = 0;
    for (std::size_t k = 0; k < axes; ++k) {
      factor[k + 1] = range[k];
      if (range[k] < range[least]) least = k;
    }
    const double edge =
        root_of_product(static_cast<unsigned>(axes), std::span(factor).first(axes + 1));
    if (axes == 1 || edge <= range[least]) return edge;
    range[least] = range[axes - 1];
  }
}

/// Bits of a place by axis, of cubes and of squares.
constexpr unsigned kBits3 = 9;
constexpr unsigned kBits2 = 14;

/// Where a place of `Bits` bits on each of N axes comes along Hilbert's curve, found `Levels`
/// levels at a time.
template <unsigned N, unsigned Levels, unsigned Bits>
std::uint32_t along_curve(const std::array<std::uint32_t, 3>& place) noexcept {
  using Steps = HilbertSteps<N, Levels>;
  static constexpr Steps kCurve;
  constexpr unsigned kSteps = (Bits + Levels - 1) / Levels;
  // Bits below the last: a place within the finest cell, which changes nothing above.
  constexpr unsigned kBelow = kSteps * Levels - Bits;
  std::uint64_t code = 0;
  unsigned state = 0;
  for (unsigned bit = kSteps * Levels; bit != 0;) {
    bit -= Levels;
    unsigned cell = 0;
    for (unsigned a = 0; a < N; ++a) {
      cell |= ((place[a] << kBelow) >> bit & Steps::kAxisMask) << (Levels * a);
    }
    const unsigned step = kCurve.step[state << Steps::kBits | cell];
    code = code << Steps::kBits | (step & Steps::kPlaceMask);
    state = step >> Steps::kBits;
  }
  return static_cast<std::uint32_t>(code >> (N * kBelow));
}

}  // namespace

bool LooseOctreeCells::choose(const SceneSample& sample, std::size_t axes, float loose) noexcept {
  if (sample.objects < kFewestInCells || sample.count < 8) return false;
  const double cells = static_cast<double>(sample.objects) / kObjectsInCell;
  std::array<double, 3> range{};
  for (std::size_t a = 0; a < 3; ++a) range[a] = sample.range(a) + sample.mean_edge[a];
  // The axis that is not divided, if there is one.
  std::size_t whole = 3;
  const auto least = [](auto&& measure) {
    std::size_t best = 0;
    for (std::size_t a = 1; a < 3; ++a) {
      if (measure(a) < measure(best)) best = a;
    }
    return best;
  };
  if (axes == 2) {
    whole = least([&](std::size_t a) { return sample.range(a) / (sample.mean_edge[a] + 1e-30); });
  } else {
    const std::size_t thin = least([&](std::size_t a) { return range[a]; });
    if (range[thin] <= kThinWorld * edge_of_cells(range, 3, cells)) whole = thin;
  }
  axes_ = 0;
  double longest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == whole) continue;
    longest = std::max(longest, range[a]);
    range[axes_] = range[a];
    axis_[axes_++] = static_cast<std::uint32_t>(a);
  }
  bits_ = axes_ == 3 ? kBits3 : kBits2;
  reach_ = 0.5 * (static_cast<double>(loose) - 1.0);
  const double edge = edge_of_cells(range, axes_, cells);
  // So that every place has a finite scale, whatever the axis.
  if (!(edge > longest * 1e-9) || !(longest > 1e-30) || !(longest < 1e30)) return false;
  finest_ = 0;
  double doubled = edge;
  for (; finest_ < bits_ && doubled < longest; ++finest_) doubled *= 2.0;
  edge_ = std::max(longest, doubled);
  scale_ = static_cast<double>(1U << bits_) / edge_;
  for (std::size_t k = 0; k < axes_; ++k) {
    origin_[k] = static_cast<double>(sample.low[axis_[k]]) - 0.5 * (edge_ - range[k]);
  }
  return true;
}

std::uint32_t LooseOctreeCells::level_of(const BoundsPool& pool, std::size_t row) const noexcept {
  float longest = 0.0F;
  for (std::size_t k = 0; k < axes_; ++k) {
    const std::size_t a = axis_[k];
    longest = std::max(longest, pool.column(3 + a)[row] - pool.column(a)[row]);
  }
  // A box by its centre reaches out by half of its edge.
  double edge = 2.0 * reach_ * edge_;
  if (!(static_cast<double>(longest) <= edge)) return kNone;
  std::uint32_t level = 0;
  while (level < finest_ && static_cast<double>(longest) <= (edge *= 0.5)) ++level;
  return level;
}

bool LooseOctreeCells::find_place(const BoundsPool& pool, std::size_t row,
                                  std::array<std::uint32_t, 3>& place) const noexcept {
  const double places = static_cast<double>(1U << bits_);
  for (std::size_t k = 0; k < axes_; ++k) {
    const std::size_t a = axis_[k];
    const float centre = 0.5F * pool.column(a)[row] + 0.5F * pool.column(3 + a)[row];
    const double at = (static_cast<double>(centre) - origin_[k]) * scale_;
    if (!(at >= 0.0 && at < places)) return false;
    place[k] = static_cast<std::uint32_t>(at);
  }
  return true;
}

std::uint32_t LooseOctreeCells::key_of(const BoundsPool& pool, std::size_t row) const noexcept {
  std::array<std::uint32_t, 3> place{};
  const std::uint32_t level = level_of(pool, row);
  if (level == kNone || !find_place(pool, row, place)) return kNone;
  const std::uint32_t code =
      axes_ == 3 ? along_curve<3, 2, kBits3>(place) : along_curve<2, 4, kBits2>(place);
  return level << kLevelShift | code;
}

std::uint32_t LooseOctreeCells::cell_of_key(std::uint32_t key) const noexcept {
  const std::uint32_t level = key >> kLevelShift;
  const unsigned within = static_cast<unsigned>(axes_) * (bits_ - level);
  return level << kLevelShift | (key & kCodeMask) >> within;
}

std::uint32_t LooseOctreeCells::code_of(const BoundsPool& pool, std::size_t row,
                                        std::uint32_t key) const noexcept {
  const std::uint32_t level = key >> kLevelShift;
  std::array<std::uint32_t, 3> place{};
  (void)find_place(pool, row, place);
  std::uint32_t code = 0;
  for (unsigned bit = bits_; bit-- > bits_ - level;) {
    for (std::size_t k = axes_; k-- > 0;) code = code << 1U | (place[k] >> bit & 1U);
  }
  return level << kLevelShift | code;
}

LooseOctreeCells::Bounds LooseOctreeCells::bounds_of(std::uint32_t code,
                                                     double reach) const noexcept {
  const std::uint32_t level = code >> kLevelShift;
  const double edge = std::ldexp(edge_, -static_cast<int>(level));
  Bounds bounds{};
  for (std::size_t k = 0; k < axes_; ++k) {
    std::uint32_t cell = 0;
    for (std::uint32_t bit = 0; bit < level; ++bit) cell |= (code >> (bit * axes_ + k) & 1U) << bit;
    const double low = origin_[k] + cell * edge;
    bounds.low[k] = static_cast<float>(low - reach * edge);
    bounds.high[k] = static_cast<float>(low + edge + reach * edge);
  }
  return bounds;
}

bool LooseOctreeCells::hold(const Bounds& bounds, const BoundsPool& pool, std::size_t begin,
                            std::size_t end) const noexcept {
  unsigned outside = 0;
  for (std::size_t k = 0; k < axes_; ++k) {
    const float* const low = pool.column(axis_[k]);
    const float* const high = pool.column(3 + axis_[k]);
    const float from = bounds.low[k];
    const float to = bounds.high[k];
    // No branch: compilers test several rows at once.
    for (std::size_t row = begin; row < end; ++row) {
      outside |= static_cast<unsigned>(low[row] < from) | static_cast<unsigned>(high[row] > to);
    }
  }
  return outside == 0;
}

bool LooseOctreeCells::holds(const Bounds& bounds, const Structure::Place& box) const noexcept {
  for (std::size_t k = 0; k < axes_; ++k) {
    const std::size_t a = axis_[k];
    if (box.low[a] < bounds.low[k] || box.high[a] > bounds.high[k]) return false;
  }
  return true;
}

}  // namespace winnow
