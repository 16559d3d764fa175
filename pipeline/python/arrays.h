#pragma once

// Conversion between numpy arrays and winnow's views, in both directions. All other files of the
// module use this; arrays.cpp implements it.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <winnow/core/key.h>
#include <winnow/core/pose.h>
#include <winnow/core/results.h>
#include <winnow/core/volumes.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/numbers/rounding.h"

namespace winnow::python {

namespace py = pybind11;

/// An array of float or double numbers, read in place: any strides, but aligned entries in native
/// byte order. Other types that convert to double without loss are converted.
class Numbers {
 public:
  /// Expects any number of entries of `shape`: an array with one dimension more than `shape`.
  /// `name` is for messages. If `one`, a single entry, an array of `shape`, is accepted for all
  /// entries: its stride is 0, and `repeat` sets its count.
  Numbers(py::handle object, const char* name, const std::vector<std::size_t>& shape,
          bool one = false);

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  [[nodiscard]] bool is_single() const noexcept { return single_; }
  /// True if a single entry is used for all.
  [[nodiscard]] bool is_one() const noexcept { return one_; }
  /// Throws a size_mismatch unless there are `count` entries; repeats a single entry.
  void expect(std::size_t count);

  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return stride_; }
  /// Component (j, k) of the first entry. T must be float if `is_single`, else double.
  template <typename T>
  [[nodiscard]] const T* column(std::size_t j, std::size_t k = 0) const noexcept {
    return reinterpret_cast<const T*>(data_ + static_cast<std::ptrdiff_t>(j) * inner_[0] +
                                      static_cast<std::ptrdiff_t>(k) * inner_[1]);
  }
  /// Component (j, k) of entry i.
  [[nodiscard]] double at(std::size_t i, std::size_t j = 0, std::size_t k = 0) const noexcept {
    const std::byte* const p = data_ + static_cast<std::ptrdiff_t>(i) * stride_ +
                               static_cast<std::ptrdiff_t>(j) * inner_[0] +
                               static_cast<std::ptrdiff_t>(k) * inner_[1];
    if (single_) return to_double(*reinterpret_cast<const float*>(p));
    return *reinterpret_cast<const double*>(p);
  }
  /// True if entries and components are contiguous.
  [[nodiscard]] bool is_dense(std::size_t components) const noexcept;

 private:
  py::array array_;
  const char* name_;
  const std::byte* data_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  std::ptrdiff_t inner_[2] = {0, 0};
  std::size_t count_ = 0;
  bool single_ = false;
  bool one_ = false;
};

/// Boxes given as lower and upper corners, (n, 3) each.
class BoxInput {
 public:
  BoxInput(py::handle lower, py::handle upper);

  [[nodiscard]] std::size_t count() const noexcept { return lower_.count(); }
  /// True if the arrays can be used without a copy: both of float, with one stride.
  [[nodiscard]] bool is_in_place() const noexcept;
  /// Returns a view; other arrays are rounded outward into `room`. Needs no GIL.
  [[nodiscard]] BoxView view(std::vector<Aabb>& room) const;

 private:
  Numbers lower_;
  Numbers upper_;
};

/// A contiguous array of integers of type T, with one dimension, or with two and `columns` in each
/// row. Other integers are copied if they are in the range of T.
template <typename T>
class Integers {
 public:
  Integers(py::handle object, const char* name, std::size_t columns = 1);

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Count times columns numbers.
  [[nodiscard]] std::span<const T> values() const noexcept { return values_; }
  [[nodiscard]] T operator[](std::size_t i) const noexcept { return values_[i]; }

 private:
  py::array array_;
  std::size_t count_ = 0;
  std::span<const T> values_;
};
extern template class Integers<std::uint8_t>;
extern template class Integers<std::uint32_t>;
extern template class Integers<std::uint64_t>;

/// Keys as uint64: the id in the lower half, the stamp in the upper half.
class KeyInput {
 public:
  explicit KeyInput(py::handle object, const char* name = "keys") : words_(object, name) {}
  [[nodiscard]] std::size_t count() const noexcept { return words_.count(); }
  [[nodiscard]] std::span<const Key> keys() const noexcept {
    return {reinterpret_cast<const Key*>(words_.values().data()), words_.count()};
  }

 private:
  Integers<std::uint64_t> words_;
};

/// An integer for each of n entries: an array, or one number for all.
class EachInteger {
 public:
  EachInteger(py::handle object, const char* name, std::uint64_t most);
  /// Throws a size_mismatch unless there is one number for all or `count` numbers.
  void expect(std::size_t count) const;
  [[nodiscard]] std::uint64_t operator[](std::size_t i) const noexcept {
    return words_.empty() ? all_ : words_[i];
  }

 private:
  const char* name_;
  std::vector<std::uint64_t> words_;
  bool one_ = false;
  std::uint64_t all_ = 0;
};

