#include <winnow/simd/isa.h>

#include <cstdio>

// Prints the active instruction set; isa_test.cpp runs this with WINNOW_ISA set.
int main() {
  std::fputs(winnow::isa_name(), stdout);
}
