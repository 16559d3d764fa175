#pragma once

#include <winnow/core/export.h>

#include <compare>
#include <cstddef>
#include <span>  // declares the iterator tags and is shorter than <iterator>
#include <utility>

namespace winnow {

namespace detail {

/// Random-access iterator that returns elements by value.
template <typename Lookup>
class IndexIterator {
 public:
  using iterator_concept = std::random_access_iterator_tag;  ///< category for std::ranges
  /// Category before C++20: an input iterator, because elements are not stored.
  using iterator_category = std::input_iterator_tag;
  /// Type of an element.
  using value_type = decltype(std::declval<const Lookup&>()(std::size_t{0}));
  using difference_type = std::ptrdiff_t;  ///< number of elements between two iterators
  using pointer = void;                    ///< elements have no address
  using reference = value_type;            ///< elements are returned by value

  IndexIterator() = default;
  /// Points to element `at` of a column.
  IndexIterator(const Lookup& lookup, std::size_t at) noexcept : lookup_(lookup), at_(at) {}

  /// Operations of a random-access iterator.
  /// @{
  [[nodiscard]] value_type operator*() const noexcept { return lookup_(at_); }
  [[nodiscard]] value_type operator[](difference_type i) const noexcept { return *(*this + i); }
  IndexIterator& operator++() noexcept { return *this += 1; }
  IndexIterator& operator--() noexcept { return *this -= 1; }
  IndexIterator operator++(int) noexcept { return std::exchange(*this, *this + 1); }
  IndexIterator operator--(int) noexcept { return std::exchange(*this, *this - 1); }
  IndexIterator& operator+=(difference_type by) noexcept {
    at_ += static_cast<std::size_t>(by);
    return *this;
  }
  IndexIterator& operator-=(difference_type by) noexcept { return *this += -by; }
  [[nodiscard]] friend IndexIterator operator+(IndexIterator at, difference_type by) noexcept {
    return at += by;
  }
  [[nodiscard]] friend IndexIterator operator+(difference_type by, IndexIterator at) noexcept {
    return at += by;
  }
  [[nodiscard]] friend IndexIterator operator-(IndexIterator at, difference_type by) noexcept {
    return at -= by;
  }
  [[nodiscard]] friend difference_type operator-(const IndexIterator& a,
                                                 const IndexIterator& b) noexcept {
    return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
  }
  [[nodiscard]] friend bool operator==(const IndexIterator& a, const IndexIterator& b) noexcept {
    return a.at_ == b.at_;
  }
  [[nodiscard]] friend auto operator<=>(const IndexIterator& a, const IndexIterator& b) noexcept {
    return a.at_ <=> b.at_;
  }
  /// @}

 private:
  Lookup lookup_{};
  std::size_t at_ = 0;
};

}  // namespace detail

/// A computed column: element i is lookup(i) and is not stored. It is read like a span and is valid
/// as long as the data behind `lookup` is.
template <typename Lookup>
class IndexedView {
 public:
  /// Type of an element.
  using value_type = decltype(std::declval<const Lookup&>()(std::size_t{0}));

  /// Random-access iterator that returns elements by value.
  using iterator = detail::IndexIterator<Lookup>;

  /// Creates a column of elements 0 to `size` - 1.
  IndexedView(const Lookup& lookup, std::size_t size) noexcept : lookup_(lookup), size_(size) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }  ///< number of elements
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }   ///< true if the size is 0
  /// Iterator to the first element.
  [[nodiscard]] iterator begin() const noexcept { return {lookup_, 0}; }
  /// Iterator behind the last element.
  [[nodiscard]] iterator end() const noexcept { return {lookup_, size_}; }
  /// Element i; i must be below `size()`.
  [[nodiscard]] value_type operator[](std::size_t i) const noexcept { return lookup_(i); }
  /// Returns the function that computes elements.
  [[nodiscard]] const Lookup& lookup() const noexcept { return lookup_; }

 private:
  Lookup lookup_;
  std::size_t size_;
};

}  // namespace winnow
