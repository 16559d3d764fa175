#pragma once

#include <winnow/core/column.h>
#include <winnow/core/pose.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// A point that has no feature match may have moved by at most this share of the smaller body's
/// radius, measured on the body on which it moved less, to match a point of the last frame.
inline constexpr double kSamePointFraction = 0.02;

/// If a pair has more unmatched points of the last frame than this, its points are matched by
/// feature only: matching by position is quadratic.
inline constexpr std::uint32_t kMaxUnmatched = 256;

/// Maps the pairs and points of a ContactFrame to their indices in the frame before, for warm
/// starts. Empty without SceneOptions::warm_start.
struct ContactHistory {
  explicit ContactHistory(std::pmr::memory_resource* memory) noexcept
      : pair(memory), point(memory), taken(memory), pose(memory) {}

  /// Index in the frame before, by pair and by point, or kNoContact.
  Column<std::uint32_t> pair;
  Column<std::uint32_t> point;
  /// By point of the frame before: 1 if a point of this frame matched it.
  Column<std::uint8_t> taken;
  /// Pose at the last `collide`, by body id.
  Column<Pose> pose;
  /// The last call kept the whole frame: every pair and point maps to itself.
  bool is_same = false;

  void clear() noexcept;
  /// Reserves for Scene::reserve_contacts.
  [[nodiscard]] bool reserve(std::size_t pairs, std::size_t points, std::size_t bodies,
                             Pages pages) noexcept;
};

}  // namespace winnow
