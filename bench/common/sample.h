#pragma once

#include <chrono>
#include <span>
#include <vector>

namespace winnow::bench {

/// Spread of a set of measurements; all zero for an empty set.
struct Spread {
  double min = 0.0;
  double median = 0.0;
  double max = 0.0;
};

[[nodiscard]] Spread spread_of(std::span<const double> values);
[[nodiscard]] inline double median_of(std::span<const double> values) {
  return spread_of(values).median;
}

/// Milliseconds since construction.
class Stopwatch {
 public:
  [[nodiscard]] double ms() const noexcept {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// CPU milliseconds of the calling thread since construction, which other load on the machine does
/// not affect. Only for work that stays on one thread.
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

/// Returns the exponent b of cost = a * size^b by least squares of the logarithms. NaN for fewer
/// than two sizes.
[[nodiscard]] double fitted_exponent(std::span<const GrowthPoint> points);

}  // namespace winnow::bench
