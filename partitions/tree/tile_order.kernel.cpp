// Sorts rows into tiles by counting; kd_order.cpp calls it for sets of some thousand rows.

#include "partitions/tree/tile_order.kernel.h"
#include "partitions/tree/axis_extent.wide.h"
#include "partitions/tree/equal_parts.wide.h"
#include "simd/lanes/lanes.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);
constexpr std::uint32_t kMaxParts = 12;
constexpr std::uint32_t kMaxLines = kMaxParts * kMaxParts;

/// One axis of the points.
struct TileAxis {
  const float* x;
  AxisExtent reach;

  TileAxis(const float* points, std::size_t count)
      : x(points), reach(AxisExtent::of(points, count)) {}

  /// Writes the place of each point: one of kPlacesPerAxis equal steps of the axis.
  void find_places(std::size_t count, std::uint8_t* place) const {
    const float scale = places_per(reach.half());
    alignas(64) std::uint32_t whole[kLanes];
    for (std::size_t next = 0; next < count; next += kStep) {
      const std::size_t i = next + kStep <= count ? next : count - kStep;
      places_of(Floats::load_unaligned(x + i), 0.5F * reach.low, scale).store(whole);
      for (std::size_t k = 0; k < kStep; ++k) place[i + k] = static_cast<std::uint8_t>(whole[k]);
    }
  }
};

/// The number of parts of the middle and the shortest axis, so that lines are about as wide as
/// cubes of 16 points would be if the points were evenly spread.
struct TileCuts {
  std::uint32_t slow = 0;
  std::uint32_t mid = 0;

  TileCuts(const TileAxis& fast_axis, const TileAxis& mid_axis, const TileAxis& slow_axis,
           std::size_t count) {
    const float longest = fast_axis.reach.half();  // half lengths: only ratios count
    if (longest > kMinExtent) {
      const float m = mid_axis.reach.half() / longest;
      const float s = slow_axis.reach.half() / longest;
      const float tiles = static_cast<float>(count) / static_cast<float>(kLanes);
      // The loops compute rounded roots: `slow` is the cube root of tiles * s^2 / m, `mid` is the
      // square root of m times the tiles of a slab.
      const auto half = [](std::uint32_t n) { return static_cast<float>(n) + 0.5F; };
      while (slow < kMaxParts && half(slow) * half(slow) * half(slow) * m < tiles * s * s) ++slow;
      const float slabs = slow == 0 ? 1.0F : static_cast<float>(slow);
      while (mid < kMaxParts && half(mid) * half(mid) * slabs < tiles * m) ++mid;
    }
    slow = slow == 0 ? 1 : slow;
    mid = mid == 0 ? 1 : mid;
  }
};

class Tiles {
 public:
  explicit Tiles(const TileSet& set) : set_(set), count_(set.count) {
    for (std::size_t k = 0; k < 3; ++k) {
      place_[k] = reinterpret_cast<std::uint8_t*>(set.room[0]) + k * count_;
    }
    key_ = reinterpret_cast<std::uint16_t*>(set.room[1]);
  }

  bool sort() {
    const TileAxis axis[3] = {{set_.at[0], count_}, {set_.at[1], count_}, {set_.at[2], count_}};
    // The longest axis is the fast one.
    const float length[3] = {axis[0].reach.half(), axis[1].reach.half(), axis[2].reach.half()};
    int order[3];
    order_by_length(length, order);
    const TileCuts cuts(axis[order[0]], axis[order[1]], axis[order[2]], count_);
    // Only for the test of concentration: lines are sorted in steps, not cut into parts.
    constexpr std::uint32_t kPartsOfLine = 64;
    const std::uint32_t parts[3] = {kPartsOfLine, cuts.mid, cuts.slow};
    for (int k = 0; k < 3; ++k) {
      axis[order[k]].find_places(count_, place_[k]);
      if (parts[k] != 1 && is_concentrated(place_[k], parts[k])) return false;
    }
    find_lines(cuts);
    place_rows(cuts.slow * cuts.mid);
    return true;
  }

 private:
  /// One point in this many is sampled.
  [[nodiscard]] std::uint32_t step() const { return count_ < 512 ? 1 : 4; }

