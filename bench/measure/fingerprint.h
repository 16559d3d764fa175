#pragma once

#include <winnow/core/results.h>
#include <winnow/core/volumes.h>

#include <cstdint>
#include <span>
#include <string>

namespace winnow::bench {

/// Summary of a frame's pairs. Two engines found the same pairs if `pairs` and `fingerprint` agree;
/// `reported` also counts pairs whose boxes do not overlap.
struct PairSummary {
  std::uint64_t reported = 0;
  std::uint64_t pairs = 0;
  std::uint64_t fingerprint = 0;  ///< sum of mix(i << 32 | j) over the overlapping pairs i < j

  [[nodiscard]] bool same_pairs(const PairSummary& other) const noexcept {
    return pairs == other.pairs && fingerprint == other.fingerprint;
  }
};

[[nodiscard]] PairSummary summarize(std::span<const Pair> pairs,
                                    std::span<const Aabb> boxes) noexcept;

/// Formats as sixteen lower-case hexadecimal digits.
[[nodiscard]] std::string to_hex(std::uint64_t value);

}  // namespace winnow::bench
