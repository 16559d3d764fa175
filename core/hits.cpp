#include <winnow/core/results.h>

namespace winnow {

Footprint HitBuffer::footprint() const noexcept {
  Footprint result = found_.footprint();
  result.scratch += result.results;
  result.scratch += keys_.bytes();
  result.results = hits_.bytes();
  result.results += start_.bytes();
  return result;
}

Footprint OverlapBuffer::footprint() const noexcept {
  Footprint result;
  result.results = ids_.bytes();
  result.scratch = crossing_.bytes();
  return result;
}

}  // namespace winnow
