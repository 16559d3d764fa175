#pragma once

#include <winnow/core/object_filter.h>

#include <cstdint>

namespace winnow {

/// What the filters of some objects have between them. It may tell less than is true of them:
/// `any` may hold more and `every` less. By default it is that of no objects.
struct FilterSpan {
  std::uint32_t any_layers = 0;      ///< layers that one of them is in
  std::uint32_t every_layers = ~0U;  ///< layers that all of them are in
  std::uint32_t any_mask = 0;        ///< layers that one of them wants to meet
  std::uint32_t every_mask = ~0U;    ///< layers that all of them want to meet
  bool mute = false;                 ///< one is in no layer, or wants to meet none
  bool apart = false;                ///< one is neither of environment 0 nor of every one
  bool everywhere = true;            ///< all are of every environment

  void add(const ObjectFilter& filter) noexcept {
    any_layers |= filter.layers;
    every_layers &= filter.layers;
    any_mask |= filter.mask;
    every_mask &= filter.mask;
    const bool of_every = filter.environment == kEveryEnvironment;
    mute = mute || filter.layers == 0 || filter.mask == 0;
    apart = apart || (filter.environment != 0 && !of_every);
    everywhere = everywhere && of_every;
  }
};

// Kernels use what follows, too: a function of which each file has its own is not merged with one
// that was compiled for another instruction set.

/// True if each of some sets of bits, none empty, surely shares one with each of some others: all
/// have one in common, or all of one side have every bit that any has of the other.
static inline bool surely_share(std::uint32_t any, std::uint32_t every, std::uint32_t other_any,
                                std::uint32_t other_every) noexcept {
  return (every & other_every) != 0 || (any & ~other_every) == 0 || (other_any & ~every) == 0;
}

/// True if each object of one span surely meets each of the other. False says nothing.
static inline bool surely_meet(const FilterSpan& a, const FilterSpan& b) noexcept {
  return !a.mute && !b.mute && (a.everywhere || b.everywhere || !(a.apart || b.apart)) &&
         surely_share(a.any_layers, a.every_layers, b.any_mask, b.every_mask) &&
         surely_share(b.any_layers, b.every_layers, a.any_mask, a.every_mask);
}

}  // namespace winnow
