#pragma once

#include <winnow/core/export.h>

#include <compare>
#include <cstddef>
#include <span>  // tells of iterators at a third of what <iterator> costs whoever includes this
#include <utility>

namespace winnow {

/// A column that is not stored: element i is lookup(i). Read like a span, and valid as long as what
/// it looks at is.
template <typename Lookup>
class LookedUp {
 public:
  using value_type = decltype(std::declval<const Lookup&>()(std::size_t{0}));  ///< of an element

  /// Leads through the elements, which it gives by value.
  class iterator {
   public:
    using iterator_concept = std::random_access_iterator_tag;  ///< for ranges
    using iterator_category = std::input_iterator_tag;         ///< elements are not stored
    using value_type = LookedUp::value_type;                   ///< of an element
    using difference_type = std::ptrdiff_t;                    ///< elements between two
    using pointer = void;                                      ///< there is none
    using reference = value_type;                              ///< by value

    /// Leads nowhere.
    iterator() = default;
    /// To element `at` of a column.
    iterator(const Lookup& lookup, std::size_t at) noexcept : lookup_(lookup), at_(at) {}

    /// The element.
    [[nodiscard]] value_type operator*() const noexcept { return lookup_(at_); }
    /// The element `i` after it.
    [[nodiscard]] value_type operator[](difference_type i) const noexcept { return *(*this + i); }
    /// On by one.
    iterator& operator++() noexcept { return *this += 1; }
    /// Back by one.
    iterator& operator--() noexcept { return *this -= 1; }
    /// On by one; returns where it was.
    iterator operator++(int) noexcept { return std::exchange(*this, *this + 1); }
    /// Back by one; returns where it was.
    iterator operator--(int) noexcept { return std::exchange(*this, *this - 1); }
    /// On by so many.
    iterator& operator+=(difference_type by) noexcept {
      at_ += static_cast<std::size_t>(by);
      return *this;
    }
    /// Back by so many.
    iterator& operator-=(difference_type by) noexcept { return *this += -by; }
    /// So many elements on.
    [[nodiscard]] friend iterator operator+(iterator at, difference_type by) noexcept {
      return at += by;
    }
    /// So many elements on.
    [[nodiscard]] friend iterator operator+(difference_type by, iterator at) noexcept {
      return at += by;
    }
    /// So many elements back.
    [[nodiscard]] friend iterator operator-(iterator at, difference_type by) noexcept {
      return at -= by;
    }
    /// Elements from b on to a.
    [[nodiscard]] friend difference_type operator-(const iterator& a, const iterator& b) noexcept {
      return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
    }
    /// True at the same element.
    [[nodiscard]] friend bool operator==(const iterator& a, const iterator& b) noexcept {
      return a.at_ == b.at_;
    }
    /// In the order of elements.
    [[nodiscard]] friend auto operator<=>(const iterator& a, const iterator& b) noexcept {
      return a.at_ <=> b.at_;
    }

   private:
    Lookup lookup_{};
    std::size_t at_ = 0;
  };

  /// Elements 0 to `size` - 1.
  LookedUp(const Lookup& lookup, std::size_t size) noexcept : lookup_(lookup), size_(size) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }         ///< elements
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }          ///< true without any
  [[nodiscard]] iterator begin() const noexcept { return {lookup_, 0}; }    ///< to the first
  [[nodiscard]] iterator end() const noexcept { return {lookup_, size_}; }  ///< behind the last
  /// Element i, below `size()`.
  [[nodiscard]] value_type operator[](std::size_t i) const noexcept { return lookup_(i); }
  /// How an element is found.
  [[nodiscard]] const Lookup& lookup() const noexcept { return lookup_; }

 private:
  Lookup lookup_;
  std::size_t size_;
};

}  // namespace winnow
