#pragma once

#include <cstddef>

namespace winnow::bench {

/// From now on the process's resident set follows what it allocates, page by page: large blocks get
/// pages of their own, which go back to the system when they are freed, and no page is a huge one.
/// Costs time: not for a process in which something is timed afterwards.
void keep_resident_set_exact();

/// Bytes of memory that the process has written to and the system holds for it, without files
/// mapped into it; what was freed is given back first. 0 if the system does not tell.
[[nodiscard]] std::size_t resident_bytes();

}  // namespace winnow::bench
