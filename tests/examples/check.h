#pragma once

#include <cstdio>
#include <cstdlib>

/// Ends the program with an error message if the condition does not hold.
inline void check(bool holds, const char* what) {
  if (holds) return;
  std::printf("not so: %s\n", what);
  std::exit(1);
}
