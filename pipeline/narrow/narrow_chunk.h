#pragma once

#include "pipeline/narrow/narrow_job.h"
#include "pipeline/solver/solver.h"

#include <cstdint>

namespace winnow {

/// Pairs of one kind that a task answers.
inline constexpr std::uint32_t kChunkPairs = 512;

/// What became of a chunk.
struct ChunkOutcome {
  std::uint32_t contacts = 0;
  std::uint32_t uncertified = 0;
  /// The smallest body with an invalid pose, or ~0U.
  std::uint32_t bad_body = ~0U;
  SolverCounts solver;
};

/// Answers a job of at most kChunkPairs pairs: by `kernel` (null: there is none), then one by one
/// what it could not certify.
ChunkOutcome answer_chunk(NarrowJob& job, NarrowLevel level, NarrowKernel kernel) noexcept;

/// Turns answer i of a job round: it becomes that about (b, a).
void turn_answer(const NarrowJob& job, NarrowLevel level, std::uint32_t i) noexcept;

}  // namespace winnow
