#include "bench/measure/fingerprint.h"

#include "bench/common/random.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace winnow::bench {

PairSummary summarize(std::span<const Pair> pairs, std::span<const Aabb> boxes) noexcept {
  PairSummary summary;
  summary.reported = pairs.size();
  for (const Pair& pair : pairs) {
    if (!boxes[pair.first].overlaps(boxes[pair.second])) continue;
    const std::uint64_t low = std::min(pair.first, pair.second);
    const std::uint64_t high = std::max(pair.first, pair.second);
    ++summary.pairs;
    summary.fingerprint += mix((low << 32U) | high);
  }
  return summary;
}

std::string to_hex(std::uint64_t value) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016" PRIx64, value);
  return digits;
}

}  // namespace winnow::bench
