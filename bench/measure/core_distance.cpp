#include "bench/measure/core_distance.h"

#include "bench/common/sample.h"

#include <atomic>
#include <thread>
#include <vector>

namespace winnow::bench {
namespace {

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
