#pragma once

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

/// Boxes in groups of this many rows.
inline constexpr std::size_t kGroup = 256;

/// Writes to `out` which rows of the group from `begin` on overlap the box: lower ends, then upper
/// ends, in columns and in `box` alike. Returns how many; `out` has room for 32 more than a group.
std::size_t meet(const float* const* column, const float* box, std::size_t begin,
                 std::uint32_t* out);
/// The same on 16 bits.
std::size_t meet(const std::uint16_t* const* column, const std::uint16_t* box, std::size_t begin,
                 std::uint32_t* out);

/// Boxes that one register of this machine holds an end of.
[[nodiscard]] std::size_t lanes_of_16_bits();
[[nodiscard]] std::size_t lanes_of_floats();

}  // namespace winnow::bench
