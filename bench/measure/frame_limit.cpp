#include "bench/measure/frame_limit.h"

#include <winnow/core/aabb.h>
#include <winnow/core/pair_buffer.h>
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "core/sort/radix_sort.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace winnow::bench {
namespace {

template <typename Work>
double least_ms(int repeats, Work&& work) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const Stopwatch clock;
    work();
    least = std::min(least, clock.ms());
  }
  return least;
}

/// Prevents the compiler from removing the computation of `p`.
void use(const void* p) {
  asm volatile("" : : "r"(p) : "memory");
}

std::vector<std::uint32_t> shuffled(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  Random random(1);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  return order;
}

}  // namespace

FrameLimit measure_frame_limit(std::size_t objects, std::size_t pairs, int repeats) {
  FrameLimit limit;
  std::vector<Aabb> boxes(objects);
  std::vector<Aabb> columns(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    const auto x = static_cast<float>(i);
    boxes[i] = {{x, x, x}, {x + 1, x + 1, x + 1}};
  }
  limit.bandwidth = least_ms(repeats, [&] {
    std::copy(boxes.begin(), boxes.end(), columns.begin());
    use(columns.data());
    float sum = 0.0F;
    const float* const floats = columns.data()->min.data();
    for (std::size_t i = 0; i < 6 * objects; i += 16) sum += floats[i];  // one load per cache line
    use(&sum);
  });
  const std::vector<std::uint32_t> order = shuffled(objects);
  std::vector<std::uint64_t> keys(objects);
  std::vector<std::uint64_t> spare(objects);
  limit.sort = least_ms(repeats, [&] {
    for (std::size_t i = 0; i < objects; ++i) keys[i] = std::uint64_t{order[i]} << 32U | i;
    use(radix_sort(keys.data(), spare.data(), objects, 22, Execution::serial()));
  });
  limit.permute = least_ms(repeats, [&] {
    for (std::size_t i = 0; i < objects; ++i) columns[i] = boxes[order[i]];
    use(columns.data());
  });
  std::vector<Pair> out(pairs);
  std::vector<Pair> found(512, Pair{1, 2});
  limit.emission = least_ms(repeats, [&] {
    for (std::size_t i = 0; i < pairs; i += found.size()) {
      std::copy_n(found.data(), std::min(found.size(), pairs - i), out.data() + i);
    }
    use(out.data());
  });
  return limit;
}

}  // namespace winnow::bench
