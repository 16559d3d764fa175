#pragma once

#include <winnow/core/execution.h>

#include <array>
#include <string_view>

#include "tests/support/platform.h"

namespace winnow::test {

/// Programs that run winnow's tasks on threads of their own, from the expected to the perverse:
/// - pool: as many threads as it says
/// - reversed: the thread that calls alone, beginning with the last task
/// - crowd: many more threads than it says
#if WINNOW_TEST_THREADS
inline constexpr std::array<std::string_view, 3> kHosts = {"pool", "reversed", "crowd"};
#else
inline constexpr std::array<std::string_view, 1> kHosts = {"reversed"};
#endif

/// What the host hands to winnow. Its threads live as long as the process.
[[nodiscard]] JobSystem jobs_of(std::string_view host, std::size_t threads);

}  // namespace winnow::test
