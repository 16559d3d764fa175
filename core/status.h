#pragma once

#include <winnow/core/export.h>

#include <cstdint>

namespace winnow {

/// What became of a call. Every call that can be refused returns one; a refused call changed
/// nothing. No winnow function throws on what a caller can pass.
enum class [[nodiscard]] Status : std::uint8_t{
    /// It did what it says.
    ok,
    /// A bound is NaN, has min > max on an axis, or lies wholly at infinity.
    invalid_bounds,
    /// A key is the default one, stale (its object was removed) or from another partition.
    invalid_key,
    /// An option or argument is outside its stated range.
    invalid_argument,
    /// Spans that belong together differ in length.
    size_mismatch,
    /// The memory resource refused; the structure is as it was.
    out_of_memory,
    /// More than `kMaxObjects` objects.
    too_many_objects,
    /// The partition does not hold this kind of bounding volume.
    unsupported_volume,
    /// A shape has a length that is negative, NaN or infinite, or no shape can be made of the
    /// points.
    invalid_shape,
    /// A pose is NaN or infinite, or its quaternion is zero.
    invalid_pose,
    /// The library was built without what this call needs.
    unsupported,
    /// A rank of a cluster does not answer, or a message failed: no later call will be answered.
    communication_failed,
};

/// The enumerator's name, for messages. Never null.
[[nodiscard]] WINNOW_API const char* to_string(Status status) noexcept;

}  // namespace winnow
