#pragma once

// Checks of the arguments of C functions, and structs that may grow.
#include <winnow/c/core.h>
#include <winnow/core/status.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace winnow::c {

/// C and C++ use the same numbers.
[[nodiscard]] inline winnow_status answer(Status status) noexcept {
  return static_cast<winnow_status>(status);
}

template <typename... Pointers>
[[nodiscard]] bool are_given(const Pointers*... pointers) noexcept {
  return ((pointers != nullptr) && ...);
}

/// True for a valid array; it may be null if it is empty.
template <typename T>
[[nodiscard]] bool is_array(const T* first, std::size_t count) noexcept {
  return first != nullptr || count == 0;
}

/// Returns an array as a span; null is an empty one.
template <typename T>
[[nodiscard]] std::span<T> span_of(T* first, std::size_t count) noexcept {
  return {first, first == nullptr ? 0 : count};
}

/// Upper bound on the size of any struct of the interface, in all versions.
inline constexpr std::size_t kLargestStruct = 4096;

/// Size of a struct in the first version of the interface; structs.h specializes it for structs
/// that have grown.
template <typename T>
inline constexpr std::size_t kFirstSize = sizeof(T);

/// True if `size` is plausible for this struct in any version, earlier or later.
template <typename T>
[[nodiscard]] bool is_sized(const T* given) noexcept {
  return given != nullptr && given->size >= kFirstSize<T> && given->size <= kLargestStruct;
}

/// Reads a struct that may grow. Null leaves `own` all zero, which means the defaults. Members of a
/// later version, behind the end of `T`, must be zero: this means the behaviour without them.
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

/// Writes as much of the struct as the caller's `size` has room for (see `is_sized`). Bytes behind
/// the end of `T` become zero.
template <typename T>
void write_sized(T own, T& out) noexcept {
  own.size = out.size;
  const std::size_t known = std::min(own.size, sizeof(T));
  std::memcpy(&out, &own, known);
  std::memset(reinterpret_cast<std::uint8_t*>(&out) + known, 0, own.size - known);
}

}  // namespace winnow::c
