#pragma once

#include <cstddef>

namespace winnow::test {

/// Returns the number of calls of the global operator new in this process; always 0 under a
/// sanitizer, which replaces the operator itself. Linking heap_count.cpp replaces the operator.
[[nodiscard]] std::size_t heap_requests() noexcept;

}  // namespace winnow::test
