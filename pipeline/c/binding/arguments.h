#pragma once

#include <winnow/c/core.h>
#include <winnow/c/partition.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/status.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace winnow::c {

/// In both languages the numbers are the same.
[[nodiscard]] inline winnow_status answer(Status status) noexcept {
  return static_cast<winnow_status>(status);
}

template <typename... Pointers>
[[nodiscard]] bool are_given(const Pointers*... pointers) noexcept {
  return ((pointers != nullptr) && ...);
}

/// An array that may be null if it is empty.
template <typename T>
[[nodiscard]] bool is_array(const T* first, std::size_t count) noexcept {
  return first != nullptr || count == 0;
}

/// One of the values of an enumeration that ends with `last`.
template <typename Choice>
[[nodiscard]] bool read_choice(std::int64_t given, Choice last, Choice& choice) noexcept {
  if (given < 0 || given > static_cast<std::int64_t>(last)) return false;
  choice = static_cast<Choice>(given);
  return true;
}

/// No struct of the interface is larger than this, in whatever version.
inline constexpr std::size_t kLargestStruct = 4096;

/// The size that a struct had in the first version of the interface: one that grows keeps it here.
template <typename T>
inline constexpr std::size_t kFirstSize = sizeof(T);

/// Whether a struct that may grow is of any version, earlier or later.
template <typename T>
[[nodiscard]] bool is_sized(const T* given) noexcept {
  return given != nullptr && given->size >= kFirstSize<T> && given->size <= kLargestStruct;
}

/// Reads a struct that may grow; null leaves `own`, all zeros, which stand for the defaults. What
/// a later version has behind the end must be zero, which is what it is without it.
template <typename T>
[[nodiscard]] bool read_sized(const T* given, T& own) noexcept {
  if (given == nullptr) return true;
  if (!is_sized(given)) return false;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(given);
  const std::size_t known = std::min(given->size, sizeof(T));
  if (std::any_of(bytes + known, bytes + given->size, [](std::uint8_t b) { return b != 0; })) {
    return false;
  }
  std::memcpy(&own, given, known);
  return true;
}

/// Writes to one that `is_sized` as much as it has; what a later version has behind it is zero.
template <typename T>
void write_sized(T own, T& out) noexcept {
  own.size = out.size;
  const std::size_t known = std::min(own.size, sizeof(T));
  std::memcpy(&out, &own, known);
  std::memset(reinterpret_cast<std::uint8_t*>(&out) + known, 0, own.size - known);
}

[[nodiscard]] inline winnow_bytes bytes_of(const Bytes& bytes) noexcept {
  return {bytes.used, bytes.reserved};
}

/// The footprint of a handle: that of what it holds, the handle itself, and its scratch.
template <typename Made>
[[nodiscard]] winnow_status write_footprint(const Made* made, Footprint footprint,
                                            const Bytes& scratch, winnow_footprint* out) noexcept {
  if (!is_sized(out)) return WINNOW_INVALID_ARGUMENT;
  footprint.structure += {sizeof(*made), sizeof(*made)};
  footprint.scratch += scratch;
  write_sized(
      {0, bytes_of(footprint.bounds), bytes_of(footprint.keys), bytes_of(footprint.client_data),
       bytes_of(footprint.structure), bytes_of(footprint.scratch), bytes_of(footprint.results)},
      *out);
  return WINNOW_OK;
}

/// As much as a call lasts: the predicate leads to `given`.
[[nodiscard]] Filter filter_of(const winnow_filter* given) noexcept;

/// WINNOW_EXECUTION_DEFAULT leaves `execution` as it is.
[[nodiscard]] bool read_execution(const winnow_execution& given, Execution& execution) noexcept;

/// Null is `execution` as it is.
[[nodiscard]] inline bool read_execution(const winnow_execution* given,
                                         Execution& execution) noexcept {
  return given == nullptr || read_execution(*given, execution);
}

}  // namespace winnow::c
