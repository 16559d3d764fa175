#pragma once

// Reads and checks the arguments of C functions, and converts results. Used by all files of the
// binding.
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

namespace winnow::c {

/// C and C++ use the same numbers.
[[nodiscard]] inline winnow_status answer(Status status) noexcept {
  return static_cast<winnow_status>(status);
}
/// Writes the value of an answer without an error; of a shape's id, its bits.
template <typename T, typename Out>
[[nodiscard]] winnow_status answer(const Answer<T>& answer, Out* out) noexcept {
  if (answer.status == Status::ok) {
    if constexpr (requires { answer.bits; }) {
      *out = answer.bits;
    } else {
      *out = answer;
    }
  }
  return c::answer(answer.status);
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

/// Reads an enumerator, whose number may be at most `last`. Returns false if it is out of range.
template <typename Choice>
[[nodiscard]] bool read_choice(std::int64_t given, Choice last, Choice& choice) noexcept {
  if (given < 0 || given > static_cast<std::int64_t>(last)) return false;
  choice = static_cast<Choice>(given);
  return true;
}

/// Upper bound on the size of any struct of the interface, in all versions.
inline constexpr std::size_t kLargestStruct = 4096;

/// Size of a struct in the first version of the interface. Specialize it when a struct grows.
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

[[nodiscard]] inline winnow_bytes bytes_of(const Bytes& bytes) noexcept {
  return {bytes.used, bytes.reserved};
}

/// Writes the footprint of a handle: its content, the handle itself, and its scratch memory.
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

/// The returned filter refers to `given` and is valid only during the call.
[[nodiscard]] Filter filter_of(const winnow_filter* given) noexcept;

/// WINNOW_EXECUTION_DEFAULT leaves `execution` unchanged.
[[nodiscard]] bool read_execution(const winnow_execution& given, Execution& execution) noexcept;

/// Null leaves `execution` unchanged.
[[nodiscard]] inline bool read_execution(const winnow_execution* given,
                                         Execution& execution) noexcept {
  return given == nullptr || read_execution(*given, execution);
}

}  // namespace winnow::c
