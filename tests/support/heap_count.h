#pragma once

#include <cstddef>

namespace winnow::test {

/// Calls of the global operator new so far in this process; always 0 under a sanitizer, which has
/// its own. Linking heap_count.cpp is what replaces the operator.
[[nodiscard]] std::size_t heap_requests() noexcept;

}  // namespace winnow::test
