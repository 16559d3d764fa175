#pragma once

// rewrite.py includes this into sources, only in a copy of the tree.

#include <type_traits>

namespace winnow_mutants {

/// The mutant that this process runs, from WINNOW_MUTANT; -1 for none.
extern const int chosen;
/// Nonzero for each mutant that was executed.
extern unsigned char reached[];

[[gnu::noinline]] void note(int mutant) noexcept;

/// Returns true if this mutant runs. Constant expressions are never mutated.
constexpr bool is(int mutant) noexcept {
  if (std::is_constant_evaluated()) return false;
  if (reached[mutant] == 0) note(mutant);
  return mutant == chosen;
}

}  // namespace winnow_mutants
