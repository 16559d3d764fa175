// Growth, padding and reordering of the columns of bounding volumes. Called by the rows of a
// Partition (partitions/rows/) and its spatial index.

#include "core/memory/bounds_pool.h"

#include "core/sort/parallel_ranges.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;
constexpr ObjectFilter kNoFilter{.layers = 0, .mask = 0, .environment = 0};

// Returns the spare column as 32-bit integers, so that one column is scratch for integers and
// floats.
std::uint32_t* words_of(Column<float>& spare) noexcept {
  static_assert(sizeof(float) == sizeof(std::uint32_t));
  return reinterpret_cast<std::uint32_t*>(spare.data());
}

// Copies groups of eight elements, with one test for missing rows per group, because groups with
// missing rows are rare.
template <typename T>
void gather(const T* from, const std::uint32_t* order, std::size_t begin, std::size_t end, T* to,
            T missing) {
  constexpr std::size_t kTogether = 8;
  std::size_t i = begin;
  const auto one = [&](std::size_t k) { to[k] = order[k] == kNoObject ? missing : from[order[k]]; };
  for (; i + kTogether <= end; i += kTogether) {
    std::uint32_t most = 0;
    for (std::size_t k = i; k < i + kTogether; ++k) most = std::max(most, order[k]);
    if (most == kNoObject) {
      for (std::size_t k = i; k < i + kTogether; ++k) one(k);
    } else {
      for (std::size_t k = i; k < i + kTogether; ++k) to[k] = from[order[k]];
    }
  }
  for (; i < end; ++i) one(i);
}

template <typename T>
void gather(const T* from, std::span<const std::uint32_t> order, T* to, T missing,
            const Execution& execution) {
  for_each_even_range(execution, order.size(), kRowsPerTask,
                      [&](std::size_t begin, std::size_t end) {
                        gather(from, order.data(), begin, end, to, missing);
                      });
}

// Reorders 32-bit integers in place.
void reorder_words(std::uint32_t* words, std::span<const std::uint32_t> order, Column<float>& spare,
                   std::uint32_t missing, const Execution& execution) {
  const std::uint32_t* const sorted = words_of(spare);
  gather(words, order, words_of(spare), missing, execution);
  for_each_even_range(execution, order.size(), kRowsPerTask,
                      [&](std::size_t begin, std::size_t end) {
                        std::copy(sorted + begin, sorted + end, words + begin);
                      });
}

}  // namespace

bool BoundsPool::reserve(std::size_t rows) noexcept {
  if (rows <= capacity()) return true;
  return reserve_exact(std::max(rows, capacity() + capacity() / 2)) || reserve_exact(rows);
}

bool BoundsPool::reserve_exact(std::size_t rows) noexcept {
  if (ids_.data() != nullptr && rows <= capacity()) return true;
  const std::size_t padded = (blocks_of(rows) + 2) * kBlockRows;
  bool grown = true;
  for (std::size_t c = 0; c < columns() && grown; ++c) {
    columns_[c].set_size(rows_);
    grown = columns_[c].reserve(padded);
  }
  ids_.set_size(rows_);
  for (std::size_t c = 0; c < kFilterColumns && has_filters_ && grown; ++c) {
    filters_[c].set_size(rows_);
    grown = filters_[c].reserve(padded);
  }
  grown = grown && ids_.reserve(padded);
  // Reallocated columns have lost their padding.
  pad();
  return grown;
}

bool BoundsPool::reserve_filters() noexcept {
  if (has_filters_) return true;
  for (Column<std::uint32_t>& column : filters_) {
    column.clear();
    if (!column.reserve(ids_.capacity())) return false;
  }
  return true;
}

void BoundsPool::begin_filters() noexcept {
  if (has_filters_) return;
  has_filters_ = true;
  for (std::size_t row = 0; row < rows_; ++row) {
    set_filter(row, ids_[row] == kNoObject ? kNoFilter : ObjectFilter{});
  }
  pad();
}

void BoundsPool::touch() noexcept {
  for (std::size_t c = 0; c < columns(); ++c) {
    columns_[c].set_size(rows_);
    columns_[c].touch();
  }
  ids_.set_size(rows_);
  ids_.touch();
  for (std::size_t c = 0; c < kFilterColumns && has_filters_; ++c) {
    filters_[c].set_size(rows_);
    filters_[c].touch();
  }
  pad();
}

