#include "tests/support/exact.h"

#include <cmath>

namespace winnow::test {

// Grow-expansion with elimination of zeros.
void Exact::add(double term) {
  std::size_t kept = 0;
  for (const double part : parts_) {
    const double sum = term + part;
    const double shadow = sum - term;
    const double error = (term - (sum - shadow)) + (part - shadow);
    if (error != 0.0) parts_[kept++] = error;
    term = sum;
  }
  parts_.resize(kept);
  if (term != 0.0) parts_.push_back(term);
}

Exact operator+(const Exact& a, const Exact& b) {
  Exact sum = a;
  for (const double part : b.parts_) sum.add(part);
  return sum;
}

Exact operator-(const Exact& a) {
  Exact result = a;
  for (double& part : result.parts_) part = -part;
  return result;
}

Exact operator*(const Exact& a, const Exact& b) {
  Exact product(0.0);
  for (const double x : a.parts_) {
    for (const double y : b.parts_) {
      const double high = x * y;
      product.add(std::fma(x, y, -high));
      product.add(high);
    }
  }
  return product;
}

}  // namespace winnow::test
