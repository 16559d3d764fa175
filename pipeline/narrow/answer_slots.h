#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/narrow_phase.h>
#include "core/sort/parallel_ranges.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Writes to slots[i] the index of the answer about pair i of the input. `slots` has room for
/// answers.size() entries.
inline void find_slots(const NarrowResult& answers, const Execution& execution,
                       std::uint32_t* slots) noexcept {
  constexpr std::size_t kAnswersPerRange = 8192;
  for_each_range(execution, answers.size(), kAnswersPerRange,
                 [&](std::size_t first, std::size_t end) {
                   for (std::size_t i = first; i < end; ++i) {
                     slots[answers.pair_of(i)] = static_cast<std::uint32_t>(i);
                   }
                 });
}

}  // namespace winnow