  /// Calls visit(index) for the sample. The offset within each group of four points varies, because
  /// with a fixed offset objects of alternating kinds would alias.
  template <typename Visit>
  void for_sample(const Visit& visit) const {
    const std::uint32_t rest = step() - 1;
    std::uint32_t turn = 0;
    for (std::size_t i = 0; i + rest < count_; i += rest + 1, turn += 0x9E3779B1U) {
      visit(i + (turn >> 30U & rest));
    }
  }

  /// True if too many points are at one place for tiles to separate them. One part of an axis may
  /// be twice as large as intended, since the other axes cut it further.
  [[nodiscard]] bool is_concentrated(const std::uint8_t* place, std::uint32_t parts) const {
    std::uint32_t points[kPlacesPerAxis] = {};
    for_sample([&](std::size_t i) { ++points[place[i]]; });
    return most_at_a_place(points) * step() > 2 * count_ / parts + kStep;
  }

  /// Odd lines run backwards, so that successive lines are neighbours.
  void find_lines(const TileCuts& cuts) {
    std::uint32_t points[kMaxParts + 1][kPlacesPerAxis];
    std::uint32_t* const slow_points = points[kMaxParts];
    for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) slow_points[p] = 0;
    std::uint32_t all = 0;
    for_sample([&](std::size_t i) {
      ++slow_points[place_[2][i]];
      ++all;
    });
    std::uint32_t slab[kPlacesPerAxis];
    cut_equally(slow_points, all, cuts.slow, slab);
    std::uint32_t in_slab[kMaxParts] = {};
    for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) in_slab[slab[p]] += slow_points[p];
    __builtin_memset(points, 0, cuts.slow * sizeof points[0]);
    for_sample([&](std::size_t i) { ++points[slab[place_[2][i]]][place_[1][i]]; });
    std::uint32_t part[kPlacesPerAxis];
    std::uint32_t line[kMaxParts][kPlacesPerAxis];
    for (std::uint32_t s = 0; s < cuts.slow; ++s) {
      cut_equally(points[s], in_slab[s], cuts.mid, part);
      for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) {
        line[s][p] = s * cuts.mid + ((s & 1U) != 0 ? cuts.mid - 1 - part[p] : part[p]);
      }
    }
    // At most one key per point, so that a line has 8 to 16 steps for each of its tiles of 16
    // points.
    while (step_bits_ > 2 && cuts.slow * cuts.mid << step_bits_ > count_) --step_bits_;
    const std::uint32_t last_step = (1U << step_bits_) - 1;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint32_t own = line[slab[place_[2][i]]][place_[1][i]];
      const std::uint32_t step = place_[0][i] >> (kPlaceBits - step_bits_);
      const std::uint32_t back = (0U - (own & 1U)) & last_step;
      key_[i] = static_cast<std::uint16_t>(own << step_bits_ | (step ^ back));
    }
  }

  void place_rows(std::uint32_t lines) {
    std::uint16_t next[kMaxLines * kPlacesPerAxis];
    const std::uint32_t keys = lines << step_bits_;
    __builtin_memset(next, 0, keys * sizeof next[0]);
    for (std::size_t i = 0; i < count_; ++i) ++next[key_[i]];
    std::uint32_t sum = 0;
    for (std::uint32_t k = 0; k < keys; ++k) {
      const std::uint32_t own = next[k];
      next[k] = static_cast<std::uint16_t>(sum);
      sum += own;
    }
    for (std::size_t i = 0; i < count_; ++i) set_.row_room[next[key_[i]]++] = set_.row[i];
    __builtin_memcpy(set_.row, set_.row_room, count_ * sizeof *set_.row);
  }

  const TileSet& set_;
  const std::size_t count_;
  std::uint8_t* place_[3];
  std::uint16_t* key_;
  std::uint32_t step_bits_ = kPlaceBits;
};

bool sort(const TileSet& set) {
  return Tiles(set).sort();
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const TileOrderKernels WINNOW_KERNEL_TABLE(tile_order_kernels) = {WINNOW_ISA_NAME::sort};

}  // namespace winnow
