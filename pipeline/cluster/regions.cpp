#include "pipeline/cluster/regions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr std::uint32_t rank_at(std::int32_t side) noexcept {
  return static_cast<std::uint32_t>(~side);
}

}  // namespace

Regions::Regions(std::span<const SplitPlane> cuts) : cuts_(cuts.begin(), cuts.end()) {
  const Aabb all{Vec3f::constant(-kInfinity), Vec3f::constant(kInfinity)};
  boxes_.resize(cuts.size() + 1);
  set_boxes(root(), all);
}

void Regions::set_boxes(std::int32_t side, const Aabb& box) {
  if (side < 0) {
    boxes_[rank_at(side)] = box;
    return;
  }
  const SplitPlane& cut = cuts_[static_cast<std::size_t>(side)];
  const int axis = static_cast<int>(cut.axis);
  Aabb part = box;
  part.max[axis] = std::min(box.max[axis], std::nextafter(cut.at, -kInfinity));
  set_boxes(cut.sides[0], part);
  part = box;
  part.min[axis] = std::max(box.min[axis], cut.at);
  set_boxes(cut.sides[1], part);
}

std::uint32_t Regions::owner(const Vec3f& point) const noexcept {
  std::int32_t side = root();
  while (side >= 0) {
    const SplitPlane& cut = cuts_[static_cast<std::size_t>(side)];
    side = cut.sides[point[static_cast<int>(cut.axis)] < cut.at ? 0 : 1];
  }
  return rank_at(side);
}

void Regions::ranks_of(const Aabb& box, std::vector<std::uint32_t>& ranks) const {
  ranks.clear();
  if (!(box.min.x() <= box.max.x())) return;
  add_ranks(root(), box, ranks);
  std::sort(ranks.begin(), ranks.end());
}

void Regions::add_ranks(std::int32_t side, const Aabb& box,
                        std::vector<std::uint32_t>& ranks) const {
  while (side >= 0) {
    const SplitPlane& cut = cuts_[static_cast<std::size_t>(side)];
    const int axis = static_cast<int>(cut.axis);
    const bool below = box.min[axis] < cut.at;
    const bool above = !(box.max[axis] < cut.at);
    if (below && above) add_ranks(cut.sides[0], box, ranks);
    side = cut.sides[above ? 1 : 0];
  }
  ranks.push_back(rank_at(side));
}

void Regions::ranks_of(const ShapeRay& ray, std::vector<std::uint32_t>& ranks) const {
  ranks.clear();
  add_ranks(root(), ray, 0.0, ray.max_t, ranks);
  std::sort(ranks.begin(), ranks.end());
}

/// Each side gets the part of the ray that reaches it, enlarged by `slack`. The comparisons are
/// written so that NaN, which infinities cause, counts as intersecting.
void Regions::add_ranks(std::int32_t side, const ShapeRay& ray, double low, double high,
                        std::vector<std::uint32_t>& ranks) const {
  constexpr double kSlack = 1e-9;
  while (side >= 0) {
    const SplitPlane& cut = cuts_[static_cast<std::size_t>(side)];
    const double at = static_cast<double>(cut.at);
    const double origin = ray.origin[cut.axis];
    const double direction = ray.direction[cut.axis];
    const double near = kSlack * (std::abs(at) + std::abs(origin));
    if (direction == 0.0) {
      const bool below = origin < at + near;
      const bool above = origin > at - near;
      if (below && above) add_ranks(cut.sides[0], ray, low, high, ranks);
      side = cut.sides[above ? 1 : 0];
      continue;
    }
    const double crossing = (at - origin) / direction;
    const double slack = near / std::abs(direction);
    const std::size_t first = direction > 0.0 ? 0 : 1;
    const bool reaches_first = !(crossing + slack < low);
    const bool reaches_second = !(crossing - slack > high);
    if (reaches_first && reaches_second) {
      add_ranks(cut.sides[first], ray, low, std::min(high, crossing + slack), ranks);
    }
    if (reaches_second) low = std::max(low, crossing - slack);
    side = cut.sides[reaches_second ? 1 - first : first];
  }
  ranks.push_back(rank_at(side));
}

}  // namespace winnow
