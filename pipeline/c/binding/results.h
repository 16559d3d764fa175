#pragma once

// Results of C functions: creation and destruction of handles, and values that are written to the
// caller's pointers.

#include "core/memory/new_in.h"
#include "pipeline/c/binding/structs.h"

#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

namespace winnow::c {

template <typename T>
[[nodiscard]] const T& value_of(const Answer<T>& answered) noexcept {
  return answered;
}

/// Writes a value of C++ to a variable of C, or to an array of its numbers.
template <typename T, typename Out>
[[nodiscard]] winnow_status give_value(const T& value, Out* out) noexcept {
  if constexpr (requires(Out & shown) { show(value, shown); }) {
    Out shown{};
    show(value, shown);
    if constexpr (requires { out->size; }) {
      write_sized(shown, *out);
    } else {
      *out = shown;
    }
  } else if constexpr (std::is_same_v<T, ShapeId>) {
    *out = value.bits;
  } else if constexpr (requires { value[0]; }) {
    for (std::size_t i = 0; i < sizeof(T) / sizeof(Out); ++i) out[i] = value[i];
  } else {
    put(value, *out);
  }
  return WINNOW_OK;
}
/// Returns an array without a copy.
template <typename T, typename OfC>
[[nodiscard]] winnow_status give_value(std::span<const T> values, const OfC** first,
                                       std::size_t* count) noexcept {
  static_assert(kIsSameLayout<OfC, T>);
  *first = reinterpret_cast<const OfC*>(values.data());
  *count = values.size();
  return WINNOW_OK;
}
[[nodiscard]] inline winnow_status give_value(const Column<std::byte>& bytes,
                                              const std::uint8_t** first,
                                              std::size_t* count) noexcept {
  *first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  *count = bytes.size();
  return WINNOW_OK;
}
[[nodiscard]] inline winnow_status give_value(const OverlapBuffer& objects, const ObjectId** ids,
                                              std::size_t* count, std::size_t* inside) noexcept {
  *inside = objects.inside().size();
  return give_value(objects.ids(), ids, count);
}
[[nodiscard]] inline winnow_status give_value(const SceneHitLists& lists,
                                              const winnow_scene_hit** hits,
                                              const std::size_t** first) noexcept {
  *hits = reinterpret_cast<const winnow_scene_hit*>(lists.hits.data());
  *first = lists.first.data();
  return WINNOW_OK;
}
[[nodiscard]] inline winnow_status give_value(const CompoundPart& found, std::uint32_t* child,
                                              std::uint32_t* part) noexcept {
  *child = found.child;
  *part = found.part;
  return WINNOW_OK;
}

/// Calls a function of C++, writes its value and returns its status.
template <typename Run, typename... Out>
[[nodiscard]] winnow_status give(Run&& run, Out*... out) noexcept {
  using Result = std::remove_cvref_t<std::invoke_result_t<Run>>;
  if constexpr (std::is_void_v<Result>) {
    run();
    return WINNOW_OK;
  } else if constexpr (std::is_same_v<Result, Status>) {
    return answer(run());
  } else if constexpr (std::is_same_v<Result, bool> && sizeof...(Out) == 0) {
    // A call that only returns whether it succeeded fails if memory is refused.
    return run() ? WINNOW_OK : WINNOW_OUT_OF_MEMORY;
  } else if constexpr (requires(Result result) { value_of(result); }) {
    const Result result = run();
    return result.status == Status::ok ? give_value(value_of(result), out...)
                                       : answer(result.status);
  } else {
    return give_value(run(), out...);
  }
}

/// Writes the footprint of a handle: its content, the handle itself, and its room.
template <typename Made>
[[nodiscard]] winnow_status write_footprint(const Made* made, winnow_footprint* out) noexcept {
  Footprint footprint = of(made).footprint();
  footprint.structure += {sizeof(*made), sizeof(*made)};
  footprint.scratch += made->room_bytes();
  return give_value(footprint, out);
}

template <typename Options>
[[nodiscard]] const winnow_memory* memory_of(const Options* options) noexcept {
  return options == nullptr ? nullptr : options->memory;
}

template <typename Made>
void destroy(Made* made) noexcept {
  if (made == nullptr) return;
  CallersMemory memory = made->memory;
  delete_in(&memory, made);
}

/// Allocates a handle and writes it to `out`, unless its object cannot be used.
template <typename Made, typename... From>
[[nodiscard]] winnow_status create(const winnow_memory* memory, Made** out,
                                   From&&... from) noexcept {
  if (!CallersMemory::is_good(memory)) return WINNOW_INVALID_ARGUMENT;
  CallersMemory source(memory);
  Made* const made = new_in<Made>(&source, source, std::forward<From>(from)...);
  if (made == nullptr) return WINNOW_OUT_OF_MEMORY;
  const Status status = standing(*made);
  if (status == Status::ok) {
    *out = made;
  } else {
    destroy(made);
  }
  return answer(status);
}

}  // namespace winnow::c
