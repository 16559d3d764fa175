// What the machine allows, without winnow: the memory traffic of a frame, and the time between two
// cores.

#include "bench/measure/machine_limits.h"

#include <winnow/core/results.h>
#include <winnow/core/volumes.h>
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "core/sort/radix_sort.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <thread>
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
  Random(1).shuffle(order);
  return order;
}

constexpr int kTries = 11;
constexpr int kThere = 1000;       // round trips per try
constexpr int kSpinLimit = 10000;  // failed reads before yielding, longer than any usual delay

/// Two threads that pass a number back and forth.
class PingPong {
 public:
  void answer() noexcept {
    for (int ball = 1; ball < 2 * kTries * kThere; ball += 2) {
      wait_for(ball);
      ball_.store(ball + 1, std::memory_order_release);
    }
  }
  /// Returns the mean nanoseconds of one direction of a round trip, in one try.
  double serve(int serve) noexcept {
    const Stopwatch clock;
    for (int i = 0; i < kThere; ++i) {
      const int ball = 2 * (serve * kThere + i) + 1;
      ball_.store(ball, std::memory_order_release);
      wait_for(ball + 1);
    }
    return 1e6 * clock.ms() / (2 * kThere);
  }

 private:
  // Yields if the other thread's core is taken by another program.
  void wait_for(int ball) const noexcept {
    for (int looks = 0; ball_.load(std::memory_order_acquire) != ball; ++looks) {
      if (looks > kSpinLimit) std::this_thread::yield();
    }
  }
  alignas(64) std::atomic<int> ball_{0};
};

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

double core_distance_ns() {
  if (std::thread::hardware_concurrency() < 2) return 0.0;
  PingPong rally;
  std::thread other([&] { rally.answer(); });
  std::vector<double> tries;
  for (int i = 0; i < kTries; ++i) tries.push_back(rally.serve(i));
  other.join();
  return median_of(tries);
}

}  // namespace winnow::bench
