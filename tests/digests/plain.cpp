// Does every work of the digests once, on the caller's thread, and prints how many there are: for
// checkers that see only what they have compiled, and so neither streams nor threads of libraries.
// A digest is looked at, so that what it was made of counts as used.

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
