#pragma once

#include <winnow/pipeline/narrow_phase.h>

#include <cstdint>
#include <span>

namespace winnow {

/// Writable columns of a NarrowResult; see its accessors of the same names. Columns of higher
/// levels are empty.
struct NarrowColumns {
  std::span<std::uint8_t> overlap;         ///< one per answer, only at level boolean
  std::span<double> distance;              ///< one per answer
  std::span<double> error_bound;           ///< one per answer
  std::span<double> normal[3];             ///< x, y, z
  std::span<double> point[3];              ///< x, y, z
  std::span<std::uint32_t> contact_first;  ///< index into `contacts`
  std::span<std::uint32_t> contact_count;  ///< at most kManifoldPoints
  /// Points may be added.
  ContactColumns& contacts;

  /// Returns the columns of a result. Written values must agree with what its accessors guarantee.
  [[nodiscard]] static NarrowColumns of(NarrowResult& result) noexcept;
  /// Allocates the columns of a level, and no others. False if memory is refused.
  [[nodiscard]] static bool resize(NarrowResult& result, std::size_t count,
                                   ContactLevel level) noexcept;
  static void clear(NarrowResult& result) noexcept;
};

}  // namespace winnow
