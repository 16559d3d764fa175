#pragma once

#include <winnow/core/volumes.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace winnow {

/// Compares boxes by their longest edge. The work of a pair is charged to its smaller body: if that
/// body moves to another rank, a copy of the larger body is sent there, so the work moves along.
[[nodiscard]] inline bool is_larger(const Aabb& box, const Aabb& than) noexcept {
  const auto edge = [](const Aabb& of) {
    const Vec3f edges = of.max - of.min;
    return std::max({edges.x(), edges.y(), edges.z()});
  };
  return edge(box) > edge(than);
}

/// Distributes 16 * `work`, the work of a rank, over the bodies that belong to the rank, in
/// proportion to `counts`; a share is at least 1. These bodies also get the work that the rank's
/// copies of other bodies caused. `counts`, the result and `is_owned` are indexed by id; shares of
/// copies are to be ignored.
template <typename IsOwned>
[[nodiscard]] std::vector<std::uint32_t> shares_of(std::span<const std::uint64_t> counts,
                                                   IsOwned&& is_owned, std::uint64_t work) {
  constexpr std::uint64_t kScale = 16;
  constexpr std::uint64_t kMaxShare = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t sum = 0;
  for (std::size_t id = 0; id < counts.size(); ++id) sum += is_owned(id) ? counts[id] : 0;
  std::vector<std::uint32_t> shares(counts.size(), 1);
  if (sum == 0) return shares;
  const double scale = static_cast<double>(kScale * work) / static_cast<double>(sum);
  for (std::size_t id = 0; id < counts.size(); ++id) {
    const auto scaled = static_cast<std::uint64_t>(static_cast<double>(counts[id]) * scale);
    shares[id] = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(scaled, 1, kMaxShare));
  }
  return shares;
}

}  // namespace winnow
