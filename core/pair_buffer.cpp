#include <winnow/core/pair_buffer.h>

namespace winnow {

void PairBuffer::release() noexcept {
  clear();
  pairs_.release();
  pages_.release();
  page_table_.release();
  links_.release();
  heads_.release();
  places_.release();
}

Footprint PairBuffer::footprint() const noexcept {
  Footprint result;
  result.results = pairs_.bytes();
  result.scratch = pages_.bytes();
  result.scratch += page_table_.bytes();
  result.scratch += links_.bytes();
  result.scratch += heads_.bytes();
  result.scratch += places_.bytes();
  return result;
}

}  // namespace winnow
