#pragma once

#include <cstdio>
#include <cstdlib>

/// Ends the example if what it should have found is not so.
inline void check(bool holds, const char* what) {
  if (holds) return;
  std::printf("not so: %s\n", what);
  std::exit(1);
}
