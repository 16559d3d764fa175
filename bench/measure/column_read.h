#pragma once

#include <cstddef>

namespace winnow::bench {

/// Sums six columns of `count` floats, which are 64-byte aligned and a multiple of 32 long, with
/// the widest loads of the machine: the cost of reading every box once.
[[nodiscard]] float read_columns(const float* const* columns, std::size_t count) noexcept;

}  // namespace winnow::bench
