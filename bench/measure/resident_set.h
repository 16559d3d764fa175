#pragma once

#include <cstddef>

namespace winnow::bench {

/// Makes the resident set of the process follow its allocations page by page: large blocks get
/// pages of their own, which are returned to the system when freed, and huge pages are disabled.
/// Slows allocations down, so it must not be used in a process that times something afterwards.
void keep_resident_set_exact();

/// Gives freed memory back to the system, and returns the bytes of anonymous memory, without mapped
/// files, that are then resident; 0 if the system does not provide the number.
[[nodiscard]] std::size_t resident_bytes();

}  // namespace winnow::bench
