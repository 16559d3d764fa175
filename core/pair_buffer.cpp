#include <winnow/core/pair_buffer.h>

namespace winnow {

Footprint PairBuffer::footprint() const noexcept {
  Footprint result;
  result.results = pairs_.bytes();
  result.scratch = pages_.bytes();
  result.scratch += page_table_.bytes();
  return result;
}

}  // namespace winnow
