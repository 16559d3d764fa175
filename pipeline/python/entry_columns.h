#pragma once

#include "pipeline/python/arrays.h"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace winnow::python {

/// Shows members of an array of structs as columns; each member is `offset` bytes into its struct.
template <typename Entry>
class EntryColumns {
 public:
  EntryColumns(std::shared_ptr<const void> owner, std::span<const Entry> entries)
      : owner_(std::move(owner)), entries_(entries) {}

  /// An array (n,) of T.
  template <typename T>
  [[nodiscard]] py::array column(std::size_t offset) const {
    return shown(owner_, member<T>(offset), entries_.size(), sizeof(Entry));
  }
  /// An array (n, columns) of T.
  template <typename T>
  [[nodiscard]] py::array rows(std::size_t offset, std::size_t columns) const {
    return shown_rows(owner_, member<T>(offset), entries_.size(), columns, sizeof(Entry));
  }

 private:
  template <typename T>
  [[nodiscard]] const T* member(std::size_t offset) const noexcept {
    if (entries_.empty()) return nullptr;
    return reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(entries_.data()) + offset);
  }

  std::shared_ptr<const void> owner_;
  std::span<const Entry> entries_;
};

/// Moves entries into the owner of such columns.
template <typename Entry>
[[nodiscard]] EntryColumns<Entry> columns_of(std::vector<Entry>&& entries) {
  auto owner = std::make_shared<std::vector<Entry>>(std::move(entries));
  const std::span<const Entry> shown = *owner;
  return {std::move(owner), shown};
}

}  // namespace winnow::python
