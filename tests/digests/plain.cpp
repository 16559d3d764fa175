// Runs every work of the digests once, on the calling thread, and prints their number. Checkers
// such as clang's memory sanitizer see only code that they have compiled, so this program uses no
// streams or threads of libraries. It reads each digest, so that uninitialized inputs are detected.

#include <cstdio>

#include "tests/digests/digest.h"

int main() {
  using namespace winnow::test;
  int done = 0;
  for (const Work& work : all_work()) {
    Digest digest;
    work.run(winnow::Execution::serial(), digest);
    if (digest.value() != 0) ++done;
  }
  std::printf("%d works done\n", done);
  return 0;
}
