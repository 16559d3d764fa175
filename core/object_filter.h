#pragma once

#include <winnow/core/export.h>

#include <cstdint>

namespace winnow {

/// Environment of objects that can form pairs with objects of every environment.
inline constexpr std::uint32_t kAllEnvironments = 0xFFFFFFFFU;

/// Restricts which objects form a pair. Two objects pair only if their environments are equal (or
/// one is `kAllEnvironments`), and each one's mask contains a layer of the other.
struct ObjectFilter {
  std::uint32_t layers = 1;       ///< layers that the object is in, one bit each
  std::uint32_t mask = ~0U;       ///< layers of objects that it accepts
  std::uint32_t environment = 0;  ///< objects of different environments do not pair

  /// True if layers, masks and environments are equal.
  friend constexpr bool operator==(const ObjectFilter&, const ObjectFilter&) noexcept = default;
};

}  // namespace winnow
