#pragma once

#include "engine/sample.h"

#include <winnow/core/aabb.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// Boxes of one width, tested in groups of 256 rows that lie together in space: each row against
/// every group whose box it meets.
struct BoxWidth {
  std::string boxes;
  std::size_t lanes = 0;        ///< tested at once
  std::size_t hits = 0;         ///< of the tests
  std::size_t overlapping = 0;  ///< after hits of 16 bits were tested again in float
  double bytes_per_box = 0.0;
  std::vector<double> make{};  ///< ms, of the 16-bit boxes from floats
  std::vector<double> test{};  ///< ms, of all tests

  [[nodiscard]] double false_positives() const noexcept {
    if (hits == 0) return 0.0;
    return 1.0 - static_cast<double>(overlapping) / static_cast<double>(hits);
  }
};

/// Boxes as floats, and as six 16-bit numbers relative to their group's frame, in turns. A number
/// is the end's place among 2^16 steps across the frame, rounded down for lower and upper ends
/// alike: that is monotone, so that ends which overlap keep doing so and nothing is missed.
[[nodiscard]] std::vector<BoxWidth> race_widths(std::span<const Aabb> boxes, std::size_t rounds);

}  // namespace winnow::bench
