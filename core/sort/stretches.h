#pragma once

#include <winnow/core/execution.h>

#include <algorithm>
#include <cstddef>

namespace winnow {

/// Cuts [0, count) into stretches of `length`, the last one shorter, and calls body(first, end) for
/// each, in parallel. Which stretches there are does not depend on the number of threads.
template <typename Body>
void for_stretches(const Execution& execution, std::size_t count, std::size_t length, Body&& body) {
  execution.for_each((count + length - 1) / length, [&](std::size_t stretch) {
    body(stretch * length, std::min(count, (stretch + 1) * length));
  });
}

}  // namespace winnow
