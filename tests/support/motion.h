#pragma once

#include <winnow/core/volumes.h>

#include <array>
#include <cstddef>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// How boxes move from one frame to the next.
enum class Motion {
  little,    ///< each by a few hundredths of its size
  much,      ///< each by several times its size
  few,       ///< one in twenty by its size
  teleport,  ///< each to the place of another one, some with another size
  still,     ///< none
};

inline constexpr std::array kMotions{Motion::little, Motion::much, Motion::few, Motion::teleport,
                                     Motion::still};

[[nodiscard]] const char* to_string(Motion motion);

/// Moves the boxes and returns the indices of the changed ones, ascending.
std::vector<std::size_t> move(Motion motion, std::vector<Aabb>& boxes, Random& random);

}  // namespace winnow::test
