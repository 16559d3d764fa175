#pragma once

#include <winnow/core/export.h>

#include <limits>

namespace winnow {

/// By how much a partition stores volumes larger than they are given, on every side: `distance` +
/// `share` * the longest finite edge of the object's box. While an object moves by less than that
/// the stored volume need not change, and what does not change costs nothing; the price is pairs
/// whose given volumes miss each other by up to the sum of their margins. PhysX and Bullet users
/// know the distance, Box2D users the share. Negative or NaN counts as 0.
struct Margin {
  float distance = 0.0F;  ///< in units of the scene
  float share = 0.0F;     ///< 0.05: a twentieth of the longest edge

  /// True if volumes are stored as they are given.
  [[nodiscard]] bool is_none() const noexcept { return !(distance > 0.0F) && !(share > 0.0F); }

  /// The same with members that are finite and not negative.
  [[nodiscard]] Margin legal() const noexcept {
    constexpr float most = std::numeric_limits<float>::max();
    const auto at_most = [](float value) { return value < most ? value : most; };
    return {distance > 0.0F ? at_most(distance) : 0.0F, share > 0.0F ? at_most(share) : 0.0F};
  }

  /// Of a legal margin: for an object whose longest finite edge is `edge`; may be infinite.
  [[nodiscard]] float of(float edge) const noexcept { return distance + share * edge; }
};

}  // namespace winnow
