#pragma once

#include <winnow/core/execution.h>

#include <algorithm>
#include <cstddef>

namespace winnow {

/// Stretches are as many for each of so many threads, or of a half or a quarter of them.
inline constexpr std::size_t kStretchShares = 8;

/// The length of stretches of [0, count) that are no longer than `longest`, and where they are more
/// than one of which two, four or eight threads get as many each. A multiple of 64, or `longest`.
[[nodiscard]] constexpr std::size_t even_stretch(std::size_t count, std::size_t longest) noexcept {
  constexpr std::size_t kUnit = 64;
  if (count <= longest) return longest;
  const std::size_t stretches =
      (count + kStretchShares * longest - 1) / (kStretchShares * longest) * kStretchShares;
  const std::size_t each = (count + stretches - 1) / stretches;
  return std::min(longest, (each + kUnit - 1) / kUnit * kUnit);
}

/// The same where stretches may be longer than `longest`, so that they are no more than `most`,
/// which is above kStretchShares.
[[nodiscard]] constexpr std::size_t even_stretch(std::size_t count, std::size_t longest,
                                                 std::size_t most) noexcept {
  return even_stretch(count, std::max(longest, count / (most - kStretchShares) + 1));
}

/// Cuts [0, count) into stretches of `length`, the last one shorter, and calls body(first, end) for
/// each, in parallel. Which stretches there are does not depend on the number of threads.
template <typename Body>
void for_stretches(const Execution& execution, std::size_t count, std::size_t length, Body&& body) {
  execution.for_each((count + length - 1) / length, [&](std::size_t stretch) {
    body(stretch * length, std::min(count, (stretch + 1) * length));
  });
}

/// The same in even stretches.
template <typename Body>
void for_even_stretches(const Execution& execution, std::size_t count, std::size_t longest,
                        Body&& body) {
  for_stretches(execution, count, even_stretch(count, longest), body);
}

}  // namespace winnow
