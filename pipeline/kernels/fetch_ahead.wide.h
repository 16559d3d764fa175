#pragma once

#include "pipeline/kernels/kernels.h"

namespace winnow::WINNOW_ISA_NAME {

/// Prefetches the bodies of the pair that is kAhead pairs after pair i.
[[gnu::always_inline]] static inline void fetch_ahead(const NarrowJob& job, std::uint32_t i) {
  constexpr std::uint32_t kAhead = 16;
  if (i + kAhead >= job.count) return;
  const BodyPair& next = job.pairs[i + kAhead];
  const std::uint32_t bodies[2] = {next.a, next.b};
  for (const std::uint32_t body : bodies) {
    // A pose may extend over two cache lines.
    __builtin_prefetch(job.poses[body].position.data());
    __builtin_prefetch(job.poses[body].orientation.data() + 3);
    __builtin_prefetch(job.shapes + body);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME
