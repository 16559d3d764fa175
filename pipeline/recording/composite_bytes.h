#pragma once

// Composite shapes as recordings have them: what each consists of, its digest, and what changes in
// place.

#include <winnow/pipeline/composite_pool.h>
#include "core/memory/byte_stream.h"

#include <span>

namespace winnow {

/// Of a shape as it stands, and of that part of it which stays where it is changed in place.
struct CompositeDigests {
  std::uint64_t all = 0;
  std::uint64_t form = 0;
};

/// `id` is there. O(its bytes).
[[nodiscard]] CompositeDigests digests_of(const CompositePool& pool, ShapeId id) noexcept;

/// Appends a mesh without its scale, or a field, as a snapshot; nothing of a compound.
[[nodiscard]] Status save_composite(const CompositePool& pool, ShapeId id, Column<std::byte>& out);

/// What a change in place may change: coordinates of a mesh's vertices, heights of a field.
[[nodiscard]] std::span<const float> values_of(const CompositePool& pool, ShapeId id) noexcept;

}  // namespace winnow
