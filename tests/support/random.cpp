#include "tests/support/random.h"

#include <algorithm>
#include <cstdlib>

namespace winnow::test {

std::uint64_t base_seed() {
  static const std::uint64_t seed = [] {
    const char* text = std::getenv("WINNOW_SEED");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : 1ULL;
  }();
  return seed;
}

namespace {

double scale() {
  static const double factor = [] {
    const char* text = std::getenv("WINNOW_TEST_SCALE");
    return text != nullptr ? std::clamp(std::strtod(text, nullptr), 0.01, 100.0) : 1.0;
  }();
  return factor;
}

}  // namespace

std::size_t scaled(std::size_t count) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(count) * scale()));
}

bool is_reduced() {
  return scale() < 1.0;
}

bool is_quick() {
  return scale() < 0.5;
}

}  // namespace winnow::test
