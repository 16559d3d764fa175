#include "partitions/queries/prepared_cast.h"

#include <winnow/core/rounding.h>

#include <bit>
#include <cstdint>
#include <limits>

namespace winnow {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Below this speed, relative to the fastest axis, the reciprocal is not a normal float.
constexpr double kSlowest = 0x1p-120;

}  // namespace

void prepare_cast(KernelCast& s, const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                  double max_t) noexcept {
  s.touch = nullptr;
  s.shape = nullptr;
  s.min_t = min_t;
  s.max_t = max_t;
  const Eigen::Vector3d speed = direction.cwiseAbs();
  const double most = speed.maxCoeff();
  // The next power of two above `most`: its exponent bits plus one.
  const auto exponent = std::bit_cast<std::uint64_t>(most) >> 52U;
  s.scale = std::bit_cast<double>((exponent + 1) << 52U);
  s.from = round_down(min_t * s.scale);
  for (int axis = 0; axis < 3; ++axis) {
    const double d = direction[axis];
    const auto a = static_cast<std::uint8_t>(axis);
    // Branchless: the direction is unpredictable.
    const auto back = static_cast<unsigned>(d < 0.0);
    const float end[2] = {box.max[axis], box.min[axis]};
    s.near_column[a] = static_cast<std::uint8_t>(a + 3 * back);
    s.far_column[a] = static_cast<std::uint8_t>(a + 3 - 3 * back);
    s.near_origin[a] = end[back];
    s.far_origin[a] = end[1 - back];
    s.exact_near_column[a] = s.near_column[a];
    s.exact_near_origin[a] = static_cast<double>(s.near_origin[a]);
    s.exact_far_origin[a] = static_cast<double>(s.far_origin[a]);
    s.exact_inverse[a] = 1.0 / d;
    s.inverse[a] = static_cast<float>(s.exact_inverse[a] * s.scale);
    if (d == 0.0) {
      s.exact_inverse[a] = std::numeric_limits<double>::infinity();
      // Boxes beyond the range of float have infinite ends, which have no next float.
      if (s.near_origin[a] < kInfinity) s.near_origin[a] = next_up(s.near_origin[a]);
      if (s.far_origin[a] > -kInfinity) s.far_origin[a] = -next_up(-s.far_origin[a]);
      s.inverse[a] = kInfinity;
    }
  }
  const double slow = kSlowest * s.scale;
  if (speed.minCoeff() >= slow) return;
  const int fastest = speed.x() == most ? 0 : speed.y() == most ? 1 : 2;
  for (int axis = 0; axis < 3; ++axis) {
    if (speed[axis] == 0.0 || speed[axis] >= slow) continue;
    s.near_column[axis] = s.near_column[fastest];
    s.far_column[axis] = s.far_column[fastest];
    s.near_origin[axis] = s.near_origin[fastest];
    s.far_origin[axis] = s.far_origin[fastest];
    s.inverse[axis] = s.inverse[fastest];
  }
}

}  // namespace winnow
