#pragma once

#include <winnow/core/column.h>
#include <winnow/core/pose.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// How far a point without a feature of its own may have moved, on the body on which it moved less,
/// to be taken for one of the last frame: this share of the smaller body's radius.
inline constexpr double kSamePlaceShare = 0.02;

/// Of a pair that left more points of the last frame over than this, points are known by their
/// features alone.
inline constexpr std::uint32_t kMostLeftOver = 256;

/// Where the pairs and points of a ContactFrame were in the one before. Empty where nobody asked.
struct ContactHistory {
  explicit ContactHistory(std::pmr::memory_resource* memory) noexcept
      : pair(memory), point(memory), taken(memory), pose(memory) {}

  /// By pair and by point: the place in the frame before, or kNoContact.
  Column<std::uint32_t> pair;
  Column<std::uint32_t> point;
  /// By point of the frame before: a point of this one was it.
  Column<std::uint8_t> taken;
  /// By id of a body: where it stood.
  Column<Pose> pose;
  /// Everything is where it was.
  bool is_same = false;

  void clear() noexcept;
  /// Room for what Scene::reserve_contacts promises.
  [[nodiscard]] bool reserve(std::size_t pairs, std::size_t points, std::size_t bodies,
                             Pages pages) noexcept;
};

}  // namespace winnow
