#pragma once

// Composite shapes in recordings: their content, their digest, and what a change in place may
// change.

#include <winnow/pipeline/composite_pool.h>
#include "core/memory/byte_stream.h"

#include <span>

namespace winnow {

/// Digest of a whole shape, and digest of the part that a change in place does not change.
struct CompositeDigests {
  std::uint64_t all = 0;
  std::uint64_t form = 0;
};

/// `id` must exist. O(bytes of the shape).
[[nodiscard]] CompositeDigests digests_of(const CompositePool& pool, ShapeId id) noexcept;

/// Appends a mesh without its scale, or a height field, as a snapshot; nothing for a compound.
[[nodiscard]] Status save_composite(const CompositePool& pool, ShapeId id, Column<std::byte>& out);

/// Returns the values that a change in place may change: vertex coordinates of a mesh, heights of a
/// field.
[[nodiscard]] std::span<const float> values_of(const CompositePool& pool, ShapeId id) noexcept;

}  // namespace winnow