void BoundsPool::copy_row(std::size_t from, std::size_t to) noexcept {
  for (std::size_t c = 0; c < columns(); ++c) columns_[c][to] = columns_[c][from];
  ids_[to] = ids_[from];
  for (std::size_t c = 0; c < kFilterColumns && has_filters_; ++c) {
    filters_[c][to] = filters_[c][from];
  }
}

void BoundsPool::blank(std::size_t row) noexcept {
  for (std::size_t c = 0; c < columns(); ++c) columns_[c].data()[row] = empty_value(volume_, c);
  ids_.data()[row] = kNoObject;
  if (has_filters_) set_filter(row, kNoFilter);
}

void BoundsPool::pad() noexcept {
  if (ids_.data() == nullptr) return;
  const std::size_t end = (blocks() + 1) * kBlockRows;
  for (std::size_t c = 0; c < columns(); ++c) {
    std::fill(columns_[c].data() + rows_, columns_[c].data() + end, empty_value(volume_, c));
  }
  std::fill(ids_.data() + rows_, ids_.data() + end, kNoObject);
  for (std::size_t row = rows_; row < end && has_filters_; ++row) set_filter(row, kNoFilter);
}

void BoundsPool::reorder(std::span<const std::uint32_t> order, Column<float>& spare,
                         const Execution& execution) noexcept {
  for (std::size_t c = 0; c < columns(); ++c) {
    gather(columns_[c].data(), order, spare.data(), empty_value(volume_, c), execution);
    columns_[c].swap(spare);
  }
  reorder_ids(order, spare, execution);
  for (std::size_t c = 0; c < kFilterColumns && has_filters_; ++c) {
    reorder_words(filters_[c].data(), order, spare, 0, execution);
  }
  rows_ = order.size();
  pad();
}

void BoundsPool::reorder_ids(std::span<const std::uint32_t> order, Column<float>& spare,
                             const Execution& execution) noexcept {
  std::uint32_t apart = 0;
  for (std::size_t row = 0; row < rows_; ++row) {
    apart |= ids_[row] ^ (ids_[0] + static_cast<std::uint32_t>(row));
  }
  const bool ascend = apart == 0 && rows_ != 0;
  if (!ascend) return reorder_words(ids_.data(), order, spare, kNoObject, execution);
  // Ids ascend by one from row to row, so they are computed instead of read.
  const ObjectId first = ids_[0];
  for_each_even_range(execution, order.size(), kRowsPerTask,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                          ids_[i] = order[i] == kNoObject ? kNoObject : first + order[i];
                        }
                      });
}

void BoundsPool::reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                              Column<float>& spare) noexcept {
  const Execution here = Execution::serial();
  for (std::size_t c = 0; c < columns(); ++c) {
    gather(columns_[c].data(), order, spare.data(), empty_value(volume_, c), here);
    std::copy_n(spare.data(), order.size(), columns_[c].data() + begin);
  }
  const auto move_words = [&](std::uint32_t* words, std::uint32_t missing) {
    gather(words, order, words_of(spare), missing, here);
    std::copy_n(words_of(spare), order.size(), words + begin);
  };
  move_words(ids_.data(), kNoObject);
  for (std::size_t c = 0; c < kFilterColumns && has_filters_; ++c) {
    move_words(filters_[c].data(), 0);
  }
  rows_ = begin + order.size();
  pad();
}

void BoundsPool::release() noexcept {
  for (Column<float>& column : columns_) column.release();
  ids_.release();
  for (Column<std::uint32_t>& column : filters_) column.release();
  rows_ = 0;
  has_filters_ = false;
}

Bytes BoundsPool::bytes() const noexcept {
  Bytes sum;
  for (std::size_t c = 0; c < columns(); ++c) {
    sum += {rows_ * sizeof(float), columns_[c].bytes().reserved};
  }
  sum += {rows_ * sizeof(ObjectId), ids_.bytes().reserved};
  return sum;
}

Bytes BoundsPool::filter_bytes() const noexcept {
  Bytes sum;
  for (const Column<std::uint32_t>& column : filters_) {
    sum += {has_filters_ ? rows_ * sizeof(std::uint32_t) : 0, column.bytes().reserved};
  }
  return sum;
}

}  // namespace winnow
