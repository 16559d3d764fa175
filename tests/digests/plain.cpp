// Runs every work of the digests once, on the calling thread, and prints their number. For checkers
// that see only code that they have compiled, hence no streams or threads of libraries. The digest
// is read, so that its inputs count as used.

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
