#pragma once

#include <winnow/core/export.h>

#include <cstdint>

namespace winnow {

/// An environment that meets every other.
inline constexpr std::uint32_t kEveryEnvironment = 0xFFFFFFFFU;

/// What an object lets itself be paired with. Two objects pair only if their environments are equal
/// (or one is `kEveryEnvironment`), and each one's mask has a layer of the other.
struct ObjectFilter {
  std::uint32_t layers = 1;       ///< layers that the object is in, a bit each
  std::uint32_t mask = ~0U;       ///< layers that it wants to meet
  std::uint32_t environment = 0;  ///< objects of different environments never meet

  /// The same layers, mask and environment.
  friend constexpr bool operator==(const ObjectFilter&, const ObjectFilter&) noexcept = default;
};

}  // namespace winnow
