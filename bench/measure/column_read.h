#pragma once

#include <cstddef>

namespace winnow::bench {

/// Sums six columns of `count` floats with the widest loads of the machine. Its time is the cost of
/// reading every box once. The columns are 64-byte aligned; the last floats are left out unless
/// `count` is a multiple of 32.
[[nodiscard]] float read_columns(const float* const* columns, std::size_t count) noexcept;

}  // namespace winnow::bench
