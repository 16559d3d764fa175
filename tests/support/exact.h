#pragma once

#include <vector>

namespace winnow::test {

/// A number that is computed from floats by a few sums and products without rounding: a sum of
/// doubles, no two of which share a bit (Shewchuk, "Adaptive precision floating-point arithmetic
/// and fast robust geometric predicates", 1997, sections 2.3 to 2.5). Products of up to six floats
/// neither overflow nor lose a bit at the lower end of double.
class Exact {
 public:
  Exact(double value) {  // NOLINT(google-explicit-constructor)
    if (value != 0.0) parts_.push_back(value);
  }

  friend Exact operator+(const Exact& a, const Exact& b);
  friend Exact operator-(const Exact& a);
  [[nodiscard]] friend Exact operator-(const Exact& a, const Exact& b) { return a + -b; }
  friend Exact operator*(const Exact& a, const Exact& b);
  [[nodiscard]] friend bool operator<=(const Exact& a, const Exact& b) {
    return (a - b).sign() <= 0;
  }
  [[nodiscard]] friend bool operator<(const Exact& a, const Exact& b) { return (a - b).sign() < 0; }

  /// Returns -1, 0 or 1.
  [[nodiscard]] int sign() const {
    if (parts_.empty()) return 0;
    return parts_.back() < 0.0 ? -1 : 1;
  }

 private:
  void add(double term);

  std::vector<double> parts_;  // of increasing magnitude, without zeros
};

[[nodiscard]] inline Exact abs(const Exact& a) {
  return a.sign() < 0 ? -a : a;
}

}  // namespace winnow::test
