#include "partitions/queries/sweep.h"

#include <winnow/core/rounding.h>

#include <bit>
#include <cstdint>
#include <limits>

namespace winnow {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Slower than this beside the fastest axis, and the reciprocal is no normal float.
constexpr double kSlowest = 0x1p-120;

}  // namespace

void make_sweep(Sweep& s, const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                double max_t) noexcept {
  s.touch = nullptr;
  s.shape = nullptr;
  s.min_t = min_t;
  s.max_t = max_t;
  const Eigen::Vector3d speed = direction.cwiseAbs();
  const int faster = speed.x() >= speed.y() ? 0 : 1;
  const int fastest = speed[faster] >= speed.z() ? faster : 2;
  // The power of two above the fastest: its exponent bits plus one.
  const auto exponent = std::bit_cast<std::uint64_t>(speed[fastest]) >> 52U;
  s.scale = std::bit_cast<double>((exponent + 1) << 52U);
  s.from = round_down(min_t * s.scale);
  for (int axis = 0; axis < 3; ++axis) {
    const double d = direction[axis];
    const auto a = static_cast<std::uint8_t>(axis);
    const auto low = static_cast<std::uint8_t>(axis);
    const auto high = static_cast<std::uint8_t>(axis + 3);
    s.near_column[a] = d < 0.0 ? high : low;
    s.far_column[a] = d < 0.0 ? low : high;
    s.near_origin[a] = d < 0.0 ? box.min[axis] : box.max[axis];
    s.far_origin[a] = d < 0.0 ? box.max[axis] : box.min[axis];
    s.exact_near_column[a] = s.near_column[a];
    s.exact_near_origin[a] = static_cast<double>(s.near_origin[a]);
    s.exact_far_origin[a] = static_cast<double>(s.far_origin[a]);
    s.exact_inverse[a] = 1.0 / d;
    s.inverse[a] = static_cast<float>(s.exact_inverse[a] * s.scale);
    if (d == 0.0) {
      s.exact_inverse[a] = std::numeric_limits<double>::infinity();
      // What reaches beyond the range of float has infinite ends, which have no float beyond.
      if (s.near_origin[a] < kInfinity) s.near_origin[a] = next_up(s.near_origin[a]);
      if (s.far_origin[a] > -kInfinity) s.far_origin[a] = -next_up(-s.far_origin[a]);
      s.inverse[a] = kInfinity;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double part = speed[axis] / s.scale;
    if (part == 0.0 || part >= kSlowest) continue;
    s.near_column[axis] = s.near_column[fastest];
    s.far_column[axis] = s.far_column[fastest];
    s.near_origin[axis] = s.near_origin[fastest];
    s.far_origin[axis] = s.far_origin[fastest];
    s.inverse[axis] = s.inverse[fastest];
  }
}

}  // namespace winnow
