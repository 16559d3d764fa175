// The geometry of loose octrees: places the root, and computes sort keys, codes and bounds of
// cells. loose_octree.cpp calls it.

#include "partitions/structures/octree/loose_octree_cells.h"

#include "partitions/structures/octree/hilbert_curve.h"
#include "partitions/structures/roots.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

constexpr double kObjectsInCell = 16;  // on average, on the finest level
constexpr double kThinWorld = 2;       // an axis with at most this many cells is not divided
constexpr unsigned kLevelShift = 28;   // in keys and codes
constexpr std::uint32_t kCodeMask = (1U << kLevelShift) - 1U;

/// Returns the edge of cubic cells if `objects` of them fill the ranges. Ignores axes whose range
/// is within one such cell.
double edge_of_cells(std::array<double, 3> range, std::size_t axes, double cells) {
  for (;; --axes) {
    std::array<double, 4> factor{1.0 / cells};
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

/// Bits of a place per axis, for three and for two divided axes.
constexpr unsigned kBits3 = 9;
constexpr unsigned kBits2 = 14;

/// Spreads groups of `Levels` bits so that the groups of N numbers interleave: three numbers of up
/// to 10 bits in groups of two, or two numbers of up to 16 bits in groups of four.
template <unsigned N, unsigned Levels>
constexpr std::uint32_t spread(std::uint32_t x) noexcept {
  static_assert((N == 3 && Levels == 2) || (N == 2 && Levels == 4));
  if constexpr (N == 3) {
    x = (x | x << 16U) & 0x030000FFU;
    x = (x | x << 8U) & 0x0300F00FU;
    return (x | x << 4U) & 0x030C30C3U;
  }
  x = (x | x << 8U) & 0x00FF00FFU;
  return (x | x << 4U) & 0x0F0F0F0FU;
}

/// The Hilbert curve through places of `Bits` bits on each of N axes, computed `Levels` levels at a
/// time.
template <unsigned N, unsigned Levels, unsigned Bits>
struct Curve {
  using Steps = HilbertSteps<N, Levels>;
  static constexpr unsigned kSteps = (Bits + Levels - 1) / Levels;
  // Bits below the last level: a place within the finest cell, which does not affect higher bits.
  static constexpr unsigned kBelow = kSteps * Levels - Bits;

  /// Interleaved bits that a place on an axis contributes to the cells of all steps.
  static constexpr std::uint32_t cells_of(std::uint32_t place, unsigned axis) noexcept {
    return spread<N, Levels>(place << kBelow) << (Levels * axis);
  }
  /// Returns the place on the curve of the interleaved cells.
  static std::uint32_t place_of(std::uint32_t cells) noexcept {
    static constexpr Steps kCurve;
    std::uint64_t code = 0;
    unsigned state = 0;
    for (unsigned s = kSteps; s-- > 0;) {
      const unsigned cell = cells >> (Steps::kBits * s) & Steps::kPlaceMask;
      const unsigned step = kCurve.step[state << Steps::kBits | cell];
      code = code << Steps::kBits | (step & Steps::kPlaceMask);
      state = step >> Steps::kBits;
    }
    return static_cast<std::uint32_t>(code >> (N * kBelow));
  }
};
using Curve3 = Curve<3, 2, kBits3>;
using Curve2 = Curve<2, 4, kBits2>;

template <unsigned N>
std::uint32_t morton_code(std::uint32_t place, unsigned levels) noexcept {
  static constexpr HilbertCurve<N> kCurve;
  return kCurve.morton_code(place, levels);
}

}  // namespace

bool LooseOctreeCells::choose(const SceneSample& sample, std::size_t axes, float loose) noexcept {
  if (sample.objects < kMinInCells || sample.count < 8) return false;
  const double cells = static_cast<double>(sample.objects) / kObjectsInCell;
  std::array<double, 3> range{};
  for (std::size_t a = 0; a < 3; ++a) range[a] = sample.range(a) + sample.mean_edge[a];
  // The axis that is not divided; 3 if all are.
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
  // Ensures that every place has a finite scale.
  if (!(edge > longest * 1e-9) || !(longest > 1e-30) || !(longest < 1e30)) return false;
  finest_ = 0;
  double doubled = edge;
  for (; finest_ < bits_ && doubled < longest; ++finest_) doubled *= 2.0;
  edge_ = std::max(longest, doubled);
  // A box reaches from its centre by half of its edge.
  double limit = 2.0 * reach_ * edge_;
  for (std::uint32_t level = 0; level <= finest_; ++level, limit *= 0.5) longest_[level] = limit;
  scale_ = static_cast<double>(1U << bits_) / edge_;
  for (std::size_t k = 0; k < axes_; ++k) {
    origin_[k] = static_cast<double>(sample.low[axis_[k]]) - 0.5 * (edge_ - range[k]);
  }
  return true;
}

std::uint32_t LooseOctreeCells::level_of(float longest) const noexcept {
  // Most objects are on the finest level.
  for (std::uint32_t level = finest_ + 1; level-- > 0;) {
    if (static_cast<double>(longest) <= longest_[level]) return level;
  }
  return kNone;
}

// Processes several rows per step so that compilers vectorize each step.
template <typename Curve>
void LooseOctreeCells::find_some_keys(const BoxColumns& box, std::size_t first, std::size_t count,
                                      std::uint32_t* key) const noexcept {
  std::array<float, kTogether> longest;
  std::array<double, kTogether> at;
  std::array<double, kTogether> inside;
  std::array<std::uint32_t, kTogether> cells;
  longest.fill(0.0F);
  inside.fill(1.0);
  cells.fill(0);
  const double places = static_cast<double>(1U << bits_);
  const double last = places - 1.0;
  const double scale = scale_;
  for (unsigned k = 0; k < Curve::Steps::kAxes; ++k) {
    const float* const low = box[axis_[k]] + first;
    const float* const high = box[3 + axis_[k]] + first;
    const double origin = origin_[k];
    for (std::size_t i = 0; i < count; ++i) {
      longest[i] = std::max(longest[i], high[i] - low[i]);
      const float centre = 0.5F * low[i] + 0.5F * high[i];
      at[i] = (static_cast<double>(centre) - origin) * scale;
    }
    for (std::size_t i = 0; i < count; ++i) {
      inside[i] = at[i] >= 0.0 && at[i] < places ? inside[i] : 0.0;
      // The comparison turns NaN into 0.
      const double from = at[i] > 0.0 ? at[i] : 0.0;
      const double to = from < last ? from : last;
      cells[i] |= Curve::cells_of(static_cast<std::uint32_t>(static_cast<std::int32_t>(to)), k);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t level = level_of(longest[i]);
    const bool none = level == kNone || inside[i] == 0.0;
    key[i] = none ? kNone : level << kLevelShift | Curve::place_of(cells[i]);
  }
}

void LooseOctreeCells::find_keys(const BoundsPool& pool, std::size_t begin, std::size_t end,
                                 std::uint32_t* key) const noexcept {
  const BoxColumns box = box_columns(pool);
  for (std::size_t first = begin; first < end; first += kTogether) {
    const std::size_t count = std::min(kTogether, end - first);
    if (axes_ == 3) {
      find_some_keys<Curve3>(box, first, count, key + (first - begin));
    } else {
      find_some_keys<Curve2>(box, first, count, key + (first - begin));
    }
  }
}

unsigned LooseOctreeCells::bits_within_cell(std::uint32_t key) const noexcept {
  return static_cast<unsigned>(axes_) * (bits_ - (key >> kLevelShift));
}

std::uint32_t LooseOctreeCells::code_of(std::uint32_t key) const noexcept {
  const std::uint32_t level = key >> kLevelShift;
  const std::uint32_t place = (key & kCodeMask) >> bits_within_cell(key);
  return level << kLevelShift |
         (axes_ == 3 ? morton_code<3>(place, level) : morton_code<2>(place, level));
}

LooseOctreeCells::CellBounds LooseOctreeCells::bounds_of(std::uint32_t code,
                                                         double reach) const noexcept {
  const std::uint32_t level = code >> kLevelShift;
  const double edge = std::ldexp(edge_, -static_cast<int>(level));
  CellBounds bounds{};
  for (std::size_t k = 0; k < axes_; ++k) {
    std::uint32_t cell = 0;
    for (std::uint32_t bit = 0; bit < level; ++bit) cell |= (code >> (bit * axes_ + k) & 1U) << bit;
    const double low = origin_[k] + cell * edge;
    bounds.low[k] = static_cast<float>(low - reach * edge);
    bounds.high[k] = static_cast<float>(low + edge + reach * edge);
  }
  return bounds;
}

bool LooseOctreeCells::contains_rows(const CellBounds& bounds, const BoundsPool& pool,
                                     std::size_t begin, std::size_t end) const noexcept {
  unsigned outside = 0;
  for (std::size_t k = 0; k < axes_; ++k) {
    const float* const low = pool.column(axis_[k]);
    const float* const high = pool.column(3 + axis_[k]);
    const float from = bounds.low[k];
    const float to = bounds.high[k];
    // Without a branch, so that compilers vectorize the loop.
    for (std::size_t row = begin; row < end; ++row) {
      outside |= static_cast<unsigned>(low[row] < from) | static_cast<unsigned>(high[row] > to);
    }
  }
  return outside == 0;
}

bool LooseOctreeCells::contains_box(const CellBounds& bounds,
                                    const Structure::ObjectBox& box) const noexcept {
  for (std::size_t k = 0; k < axes_; ++k) {
    const std::size_t a = axis_[k];
    if (box.low[a] < bounds.low[k] || box.high[a] > bounds.high[k]) return false;
  }
  return true;
}

}  // namespace winnow
