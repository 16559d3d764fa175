#include <winnow/core/rounding.h>

#include "core/threads/float_environment.h"

namespace winnow::detail {

// Through memory that the compiler cannot see through: it does not know that the environment
// changes, and could move arithmetic out of its scope.

float round_up_tiny(double value) noexcept {
  const DefaultEnvironment environment;
  const volatile double seen = value;
  const volatile float result = round_up_unflushed(seen);
  return result;
}

double add_down_tiny(double a, double b) noexcept {
  const DefaultEnvironment environment;
  const volatile double seen[2] = {a, b};
  const volatile double result = add_down_unflushed(seen[0], seen[1]);
  return result;
}

}  // namespace winnow::detail
