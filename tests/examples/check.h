#pragma once

#include <winnow/core/status.h>

#include <cstdio>
#include <cstdlib>

/// Ends the program with an error message if the condition does not hold.
inline void check(bool holds, const char* what) {
  if (holds) return;
  std::printf("not so: %s\n", what);
  std::exit(1);
}

/// Ends the program unless a call succeeded. Programs have their own error handling in its place.
inline void must(winnow::Status status) {
  check(status == winnow::Status::ok, winnow::to_string(status));
}
