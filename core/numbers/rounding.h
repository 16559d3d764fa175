#pragma once

// The functions by which the library rounds outward, without the prefix that they have in public
// headers. <winnow/core/vectors.h> defines them, because inline functions of public headers call
// them too.

#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>

namespace winnow {

using detail::add_down;
using detail::add_up;
using detail::finite_float;
using detail::next_up;
using detail::to_double;

}  // namespace winnow
