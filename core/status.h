#pragma once

#include <winnow/core/export.h>

#include <cstdint>

namespace winnow {

/// Result of a call. Every call that can be refused returns a Status, and a refused call changes
/// nothing. No function of winnow throws because of its arguments.
enum class [[nodiscard]] Status : std::uint8_t{
    /// Success.
    ok,
    /// A bounding volume has a NaN, has min > max on an axis, or is entirely at infinity.
    invalid_bounds,
    /// A key is null, stale (its object was removed) or from another partition or scene.
    invalid_key,
    /// An option or argument is outside its stated range.
    invalid_argument,
    /// Spans that belong together differ in length.
    size_mismatch,
    /// The memory resource refused; the object is unchanged.
    out_of_memory,
    /// The number of objects would exceed `kMaxObjects`.
    too_many_objects,
    /// The partition does not store this kind of bounding volume.
    unsupported_volume,
    /// A shape has a length that is negative, NaN or infinite, or its points do not define a shape.
    invalid_shape,
    /// A pose has a NaN or infinity, or its quaternion is zero.
    invalid_pose,
    /// This build of the library, or the object as it was created, lacks what the call needs.
    unsupported,
    /// A rank of a cluster does not respond, or a message failed; no later call can succeed.
    communication_failed,
};

/// Returns the enumerator's name for messages, never null.
[[nodiscard]] WINNOW_API const char* to_string(Status status) noexcept;

/// The value that a call returns, together with its status. An answer has the members of the value
/// and converts to it: `Key key = scene.add(body)`. Unless the status is ok, the value is the
/// default one.
template <typename T>
struct [[nodiscard]] Answer : T {
  Status status = Status::ok;  ///< errors as documented by the call

  constexpr Answer() noexcept = default;  ///< answers with the default value
  /// Answers with a value.
  constexpr Answer(const T& value) noexcept : T(value) {}  // NOLINT(google-explicit-constructor)
  /// Answers with an error.
  constexpr Answer(Status error) noexcept  // NOLINT(google-explicit-constructor)
      : T{}, status(error) {}
  /// Stores the value unless the status is an error; returns the status.
  constexpr Status get(T& value) const noexcept {
    if (status == Status::ok) value = *this;
    return status;
  }
};

}  // namespace winnow
