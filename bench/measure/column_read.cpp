#include "bench/measure/column_read.h"

namespace winnow::bench {
namespace {

using Wide = float __attribute__((vector_size(64)));

}  // namespace

float read_columns(const float* const* columns, std::size_t count) noexcept {
  // Two sums per column, so that loads and not the latency of additions limit the speed.
  Wide sums[12] = {};
  const std::size_t steps = count / 32;
  for (std::size_t i = 0; i < steps; ++i) {
    for (std::size_t c = 0; c < 6; ++c) {
      const auto* wide = static_cast<const Wide*>(static_cast<const void*>(columns[c]));
      sums[2 * c] += wide[2 * i];
      sums[2 * c + 1] += wide[2 * i + 1];
    }
  }
  for (std::size_t c = 1; c < 12; ++c) sums[0] += sums[c];
  float sum = 0.0F;
  for (int lane = 0; lane < 16; ++lane) sum += sums[0][lane];
  return sum;
}

}  // namespace winnow::bench
