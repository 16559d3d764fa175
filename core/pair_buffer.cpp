#include <winnow/core/results.h>

#include <cstring>

namespace winnow {

bool PairBuffer::assign(const PairBuffer& other) noexcept {
  if (&other == this) return true;
  if (!pairs_.reserve(other.size())) return false;
  if (!other.empty()) std::memcpy(pairs_.data(), other.pairs_.data(), other.size() * sizeof(Pair));
  pairs_.set_size(other.size());
  state_ = LinkState::unlinked;
  provenance_ = other.provenance_;
  return true;
}

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
