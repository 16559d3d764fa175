#include <winnow/core/pair_events.h>

namespace winnow {

Footprint PairEvents::footprint() const noexcept {
  Footprint result;
  result.results = begun_.bytes();
  result.results += ended_.bytes();
  result.scratch = before_.bytes();
  result.scratch += after_.bytes();
  result.scratch += dropped_.bytes();
  result.scratch += spare_.bytes();
  result.scratch += stamps_.bytes();
  return result;
}

}  // namespace winnow
