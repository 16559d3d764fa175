#include <winnow/core/results.h>

namespace winnow {

Footprint PairEvents::footprint() const noexcept {
  Footprint result;
  result.results = begun_.bytes();
  result.results += ended_.bytes();
  result.results += begun_data_.bytes();
  result.results += ended_data_.bytes();
  const Bytes pairs = pairs_.footprint().total();
  result.scratch = pairs;
  result.scratch += before_.bytes();
  result.scratch += after_.bytes();
  result.scratch += dropped_.bytes();
  result.scratch += spare_.bytes();
  result.scratch += stamps_.bytes();
  result.scratch += data_.bytes();
  return result;
}

}  // namespace winnow
