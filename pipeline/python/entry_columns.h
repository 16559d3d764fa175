#pragma once

#include "pipeline/python/arrays.h"

#include <winnow/core/key.h>
#include <winnow/core/pose.h>
#include <winnow/core/results.h>
#include <winnow/pipeline/shapes.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace winnow::python {

/// The numbers of a member of a struct.
template <typename Member>
struct NumberOf {
  using type = Member;
};
template <typename Member>
requires std::is_enum_v<Member>
struct NumberOf<Member> : std::underlying_type<Member> {
};
template <>
struct NumberOf<Key> {
  using type = std::uint64_t;
};
template <>
struct NumberOf<Pair> {
  using type = std::uint32_t;
};
template <>
struct NumberOf<ShapeId> {
  using type = std::uint32_t;
};
template <>
struct NumberOf<Vec3d> {
  using type = double;
};
template <>
struct NumberOf<Pose> {
  using type = double;
};
template <typename Element, std::size_t N>
struct NumberOf<Element[N]> : NumberOf<Element> {};
template <typename Element, std::size_t N>
struct NumberOf<std::array<Element, N>> : NumberOf<Element> {};

/// Shows members of an array of structs as columns; each member is `offset` bytes into its struct.
template <typename Entry>
class EntryColumns {
 public:
  EntryColumns(std::shared_ptr<const void> owner, std::span<const Entry> entries)
      : owner_(std::move(owner)), entries_(entries) {}

  /// The numbers of a member: an array (n,), or (n, k) if the member has k numbers.
  template <typename Member>
  [[nodiscard]] py::array of(Member Entry::*member) const {
    using T = typename NumberOf<Member>::type;
    static_assert(std::is_arithmetic_v<T>);
    constexpr std::size_t columns = sizeof(Member) / sizeof(T);
    const auto* const first =
        entries_.empty() ? nullptr : reinterpret_cast<const T*>(&(entries_.front().*member));
    if constexpr (columns == 1) return shown(owner_, first, entries_.size(), sizeof(Entry));
    return shown_rows(owner_, first, entries_.size(), columns, sizeof(Entry));
  }
  /// A table: see `table`. A column is an array, or the numbers of a member.
  template <typename... Columns>
  [[nodiscard]] py::object table(const char* name, const Columns&... columns) const {
    const auto shown = [this](const auto& column) {
      if constexpr (std::is_member_pointer_v<std::decay_t<decltype(column)>>) {
        return of(column);
      } else {
        return column;
      }
    };
    return python::table(name, shown(columns)...);
  }
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
