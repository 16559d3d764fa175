#include <winnow/simd/isa.h>

#include <cstdio>

// Prints the active instruction set: what isa_test.cpp runs with WINNOW_ISA set.
int main() {
  std::fputs(winnow::isa_name(), stdout);
}
