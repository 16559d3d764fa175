#pragma once

#include <winnow/core/filter.h>

#include <cstdint>

namespace winnow {

/// Conservative union and intersection of the filters of a set of objects: `any` may contain more
/// bits and `every` fewer than the exact values. The default describes an empty set.
struct FilterSpan {
  std::uint32_t any_layers = 0;      ///< layers of at least one object
  std::uint32_t every_layers = ~0U;  ///< layers of all objects
  std::uint32_t any_mask = 0;        ///< mask bits of at least one object
  std::uint32_t every_mask = ~0U;    ///< mask bits of all objects
  bool any_unpairable = false;       ///< some object has no layer or an empty mask
  bool environments = false;  ///< some object has an environment other than 0 and kAllEnvironments
  bool all_environments = true;  ///< all objects have kAllEnvironments

  void add(const ObjectFilter& filter) noexcept {
    any_layers |= filter.layers;
    every_layers &= filter.layers;
    any_mask |= filter.mask;
    every_mask &= filter.mask;
    const bool of_every = filter.environment == kAllEnvironments;
    any_unpairable = any_unpairable || filter.layers == 0 || filter.mask == 0;
    environments = environments || (filter.environment != 0 && !of_every);
    all_environments = all_environments && of_every;
  }
};

// Kernels use the functions below too. They are static so that the linker does not merge them with
// copies that were compiled for another instruction set.

/// True if every non-empty set of the one side is certain to share a bit with every non-empty set
/// of the other: all have a bit in common, or each set of one side contains all bits of the other
/// side.
static inline bool surely_share(std::uint32_t any, std::uint32_t every, std::uint32_t other_any,
                                std::uint32_t other_every) noexcept {
  return (every & other_every) != 0 || (any & ~other_every) == 0 || (other_any & ~every) == 0;
}

/// True if every object of one span is certain to pass the filters of every object of the other.
/// False means unknown.
static inline bool surely_match(const FilterSpan& a, const FilterSpan& b) noexcept {
  return !a.any_unpairable && !b.any_unpairable &&
         (a.all_environments || b.all_environments || !(a.environments || b.environments)) &&
         surely_share(a.any_layers, a.every_layers, b.any_mask, b.every_mask) &&
         surely_share(b.any_layers, b.every_layers, a.any_mask, a.every_mask);
}

}  // namespace winnow
