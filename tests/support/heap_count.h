#pragma once

#include <cstddef>

namespace winnow::test {

/// Returns the number of calls of the global operator new in this process. heap_count.cpp replaces
/// the operator to count, except on Windows, without exceptions, and under a sanitizer, which
/// replaces it itself; there the number is 0.
[[nodiscard]] std::size_t heap_requests() noexcept;

}  // namespace winnow::test
