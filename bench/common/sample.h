#pragma once

#include <chrono>
#include <span>
#include <vector>

namespace winnow::bench {

/// Of a set of measurements. All zero if there is none.
struct Spread {
  double min = 0.0;
  double median = 0.0;
  double max = 0.0;
};

[[nodiscard]] Spread spread_of(std::span<const double> values);
[[nodiscard]] inline double median_of(std::span<const double> values) {
  return spread_of(values).median;
}

/// Milliseconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double ms() const noexcept {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Milliseconds that the calling thread has computed since it was made: what a machine does beside
/// it does not count. Only for work that stays on one thread.
class ThreadStopwatch {
 public:
  [[nodiscard]] double ms() const noexcept { return now_ms() - start_; }

 private:
  [[nodiscard]] static double now_ms() noexcept;
  double start_ = now_ms();
};

struct GrowthPoint {
  double size = 0.0;
  double cost = 0.0;
};

/// Exponent b of cost = a * size^b: least squares of the logarithms. NaN for less than two sizes.
[[nodiscard]] double fitted_exponent(std::span<const GrowthPoint> points);

}  // namespace winnow::bench
