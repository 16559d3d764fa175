#pragma once

#include <winnow/core/execution.h>

#include <array>
#include <string_view>

#include "tests/support/platform.h"

namespace winnow::test {

/// Programs that run winnow's tasks on their own threads, from usual to extreme:
/// - pool: as many threads as it reports
/// - reversed: only the calling thread, beginning with the last task
/// - crowd: eight threads, which is more than it reports
#if WINNOW_TEST_THREADS
inline constexpr std::array<std::string_view, 3> kHosts = {"pool", "reversed", "crowd"};
#else
inline constexpr std::array<std::string_view, 1> kHosts = {"reversed"};
#endif

/// Returns the job system of a host. Its threads live as long as the process.
[[nodiscard]] JobSystem jobs_of(std::string_view host, std::size_t threads);

}  // namespace winnow::test
