#pragma once

// Arrays that calls return. See inputs.h for arguments.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <winnow/core/key.h>

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
/// Returns an object of a class of winnow/tables.py with these columns, in the order of its
/// members.
template <typename... Columns>
[[nodiscard]] py::object table(const char* name, Columns&&... columns) {
  return py::module_::import("winnow.tables").attr(name)(std::forward<Columns>(columns)...);
}
[[nodiscard]] inline Key* keys_in(py::array_t<std::uint64_t>& array) {
  return reinterpret_cast<Key*>(array.mutable_data());
}

}  // namespace winnow::python
