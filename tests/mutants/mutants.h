#pragma once

// Put into sources by rewrite.py, in a copy of the tree alone.

#include <type_traits>

namespace winnow_mutants {

/// The mutant that this process runs, from WINNOW_MUTANT; -1 for none.
extern const int chosen;
/// Which were come by.
extern unsigned char reached[];

[[gnu::noinline]] void note(int mutant) noexcept;

/// True where this mutant runs. What is computed while compiling stays as it is.
constexpr bool is(int mutant) noexcept {
  if (std::is_constant_evaluated()) return false;
  if (reached[mutant] == 0) note(mutant);
  return mutant == chosen;
}

}  // namespace winnow_mutants
