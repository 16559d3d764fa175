#include "tests/mutants/mutants.h"

#include <cstdio>
#include <cstdlib>

namespace winnow_mutants {
namespace {

constexpr int kMaxMutants = 100'000;

/// Appends the numbers of the executed mutants to the file that WINNOW_MUTANTS_REACHED names.
void write_reached() {
  const char* path = std::getenv("WINNOW_MUTANTS_REACHED");
  std::FILE* file = path == nullptr ? nullptr : std::fopen(path, "a");
  if (file == nullptr) return;
  for (int i = 0; i < kMaxMutants; ++i) {
    if (reached[i] != 0) std::fprintf(file, "%d\n", i);
  }
  std::fclose(file);
}

int chosen_mutant() {
  std::atexit(write_reached);
  const char* number = std::getenv("WINNOW_MUTANT");
  return number == nullptr ? -1 : std::atoi(number);
}

}  // namespace

unsigned char reached[kMaxMutants];
const int chosen = chosen_mutant();

void note(int mutant) noexcept {
  reached[mutant] = 1;
}

}  // namespace winnow_mutants
