#pragma once

#include <winnow/core/export.h>

#include <limits>

namespace winnow {

/// Amount by which a partition enlarges its stored volumes on every side (a fat AABB): `distance` +
/// `share` * the longest finite edge of the object's box. While an object moves by less than its
/// margin, its stored volume does not change and costs no update. In return, pairs are reported
/// whose given volumes are apart by up to the sum of their margins. `distance` corresponds to the
/// margins of PhysX and Bullet, `share` to the margin of Box2D. Negative values and NaN count as 0.
struct FatMargin {
  float distance = 0.0F;  ///< in units of length
  float share = 0.0F;     ///< 0.05 is a twentieth of the longest edge

  /// Returns true if volumes are stored as given.
  [[nodiscard]] bool is_none() const noexcept { return !(distance > 0.0F) && !(share > 0.0F); }

  /// Returns the margin with each member replaced by a finite value that is not negative.
  [[nodiscard]] FatMargin legal() const noexcept {
    constexpr float most = std::numeric_limits<float>::max();
    const auto at_most = [](float value) { return value < most ? value : most; };
    return {distance > 0.0F ? at_most(distance) : 0.0F, share > 0.0F ? at_most(share) : 0.0F};
  }

  /// Returns the margin of an object whose longest finite edge is `edge`; may be infinite. Requires
  /// a margin returned by `legal`.
  [[nodiscard]] float of(float edge) const noexcept { return distance + share * edge; }
};

}  // namespace winnow
