#include <winnow/core/results.h>

#include <cstring>

namespace winnow {

bool PairBuffer::assign(const PairBuffer& other) noexcept {
  if (&other == this) return true;
  if (!rows_.reserve(other.size())) return false;
  if (!other.empty()) std::memcpy(rows_.data(), other.rows_.data(), other.size() * sizeof(Pair));
  rows_.set_size(other.size());
  state_ = LinkState::unlinked;
  provenance_ = other.provenance_;
  return true;
}

void PairBuffer::release() noexcept {
  clear();
  rows_.release();
  pages_.release();
  page_table_.release();
  links_.release();
  heads_.release();
  places_.release();
}

Footprint PairBuffer::footprint() const noexcept {
  Footprint result;
  result.results = rows_.bytes();
  result.scratch = pages_.bytes();
  result.scratch += page_table_.bytes();
  result.scratch += links_.bytes();
  result.scratch += heads_.bytes();
  result.scratch += places_.bytes();
  return result;
}

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

Footprint HitBuffer::footprint() const noexcept {
  Footprint result = found_.footprint();
  result.scratch += result.results;
  result.scratch += keys_.bytes();
  result.results = rows_.bytes();
  result.results += start_.bytes();
  return result;
}

Footprint OverlapBuffer::footprint() const noexcept {
  Footprint result;
  result.results = rows_.bytes();
  result.scratch = crossing_.bytes();
  return result;
}

}  // namespace winnow
