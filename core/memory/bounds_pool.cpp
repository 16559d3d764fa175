#include "core/memory/bounds_pool.h"

#include "core/sort/stretches.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;

// Eight at a time, which mostly are all there.
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
  for_stretches(execution, order.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    gather(from, order.data(), begin, end, to, missing);
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
  grown = grown && ids_.reserve(padded);
  // Columns that moved have left their padding behind.
  pad();
  return grown;
}

void BoundsPool::touch() noexcept {
  for (std::size_t c = 0; c < columns(); ++c) {
    columns_[c].set_size(rows_);
    columns_[c].touch();
  }
  ids_.set_size(rows_);
  ids_.touch();
  pad();
}

void BoundsPool::blank(std::size_t row) noexcept {
  for (std::size_t c = 0; c < columns(); ++c) columns_[c].data()[row] = empty_value(volume_, c);
  ids_.data()[row] = kNoObject;
}

void BoundsPool::pad() noexcept {
  if (ids_.data() == nullptr) return;
  const std::size_t end = (blocks() + 1) * kBlockRows;
  for (std::size_t c = 0; c < columns(); ++c) {
    std::fill(columns_[c].data() + rows_, columns_[c].data() + end, empty_value(volume_, c));
  }
  std::fill(ids_.data() + rows_, ids_.data() + end, kNoObject);
}

void BoundsPool::reorder(std::span<const std::uint32_t> order, Column<float>& spare,
                         const Execution& execution) noexcept {
  for (std::size_t c = 0; c < columns(); ++c) {
    gather(columns_[c].data(), order, spare.data(), empty_value(volume_, c), execution);
    columns_[c].swap(spare);
  }
  reorder_ids(order, spare, execution);
  rows_ = order.size();
  pad();
}

void BoundsPool::reorder_ids(std::span<const std::uint32_t> order, Column<float>& spare,
                             const Execution& execution) noexcept {
  // Ids and floats have one size: the spare column's bytes serve both.
  static_assert(sizeof(float) == sizeof(ObjectId));
  auto* const ids = reinterpret_cast<ObjectId*>(spare.data());
  std::uint32_t apart = 0;
  for (std::size_t row = 0; row < rows_; ++row) {
    apart |= ids_[row] ^ (ids_[0] + static_cast<std::uint32_t>(row));
  }
  const bool ascend = apart == 0 && rows_ != 0;
  const auto for_rows = [&](auto&& work) {
    for_stretches(execution, order.size(), kRowsPerTask, work);
  };
  if (ascend) {
    // Those of rows in the order of ids need no look.
    const ObjectId first = ids_[0];
    for_rows([&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        ids_[i] = order[i] == kNoObject ? kNoObject : first + order[i];
      }
    });
    return;
  }
  gather(ids_.data(), order, ids, kNoObject, execution);
  for_rows([&](std::size_t begin, std::size_t end) {
    std::copy(ids + begin, ids + end, ids_.data() + begin);
  });
}

void BoundsPool::reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                              Column<float>& spare) noexcept {
  const Execution here = Execution::serial();
  for (std::size_t c = 0; c < columns(); ++c) {
    gather(columns_[c].data(), order, spare.data(), empty_value(volume_, c), here);
    std::copy_n(spare.data(), order.size(), columns_[c].data() + begin);
  }
  gather(ids_.data(), order, reinterpret_cast<ObjectId*>(spare.data()), kNoObject, here);
  std::copy_n(reinterpret_cast<const ObjectId*>(spare.data()), order.size(), ids_.data() + begin);
  rows_ = begin + order.size();
  pad();
}

void BoundsPool::release() noexcept {
  for (Column<float>& column : columns_) column.release();
  ids_.release();
  rows_ = 0;
}

Bytes BoundsPool::bytes() const noexcept {
  Bytes sum;
  for (std::size_t c = 0; c < columns(); ++c) {
    sum += {rows_ * sizeof(float), columns_[c].bytes().reserved};
  }
  sum += {rows_ * sizeof(ObjectId), ids_.bytes().reserved};
  return sum;
}

}  // namespace winnow
