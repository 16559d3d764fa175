#pragma once

#include <cstddef>

namespace winnow::bench {

/// Adds up six columns of `count` floats, 64-byte aligned and a multiple of 32 long: what it costs
/// to have read every box once, as fast as this machine's widest loads go.
[[nodiscard]] float read_columns(const float* const* columns, std::size_t count) noexcept;

}  // namespace winnow::bench