/// Poses: (n, 7) with x, y, z and a quaternion w, x, y, z; (n, 3) positions only; or a tuple of
/// positions (n, 3) and quaternions (n, 4).
class PoseInput {
 public:
  explicit PoseInput(py::handle object);

  [[nodiscard]] std::size_t count() const noexcept { return position_.count(); }
  [[nodiscard]] Pose operator[](std::size_t i) const noexcept;
  /// Returns a view of the arrays if positions are of double, else of copies in `room`.
  [[nodiscard]] PoseView view(std::vector<Pose>& room) const;
  /// Returns the array itself if it is (n, 7), of double and contiguous, else copies in `room`.
  [[nodiscard]] std::span<const Pose> packed(std::vector<Pose>& room) const;

 private:
  Numbers position_;
  /// Quaternions are columns 3 to 6 of `position_`; otherwise they are in `turn_`, or there are
  /// none.
  bool is_joined_ = false;
  std::optional<Numbers> turn_;
};

/// Client data: none, or a number for each object.
[[nodiscard]] std::vector<ClientData> data_of(py::handle object, std::size_t count);

// Arrays that are returned own their data, either directly or through `owner`, which lives as long
// as the array. Arrays with an owner are read-only.

template <typename T>
[[nodiscard]] py::array shown_strided(const std::shared_ptr<const void>& owner, const T* data,
                                      std::vector<py::ssize_t> shape,
                                      std::vector<py::ssize_t> strides) {
  auto holder = std::make_unique<std::shared_ptr<const void>>(owner);
  py::capsule capsule(holder.get(),
                      [](void* p) { delete static_cast<std::shared_ptr<const void>*>(p); });
  static_cast<void>(holder.release());
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, capsule);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}
/// A column of `count` numbers, `stride` bytes apart.
template <typename T>
[[nodiscard]] py::array shown(const std::shared_ptr<const void>& owner, const T* data,
                              std::size_t count, std::size_t stride = sizeof(T)) {
  return shown_strided(owner, data, {static_cast<py::ssize_t>(count)},
                       {static_cast<py::ssize_t>(stride)});
}
/// `count` rows of `columns` numbers.
template <typename T>
[[nodiscard]] py::array shown_rows(const std::shared_ptr<const void>& owner, const T* data,
                                   std::size_t count, std::size_t columns, std::size_t stride) {
  return shown_strided(owner, data,
                       {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(columns)},
                       {static_cast<py::ssize_t>(stride), static_cast<py::ssize_t>(sizeof(T))});
}

/// Moves a vector into an array.
template <typename T>
[[nodiscard]] py::array given(std::vector<T>&& values, std::size_t columns = 0) {
  auto owner = std::make_shared<std::vector<T>>(std::move(values));
  const T* const data = owner->data();
  const std::size_t count = owner->size();
  if (columns == 0) return shown(owner, data, count);
  return shown_rows(owner, data, count / columns, columns, columns * sizeof(T));
}

/// A cache of memory blocks of large arrays. A block that is no longer used goes to the next array
/// of about its size, so the pages of such arrays are mapped only once. Keeps at most 16 blocks and
/// 128 MB. Thread-safe.
class BlockCache {
 public:
  /// Smaller arrays come from numpy's allocator, which reuses mapped pages.
  static constexpr std::size_t kMinBytes = std::size_t{1} << 16U;

  /// Returns a block of at least `bytes` bytes, and the capsule that releases it. Needs the GIL.
  [[nodiscard]] static std::pair<void*, py::capsule> take(std::size_t bytes);
};

/// A new array, not initialized.
template <typename T, typename... Counts>
[[nodiscard]] py::array_t<T> fresh(std::size_t count, Counts... columns) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(count),
                                       static_cast<py::ssize_t>(columns)...};
  std::size_t bytes = sizeof(T) * count;
  ((bytes *= static_cast<std::size_t>(columns)), ...);
  if (bytes < BlockCache::kMinBytes) return py::array_t<T>(shape);
  auto [block, owner] = BlockCache::take(bytes);
  return py::array_t<T>(shape, static_cast<T*>(block), owner);
}
/// A new array (n, 3) of vectors whose coordinates are columns: column(axis) is a span.
template <typename Column>
[[nodiscard]] py::array vectors(Column&& column) {
  using T = std::remove_cv_t<typename decltype(column(0))::element_type>;
  py::array_t<T> rows = fresh<T>(column(0).size(), 3);
  T* const to = rows.mutable_data();
  for (int axis = 0; axis < 3; ++axis) {
    const std::span<const T> from = column(axis);
    for (std::size_t i = 0; i < from.size(); ++i)
      to[3 * i + static_cast<std::size_t>(axis)] = from[i];
  }
  return rows;
}
[[nodiscard]] inline Key* keys_in(py::array_t<std::uint64_t>& array) {
  return reinterpret_cast<Key*>(array.mutable_data());
}

}  // namespace winnow::python
